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


def test_a_signal_ends_it_as_its_help_says_and_frees_the_port() -> None:
    assert "Exit status: 0 ended on request" in run("sim", "--help").stdout
    process = start("sim", "--port", "0")
    assert process.stdout is not None
    process.stdout.readline()
    address = process.stdout.readline().strip().partition("=")[2]
    process.send_signal(signal.SIGTERM)
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


def test_every_address_can_be_bound_and_one_is_printed() -> None:
    process = start("sim", "--port", "0", "--bind", "0.0.0.0")
    assert process.stdout is not None
    process.stdout.readline()
    export = process.stdout.readline()
    process.terminate()
    process.communicate(timeout=120)
    assert "=127.0.0.1:" in export
