# SPDX-License-Identifier: MIT
"""`roburoc4 teleop`: the robot moves while a key is held, and only then."""

import signal
import time
from collections.abc import Callable, Iterator

import pytest
from cli_support import Terminal, last_command_is_zero
from robot_support import until

import roburoc4
from roburoc4_tools.terminal.deadman import REPEAT_S

RELEASES = "\x1b[?11u\x1b[?62;c"  # a terminal that reports releases
NO_RELEASES = "\x1b[?62;c"
ECHO = "\x1b[0n"


@pytest.fixture
def sim() -> Iterator[roburoc4.Simulator]:
    with roburoc4.Simulator(port=0) as simulator:
        yield simulator


def _teleop(sim: roburoc4.Simulator, answer: str) -> Terminal:
    terminal = Terminal("teleop", "--yes", robot=sim.address)
    terminal.wait_for(r"\[c")
    terminal.type(answer)
    terminal.wait_for("keys held")
    return terminal


def _press(terminal: Terminal, key: str) -> None:
    terminal.type(key)
    terminal.read(0)
    time.sleep(0.05)


def _hold(terminal: Terminal, key: str, seconds: float) -> bool:
    """Hold a key; False if this machine stalled, so that it may have looked released."""
    begun_s = pressed_s = time.monotonic()
    longest_s = 0.0
    while pressed_s < begun_s + seconds:
        _press(terminal, key)
        longest_s = max(longest_s, time.monotonic() - pressed_s)
        pressed_s = time.monotonic()
    return longest_s < REPEAT_S / 2


def _hold_until(
    terminal: Terminal, key: str, condition: Callable[[], object], first: str = ""
) -> None:
    """Press `first` and hold a key; let go and again, where a stall of this machine disarmed."""

    def held() -> bool:
        terminal.type(first)
        let_go_s = time.monotonic() + 3.0
        while time.monotonic() < let_go_s:
            _press(terminal, key)
            if condition():
                return True
        time.sleep(1.0)
        terminal.read(0)
        return False

    until(held)


def _drives_at(sim: roburoc4.Simulator, linear_m_s: float) -> bool:
    return sim.state.target_linear_m_s == pytest.approx(linear_m_s, rel=0.2)


def _moves(sim: roburoc4.Simulator) -> bool:
    return sim.state.nonzero_speed_commands > 0


def test_a_repeating_key_drives_and_letting_go_stops(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    _hold_until(terminal, "w", lambda: _drives_at(sim, 0.3))
    until(lambda: last_command_is_zero(sim))
    assert terminal.wait(keys="x") == 0
    assert sim.true_pose.x_m > 0.01


def test_with_releases_one_press_lasts_until_the_release(sim: roburoc4.Simulator) -> None:
    press, release = "\x1b[119;1:1u", "\x1b[119;1:3u"
    terminal = _teleop(sim, RELEASES)

    def drives_with_one_press() -> bool:
        terminal.type(release + press)
        _hold(terminal, ECHO, 1.0)
        return _drives_at(sim, 0.3)

    until(drives_with_one_press)  # again where this machine stalled, which stops until a new press
    assert "until let go" in terminal.text
    terminal.type(release)
    _hold_until(terminal, ECHO, lambda: last_command_is_zero(sim))
    assert terminal.wait(keys="\x1b[120;1:1u") == 0


def test_override_is_shown_and_ends_with_a_new_press(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    sim.set("pad_a", True)
    terminal.wait_for("● OVERRIDE")
    held_before = _hold(terminal, "w", 0.5)
    assert sim.state.nonzero_speed_commands == 0
    sim.set("pad_a", False)
    held = _hold(terminal, "w", 0.5)
    if held and held_before:
        assert sim.state.nonzero_speed_commands == 0, "the key is still that of before"
    _hold_until(terminal, "w", lambda: _moves(sim))
    assert terminal.wait(keys="x") == 0


def test_keys_that_waited_behind_a_frozen_terminal_do_not_drive(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    terminal.wait_for(r"1\.0 m/s  1\.0 rad/s", keys="+++")
    terminal.type("\x13")  # Ctrl-S: what it shows waits, and so does the program
    time.sleep(0.5)
    terminal.type("w")
    time.sleep(1.5)
    terminal.type("\x11")
    for _ in range(20):
        terminal.read(0.05)
    assert sim.state.nonzero_speed_commands == 0
    _hold_until(terminal, "w", lambda: _moves(sim))
    assert terminal.wait(keys="x") == 0


def test_space_stops(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    _hold_until(terminal, "w", lambda: _moves(sim))
    terminal.type(" ")
    before = sim.state.nonzero_speed_commands
    until(lambda: last_command_is_zero(sim))
    assert sim.state.nonzero_speed_commands - before < 10, "sooner than by letting go"
    terminal.wait_for("press enter to drive again")
    before = sim.state.nonzero_speed_commands
    _hold(terminal, "w", 1.0)
    assert sim.state.nonzero_speed_commands == before
    _hold_until(terminal, "w", lambda: sim.state.nonzero_speed_commands > before, first="\n")
    assert terminal.wait(keys="x") == 0


def test_a_lost_robot_is_reported_in_words_for_drivers(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    sim.set("power", False)
    terminal.wait_for("not armed|not ready|not connected")
    terminal.wait_for("lost")
    assert terminal.wait(keys="x") == 1
    assert "power and cable" in terminal.text
    assert "arm()" not in terminal.text
    assert ".link" not in terminal.text


def test_a_signal_stops_the_robot_and_restores_the_terminal(sim: roburoc4.Simulator) -> None:
    terminal = _teleop(sim, NO_RELEASES)
    _hold_until(terminal, "w", lambda: _moves(sim))
    terminal.send_signal(signal.SIGHUP)
    assert terminal.wait() == 129
    assert last_command_is_zero(sim)
    assert "\x1b[<u" in terminal.text
    assert "\x1b[?1004l" in terminal.text
