# SPDX-License-Identifier: MIT
"""`roburoc4 sim`: the simulator, and the line that points the other commands at it."""

import re
import signal
import subprocess
import sys

import pytest
from cli_support import COMMAND, environment, run, start
from robot_support import until


def test_its_export_line_makes_the_other_commands_work() -> None:
    process = start("sim", "--port", "0")
    assert process.stdout is not None
    try:
        assert "ready on" in process.stdout.readline()
        export = process.stdout.readline()
        assert re.fullmatch(r"export ROBUROC4_ROBOT=127\.0\.0\.1:\d+\n", export)
        done = subprocess.run(
            ["sh", "-c", f"{export}exec {COMMAND} stop"],
            env=environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, "")
    finally:
        process.terminate()
        process.communicate(timeout=120)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_as_its_help_says_and_free_the_port(number: signal.Signals) -> None:
    assert "Exit status: 0 ended on request" in run("sim", "--help").stdout
    process = start("sim", "--port", "0")
    assert process.stdout is not None
    process.stdout.readline()
    address = process.stdout.readline().strip().partition("=")[2]
    process.send_signal(number)
    _, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (0, "")
    assert run("stop", "--robot", address).returncode == 3


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends the child of a killed process")
def test_it_ends_if_it_is_killed() -> None:
    process = start("sim", "--port", "0")
    assert process.stdout is not None
    process.stdout.readline()
    address = process.stdout.readline().strip().partition("=")[2]
    process.kill()
    process.communicate(timeout=120)
    until(lambda: run("stop", "--robot", address).returncode == 3)


def test_its_arguments_are_the_simulators_own() -> None:
    done = run("sim", "--help")
    assert done.returncode == 0
    assert "--loss SHARE" in done.stdout
    assert "export" not in done.stdout  # there is no ready line here
    assert done.stdout.index("Exit status:") < done.stdout.index("--telnet PORT")
    done = run("sim", "--loss", "2")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1


def test_the_panel_can_be_used_through_it() -> None:
    process = subprocess.Popen(
        [COMMAND, "sim", "--port", "0", "--panel"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    stdout, _ = process.communicate("pad a down\nstatus\nquit\n", timeout=120)
    assert process.returncode == 0
    assert "game pad drives" in stdout


def test_every_address_can_be_bound_and_one_is_printed() -> None:
    process = start("sim", "--port", "0", "--bind", "0.0.0.0")
    assert process.stdout is not None
    process.stdout.readline()
    export = process.stdout.readline()
    process.terminate()
    process.communicate(timeout=120)
    assert "=127.0.0.1:" in export
