# SPDX-License-Identifier: MIT
"""The examples do what they promise, as their users run them."""

import csv
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import lcm
import pytest
import roburoc4_lcm
from rig import Bridge, Bus, Program, Programs, Robot, until
from rig.bus import drive_command, now_us

Run = Callable[..., Program]
EXAMPLES = Programs.checkout() / "lcm" / "examples"


def test_the_python_example_drives(robot: Robot, bus: Bus, armed: Bridge, run: Run) -> None:
    example = run(sys.executable, EXAMPLES / "drive.py", LCM_DEFAULT_URL=bus.url)
    assert example.ends(30) == 0, example.output
    x_m, y_m, theta_rad = robot.true_pose()
    assert x_m > 0.4
    assert y_m > 0
    assert theta_rad > 0.2
    until(robot.stands, "the robot stands")


@pytest.mark.parametrize("name", ["drive.py", "move.py"])
def test_a_python_example_says_why_it_does_not_drive(
    robot: Robot, bus: Bus, start_bridge: Callable[..., Bridge], run: Run, name: str
) -> None:
    alone = run(sys.executable, EXAMPLES / name, LCM_DEFAULT_URL=bus.url)
    assert alone.ends(30) == 1
    assert "no bridge on this LCM network" in alone.output

    start_bridge().connects()
    refused = run(sys.executable, EXAMPLES / name, LCM_DEFAULT_URL=bus.url)
    assert refused.ends(30) == 1
    assert "start the bridge with --enable-drive" in refused.output
    assert not robot.tap.moves()


def test_the_lines_of_the_readme_drive(programs: Programs, run: Run, tmp_path: Path) -> None:
    """As printed, in a network namespace in which the robot's port is free."""
    readme = (Programs.checkout() / "README.md").read_text().splitlines()
    simulator = next(line for line in readme if line.startswith("build/bin/roburoc4-sim &"))
    first = next(n for n, line in enumerate(readme) if line.startswith("build/bin/roburoc4-lcm "))
    bridge, example, end = readme[first : readme.index("```", first)]
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "bin").symlink_to(programs.folder.resolve())
    (tmp_path / "lcm").symlink_to(Programs.checkout() / "lcm")
    folders = [Path(sys.executable).parent, Programs.of_lcm("lcm-logger").parent]
    script = [
        "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo || exit 9",
        f"cd {tmp_path}",
        "set -m",
        *[simulator, bridge, "timeout 7 lcm-logger drive.lcmlog &", example, "wait %3", end],
        "wait",
        'test -z "$(jobs -r)"',
    ]
    path = ":".join([*map(str, folders), os.environ["PATH"]])
    done = run("setsid", "unshare", "-rn", "bash", "-c", "\n".join(script), PATH=path)
    assert done.ends(120) == 0, done.output
    events = list(lcm.EventLog(str(tmp_path / "drive.lcmlog"), "r"))
    speeds = [
        roburoc4_lcm.differential_status_t.decode(event.data).current_linear_m_s
        for event in events
        if event.channel == "ROBUROC4_DIFFERENTIAL"
    ]
    assert max(speeds) == pytest.approx(0.3, abs=0.05), done.output
    assert speeds[-1] == pytest.approx(0.0, abs=0.05)


def test_the_move_of_the_example_reaches_its_goal(
    robot: Robot, bus: Bus, armed: Bridge, run: Run
) -> None:
    example = run(sys.executable, EXAMPLES / "move.py", LCM_DEFAULT_URL=bus.url)
    assert example.ends(40) == 0, example.output
    assert robot.true_pose()[0] == pytest.approx(0.5, abs=0.1), example.output
    until(robot.stands, "the robot stands")


def test_the_c_example_drives_to_a_point(
    programs: Programs, robot: Robot, bus: Bus, armed: Bridge, run: Run
) -> None:
    example = run(programs("drive_to"), "1.0", "0.5", LCM_DEFAULT_URL=bus.url)
    assert example.ends(70) == 0, example.output
    pose = bus.last("ROBUROC4_LOCALIZATION")
    assert abs(pose.x_m - 1.0) < 0.25
    assert abs(pose.y_m - 0.5) < 0.25
    until(robot.stands, "the robot stands")


def test_the_c_example_drives_true_metres_on_a_calibrated_robot(
    programs: Programs,
    bus: Bus,
    start_bridge: Callable[..., Bridge],
    run: Run,
    tmp_path: Path,
) -> None:
    (tmp_path / "robot.txt").write_text("scale_linear = 0.7\nscale_angular = 1.2\n")
    start_bridge("--enable-drive", f"--robot-file={tmp_path / 'robot.txt'}").arms()
    example = run(programs("drive_to"), "1.5", "0.5", LCM_DEFAULT_URL=bus.url)
    assert example.ends(70) == 0, example.output
    pose = bus.last("ROBUROC4_LOCALIZATION")
    assert (pose.x_m, pose.y_m) == pytest.approx((1.5, 0.5), abs=0.1)


def test_the_c_example_ends_when_somebody_takes_the_robot_over(
    programs: Programs, robot: Robot, bus: Bus, armed: Bridge, run: Run
) -> None:
    example = run(programs("drive_to"), "4", "0", LCM_DEFAULT_URL=bus.url)
    until(robot.tap.moves, "it drives")
    time.sleep(0.5)
    robot.tell("pad a down")
    assert example.ends(10) == 1
    assert "bridge: " in example.output


@pytest.mark.java
def test_the_matlab_example_drives(
    robot: Robot, bus: Bus, armed: Bridge, run: Run, tmp_path: Path
) -> None:
    """In GNU Octave, which reads it as MATLAB does."""
    lcm_jar = Path(sys.prefix) / "share" / "java" / "lcm.jar"
    site = next(Path(sys.prefix).glob("lib/python*/site-packages/share/java/lcm.jar"), lcm_jar)
    script = tmp_path / "run.m"
    script.write_text(
        f"javaaddpath('{site}'); javaaddpath('{os.environ['ROBUROC4_JAR']}');\n"
        f"run('{EXAMPLES / 'drive_lcm.m'}');\n"
    )
    javac = shutil.which("javac")
    assert javac, "javac is missing: install default-jdk-headless"
    java = str(Path(javac).resolve().parents[1])
    example = run("octave-cli", "--norc", script, LCM_DEFAULT_URL=bus.url, JAVA_HOME=java)
    assert example.ends(90) == 0, example.output
    assert "poses, from 0.00 0.00 to" in example.output
    assert robot.true_pose()[0] > 0.4
    until(robot.stands, "the robot stands")


def test_a_log_becomes_csv_and_a_picture(
    robot: Robot, bus: Bus, armed: Bridge, run: Run, tmp_path: Path
) -> None:
    log, folder, picture = tmp_path / "lcmlog", tmp_path / "run", tmp_path / "path.svg"
    logger = run(Programs.of_lcm("lcm-logger"), f"--lcm-url={bus.url}", log)
    until(lambda: log.exists() and log.stat().st_size > 0, "lcm-logger writes")
    begun = len(bus.of("ROBUROC4_LOCALIZATION"))
    assert run(sys.executable, EXAMPLES / "drive.py", LCM_DEFAULT_URL=bus.url).ends(30) == 0
    time.sleep(0.5)
    logger.signal(signal.SIGINT)
    logger.ends()
    example = run(
        sys.executable, EXAMPLES / "log_to_csv.py", log, folder, "--plot", picture,
        MPLCONFIGDIR=str(tmp_path),
    )  # fmt: skip
    assert example.ends(60) == 0, example.output
    with (folder / "ROBUROC4_LOCALIZATION.csv").open() as file:
        rows = list(csv.DictReader(file))
    heard = bus.decoded("ROBUROC4_LOCALIZATION")[begun:]
    known = {message.robot_cycles: message for message in heard}
    assert len(rows) > 40
    same = [row for row in rows if int(row["robot_cycles"]) in known]
    assert len(same) > 40
    for row in same:
        assert float(row["x_m"]) == known[int(row["robot_cycles"])].x_m
    with (folder / "ROBUROC4_TELEMETER.csv").open() as file:
        assert float(next(csv.DictReader(file))["telemeters_0_distance_m"]) > 0
    with (folder / "ROBUROC4_DRIVE_CMD.csv").open() as file:
        senders = {row["sender"] for row in csv.DictReader(file)}
    assert [sender.split()[0] for sender in senders] == ["drive.py"]
    assert "<svg" in picture.read_text()
    assert run(sys.executable, EXAMPLES / "log_to_csv.py", tmp_path / "none", folder).ends(30) == 2


def log_with(path: Path, *messages: tuple[str, bytes]) -> Path:
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for channel, data in messages:
        log.write_event(now_us(), channel, data)
    log.close()
    return path


def test_no_channel_of_a_log_gets_out_of_the_folder(run: Run, tmp_path: Path) -> None:
    data = drive_command(0.1).encode()
    channels = ["../evil", "/tmp/evil", "LAB/A_LOCALIZATION", "..", "a b\n"]
    log = log_with(tmp_path / "lcmlog", *((channel, data) for channel in channels))
    folder = tmp_path / "deep" / "run"
    example = run(sys.executable, EXAMPLES / "log_to_csv.py", log, folder)
    assert example.ends(30) == 0, example.output
    assert sorted(path.name for path in folder.iterdir()) == [
        "...csv",
        ".._evil.csv",
        "LAB_A_LOCALIZATION.csv",
        "_tmp_evil.csv",
        "a_b_.csv",
    ]
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["run"]
