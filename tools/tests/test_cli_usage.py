# SPDX-License-Identifier: MIT
"""A wrong command line: one line, exit code 2, and the robot is not contacted."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from cli_support import ALONE, COMMAND, environment, one_line, run, start

import roburoc4

BAD = {
    "nothing": [],
    "unknown command": ["fly"],
    "unknown option": ["info", "--quick"],
    "abbreviation": ["monitor", "--sec", "1"],
    "drive: no time": ["drive", "0.5", "0"],
    "drive: nan": ["drive", "nan", "0", "--seconds", "1"],
    "drive: -inf": ["drive", "-inf", "0", "--seconds", "1"],
    "monitor: negative time": ["monitor", "--seconds", "-1"],
    "output: reserved": ["output", "0", "on"],
    "output: maybe": ["output", "1", "maybe"],
    "teleop: no terminal": ["teleop"],
}


@pytest.mark.parametrize("arguments", BAD.values(), ids=BAD.keys())
def test_a_bad_command_line_is_one_line_and_sends_nothing(arguments: list[str]) -> None:
    with roburoc4.Simulator(port=0, host=ALONE) as sim:
        done = run(*arguments, robot=sim.address)
        assert done.returncode == 2
        assert done.stdout == ""
        assert "--help" in one_line(done.stderr) or "terminal" in done.stderr
        assert sim.state.requests == 0


@pytest.mark.parametrize("robot", ["", ":60000", "robot:70000", "[::1"])
@pytest.mark.parametrize("command", ["info", "doctor"])
def test_a_bad_address_is_bad_usage(command: str, robot: str) -> None:
    done = run(command, "--robot", robot)
    assert done.returncode == 2
    one_line(done.stderr)


def test_help_and_version_are_no_errors() -> None:
    done = run("--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert "roburoc4 sim" in done.stdout
    for command in (
        "info",
        "monitor",
        "drive",
        "teleop",
        "stop",
        "output",
        "relocalize",
        "doctor",
        "record",
        "sim",
    ):
        assert command in done.stdout
        one = run(command, "--help")
        assert (one.returncode, one.stderr) == (0, ""), one.stderr
        assert "usage: roburoc4" in one.stdout.lower()
    assert run("--version").stdout == f"roburoc4 {roburoc4.__version__}\n"


def test_the_address_may_stand_anywhere() -> None:
    with roburoc4.Simulator(port=0) as sim:
        assert run("--robot", sim.address, "stop").returncode == 0
        assert run("stop", "--robot", sim.address).returncode == 0
        assert run("stop", robot=sim.address).returncode == 0


def test_an_absent_robot_exits_3_and_says_what_to_check() -> None:
    with roburoc4.Simulator(port=0) as sim:
        address = sim.address
    done = run("stop", "--robot", address)
    assert done.returncode == 3
    assert "check" in one_line(done.stderr)
    assert address in done.stderr


def test_a_signal_ends_it_while_it_still_connects() -> None:
    import signal
    import socket
    import time

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as silent:
        silent.bind(("127.0.0.1", 0))
        process = start("info", robot=f"127.0.0.1:{silent.getsockname()[1]}")
        silent.recv(100)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (130, "")


def test_a_module_that_is_missing_is_named() -> None:
    program = (
        "import sys; sys.modules['rich.console'] = None; sys.modules['rich'] = None;"
        "sys.argv = ['roburoc4', 'info', '--robot', sys.argv[1]];"
        "from roburoc4_tools.cli import main; main()"
    )
    with roburoc4.Simulator(port=0) as sim:
        done = subprocess.run(
            [sys.executable, "-c", program, sim.address],
            capture_output=True,
            text=True,
            env=environment(),
            check=False,
        )
    assert done.returncode == 2
    assert "pip install ./bindings/python ./tools" in one_line(done.stderr)


def _shell(line: str, robot: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        line.replace("roburoc4", COMMAND),
        shell=True,
        env=environment(robot),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize(
    "line",
    [
        "roburoc4 info | true",
        "roburoc4 info >&-",
        "roburoc4 drive 0 0 --seconds 0.1 --json | true",
        "PYTHONIOENCODING=ascii roburoc4 info | cat",
    ],
)
def test_it_stays_quiet_whatever_the_shell_does_to_its_streams(line: str) -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = _shell(line, sim.address)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("command", ["info", "monitor --json"])
def test_a_full_disk_is_one_line(command: str) -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = _shell(f"roburoc4 {command} > /dev/full", sim.address)
    assert done.returncode == 1
    assert "free some space" in one_line(done.stderr)


def test_an_unexpected_error_is_one_line() -> None:
    program = (
        "import sys; import roburoc4_tools.cli.watching.info as info;"
        "info.names_of = lambda robot: 1 / 0;"
        "sys.argv = ['roburoc4', 'info'];"
        "from roburoc4_tools.cli import main; main()"
    )
    with roburoc4.Simulator(port=0) as sim:
        env = environment(sim.address)
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
        debug = env | {"ROBUROC4_DEBUG": "1"}
        loud = subprocess.run(command, env=debug, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ZeroDivisionError" in one_line(done.stderr)
    assert "Traceback" in loud.stderr


def test_fish_completes_commands_options_and_choices(tmp_path: Path) -> None:
    script = run("completion", "fish").stdout
    assert "-n __roburoc4_needs_command -f -a monitor -d 'show what" in script
    assert "-n __roburoc4_needs_command -l robot -r -d" in script
    assert "'__fish_seen_subcommand_from move' -l speed -r -d" in script
    assert "'__fish_seen_subcommand_from move' -l yes -s y -d" in script
    assert "'__fish_seen_subcommand_from completion' -f -a 'bash zsh tcsh fish'" in script
    if (fish := shutil.which("fish")) is None:
        return
    file = tmp_path / "roburoc4.fish"
    file.write_text(script)
    lines = {
        "roburoc4 moni": "monitor",
        "roburoc4 move --sp": "--speed",
        "roburoc4 --rob": "--robot",
        "roburoc4 --robot 10.0.0.1 moni": "monitor",
    }
    for line, expected in lines.items():
        done = subprocess.run(
            [fish, "--no-config", "-c", f"source {file}; complete -C '{line}'"],
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        )
        assert done.stdout.split("\t")[0] == expected, done.stderr


def test_ros2_without_its_package_says_what_installs_it(tmp_path: Path) -> None:
    (tmp_path / "roburoc4_ros2.py").write_text("raise ModuleNotFoundError(name='roburoc4_ros2')\n")
    program = "from roburoc4_tools.cli import main; main()"
    for arguments in ([], ["--list"], ["--robot", "red=10.0.0.1"], ["--help"]):
        done = subprocess.run(
            [sys.executable, "-c", program, "ros2", *arguments],
            env=environment("127.0.0.1:9") | {"PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2, arguments
        assert "pip install ./bindings/python ./tools ./ros2" in one_line(done.stderr)
