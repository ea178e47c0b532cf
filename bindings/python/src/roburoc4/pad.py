# SPDX-License-Identifier: MIT
"""Game pad and emergency stops of a simulated robot."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal

from . import _native
from .constants import Result
from .errors import ArgumentError

__all__ = ["EmergencyStop", "GamePad"]

Act = Callable[..., Any]

_BUTTONS = {
    "a": 8,
    "b": 9,
    "x": 10,
    "y": 11,
    "back": 12,
    "start": 13,
    "d_down": 14,
    "d_left": 15,
    "d_right": 16,
    "d_up": 17,
    "lj": 18,
    "rj": 19,
    "lb": 20,
    "rb": 21,
}
_AXES = {"lj_x": 3, "lj_y": 4, "rj_x": 5, "rj_y": 6, "lt": 7, "rt": 8}


def _find(names: dict[str, int], name: str, what: str) -> int:
    found = names.get(name.lower())
    if found is None:
        raise ArgumentError(f"no {what} {name!r}: there are {', '.join(names)}", Result.INDEX)
    return found


class GamePad:
    """The game pad (manual 4.1, 5.4). Holding [A] takes the robot from every client."""

    def __init__(self, act: Act) -> None:
        self._act = act

    def press(self, button: str = "a") -> None:
        """Press a button: a, b, x, y, back, start, d_down, ..., lj, rj, lb, rb."""
        self._act(_native.roburoc4_sim_set_pad_button, _find(_BUTTONS, button, "button"), 1)

    def release(self, button: str = "a") -> None:
        """Let a button go."""
        self._act(_native.roburoc4_sim_set_pad_button, _find(_BUTTONS, button, "button"), 0)

    @contextmanager
    def held(self, button: str = "a") -> Iterator[None]:
        """Hold a button for the length of a ``with`` block."""
        self.press(button)
        try:
            yield
        finally:
            self.release(button)

    def move(self, axis: str, value: float) -> None:
        """Move an axis to -1..1: lj_x, lj_y, rj_x, rj_y rest at 0, lt and rt at -1.

        With [A] held, rt drives forward, lt backward, and lj_x turns (right is clockwise).
        """
        self._act(_native.roburoc4_sim_set_pad_axis, _find(_AXES, axis, "axis"), value)

    def release_all(self) -> None:
        """Let all buttons and axes go."""
        self._act(_native.roburoc4_sim_release_pad)


class EmergencyStop:
    """The emergency stops: local (5.1) and remote (5.2). Pressed, the robot brakes."""

    def __init__(self, act: Act) -> None:
        self._act = act

    def press(self, which: Literal["local", "remote"] = "local") -> None:
        """Press one: motor power goes."""
        self._act(_native.roburoc4_sim_set_estop, _WHICH[which], 1)

    def release(self, which: Literal["local", "remote"] = "local") -> None:
        """Release one; power comes back with ``Simulator.press_motor_button`` only."""
        self._act(_native.roburoc4_sim_set_estop, _WHICH[which], 0)


_WHICH = {"local": 0, "remote": 1}
