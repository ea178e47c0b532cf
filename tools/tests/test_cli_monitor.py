# SPDX-License-Identifier: MIT
"""`roburoc4 monitor`: live, as lines of JSON, over a loss, into a pipe that closes."""

import io
import json
import signal
import subprocess
import time
from typing import Any

from cli_support import COMMAND, Terminal, environment, run, start
from rich.console import Console
from robot_support import until

import roburoc4
from roburoc4_tools.cli.names import names_of
from roburoc4_tools.cli.watching.snapshot import take
from roburoc4_tools.cli.watching.view import render

FIELDS = {
    "iocard": {"analog_inputs", "digital_inputs"},
    "telemeter": {"distances_m"},
    "battery": {"state", "state_name", "remaining_percent"},
    "localization": {"x_m", "y_m", "theta_rad", "flags"},
    "differential": {
        "target_linear_m_s",
        "current_linear_m_s",
        "target_angular_rad_s",
        "current_angular_rad_s",
    },
}


def _lines(stdout: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in stdout.splitlines()]


def test_every_line_of_json_is_a_status_with_its_fields() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set("pin_analog_2", float("nan"))
        done = run("monitor", "--json", "--seconds", "2.5", robot=sim.address)
        assert (sim.state.speed_commands, sim.state.io_commands) == (0, 0)
    assert (done.returncode, done.stderr) == (0, "")
    lines = _lines(done.stdout)
    assert {line["service"] for line in lines} == set(FIELDS)
    for line in lines:
        assert set(line) == {"service", "utc_s", "robot_cycles"} | FIELDS[line["service"]]
    battery = next(line for line in lines if line["service"] == "battery")
    assert battery["state"] == 2
    assert battery["state_name"] == "ok"
    iocard = next(line for line in lines if line["service"] == "iocard")
    assert len(iocard["analog_inputs"]) == 9
    assert iocard["analog_inputs"][2] is None, "not a number"
    assert iocard["digital_inputs"] == [False] * 22
    pose = next(line for line in lines if line["service"] == "localization")
    assert pose["flags"] == 18


def test_without_a_terminal_a_line_is_printed_periodically() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set("pad_a", True)
        done = run("monitor", "--seconds", "3", robot=sim.address)
    assert done.returncode == 0
    last = done.stdout.splitlines()[-1]
    for text in ("ready", "battery 100 %", "override", "loss 0.0%"):
        assert text in last


def test_a_terminal_shows_the_live_table() -> None:
    with roburoc4.Simulator(port=0) as sim:
        terminal = Terminal("monitor", robot=sim.address)
        terminal.wait_for("○ FRONT BUMPER")
        sim.set("front_bumper", True)
        sim.set("pad_a", True)
        terminal.wait_for("● OVERRIDE")
        terminal.wait_for("● FRONT BUMPER")
        terminal.wait_for(r"20\.0/s")
        terminal.wait_for(r"█+░* 100 %  ok")
        terminal.wait_for(r"5\.\d\d m  rear")
        terminal.type("\x03")
        assert terminal.wait() == 130
    assert "Traceback" not in terminal.text


def test_a_signal_ends_it_quietly() -> None:
    with roburoc4.Simulator(port=0) as sim:
        process = start("monitor", "--json", robot=sim.address)
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (130, "")


def test_a_temporary_loss_is_reported_and_not_an_error() -> None:
    with roburoc4.Simulator(port=0) as sim:
        process = start("monitor", "--json", "--seconds", "12", robot=sim.address)
        assert process.stdout is not None
        process.stdout.readline()
        sim.set("power", False)
        time.sleep(2.5)
        sim.set("power", True)
        stdout = process.stdout.read()  # communicate() would leave out what readline() read ahead
        _, stderr = process.communicate(timeout=120)
    assert process.returncode == 0, stderr
    assert "fell silent" in stderr
    assert "is back" in stderr
    assert _lines(stdout)[-1]["robot_cycles"] < 1000, "the robot started counting again"


def test_a_closed_pipe_ends_it_quietly() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = subprocess.run(
            f"{COMMAND} monitor | head -n 1",
            shell=True,
            env=environment(sim.address),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.stdout.count("\n") == 1
        assert done.stderr == ""
        until(lambda: sim.state.peers <= 1)


def test_a_narrow_terminal_shows_whole_values() -> None:
    cells = 40
    with roburoc4.Simulator() as sim, sim.connect() as robot:
        robot.sleep(2.0)
        screen = Console(width=cells, file=io.StringIO(), record=True)
        screen.print(render(take(robot, 1.0, names_of(robot)), cells))
    shown = screen.export_text()
    assert max(map(len, shown.splitlines())) <= cells
    for text in (
        *("the simulator  ready  round trip 0.0 ms", "REAR BUMPER", "ANOTHER COMMANDER"),
        *("localization  20.0/s", "0.0 ms", "x 0.000 m  y 0.000 m", "(0.0°)"),
        *("m  front", "rad/s (target +0.00)"),
    ):
        assert text in shown
