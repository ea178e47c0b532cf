# SPDX-License-Identifier: MIT
"""The examples do what they say, as their users run them."""

import csv
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from rig import Bridge, Bus, Program, Programs, Robot, until

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


def test_the_python_example_has_ten_lines() -> None:
    text = (EXAMPLES / "drive.py").read_text()
    code = [line for line in text.split('"""')[2].splitlines() if line.strip()]
    assert len(code) <= 10


def test_the_c_example_drives_to_a_point(
    programs: Programs, robot: Robot, bus: Bus, armed: Bridge, run: Run
) -> None:
    example = run(programs("drive_to"), "1.0", "0.5", LCM_DEFAULT_URL=bus.url)
    assert example.ends(70) == 0, example.output
    pose = bus.last("ROBUROC4_LOCALIZATION")
    assert abs(pose.x_m - 1.0) < 0.25
    assert abs(pose.y_m - 0.5) < 0.25
    until(robot.stands, "the robot stands")


def test_the_c_example_ends_when_somebody_takes_the_robot_over(
    programs: Programs, robot: Robot, bus: Bus, armed: Bridge, run: Run
) -> None:
    example = run(programs("drive_to"), "4", "0", LCM_DEFAULT_URL=bus.url)
    until(robot.tap.moves, "it drives")
    time.sleep(0.5)
    robot.tell("pad a down")
    assert example.ends(10) == 1
    assert "bridge: " in example.output


def test_the_c_example_says_when_there_is_no_bridge(programs: Programs, bus: Bus, run: Run) -> None:
    example = run(programs("drive_to"), "1", "0", LCM_DEFAULT_URL=bus.url)
    assert example.ends(30) == 1
    assert "roburoc4-lcm" in example.output
    assert run(programs("drive_to"), "1", "here").ends(10) == 2


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
        assert {row["sender"] for row in csv.DictReader(file)} == {"drive.py"}
    assert "<svg" in picture.read_text()
    assert run(sys.executable, EXAMPLES / "log_to_csv.py", tmp_path / "none", folder).ends(30) == 2
