# SPDX-License-Identifier: MIT
"""The simulator's panel: what the page can do to a simulated robot, and its real state."""

from __future__ import annotations

import math
from typing import Any

from roburoc4.errors import ArgumentError
from roburoc4.simulator import Simulator

from .history import number

_MOST_BOXES = 32
_DELAYS_MS = 2000.0
_FAULTS = ("loss", "duplicate", "reorder", "corrupt", "delay_ms", "jitter_ms")
_ROOM = (
    (6.0, 0.0, 0.2, 12.2),
    (-6.0, 0.0, 0.2, 12.2),
    (0.0, 6.0, 11.8, 0.2),
    (0.0, -6.0, 11.8, 0.2),
    (3.4, 1.6, 0.8, 0.8),
    (-2.2, -2.6, 0.5, 1.4),
)
"""Four walls and two crates: middle and size in X and Y, in metres."""
_WORDS = ("pad", "estop", "brakes", "motor", "power", "charger", "battery", "pin", "place")
_BUMPERS = ("front", "rear")


class PanelError(Exception):
    """Why the simulator refuses this; shown on the page."""


class Panel:
    """What a page can do to a simulated robot."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._boxes: list[list[float]] = []
        self._faults = dict.fromkeys(_FAULTS, 0.0)
        # Only obstacles that were put here are known here, and can be drawn and dragged.
        simulator.clear_obstacles()
        for box in _ROOM:
            self.add_box(*box)

    def now(self) -> dict[str, Any]:
        """Return the real state of the simulated robot."""
        state = self._simulator.state
        return {
            "powered": bool(state.powered),
            "motors_enabled": bool(state.motors_enabled),
            "estop_local": bool(state.estop_local),
            "estop_remote": bool(state.estop_remote),
            "brakes_released": bool(state.brakes_released),
            "charger": bool(state.charger),
            "overridden": bool(state.overridden),
            "watchdog_tripped": bool(state.watchdog_tripped),
            "front_bumper": bool(state.front_bumper),
            "rear_bumper": bool(state.rear_bumper),
            "battery_percent": number(state.battery_percent, 1),
            "pose": {
                "x_m": number(state.true_x_m),
                "y_m": number(state.true_y_m),
                "theta_rad": number(state.true_theta_rad, 4),
            },
            "boxes": self._boxes,
            "faults": self._faults,
        }

    def obey(self, line: str) -> None:
        """Execute a line such as "estop local press"."""
        if line.partition(" ")[0] not in _WORDS + _BUMPERS:
            raise PanelError(f"the panel has no {line!r}")
        self._panel(line)

    def _panel(self, line: str) -> str:
        try:
            return self._simulator.panel(line)
        except ArgumentError as error:
            raise PanelError(str(error)) from None

    def add_box(self, x_m: float, y_m: float, size_x_m: float, size_y_m: float) -> None:
        """Put an obstacle on the floor."""
        if len(self._boxes) >= _MOST_BOXES:
            raise PanelError(f"there are {_MOST_BOXES} obstacles already: clear them first")
        try:
            self._simulator.add_box(x_m, y_m, size_x_m, size_y_m)
        except Exception as error:
            raise PanelError(f"no obstacle fits there: {error}") from None
        self._boxes.append([x_m, y_m, size_x_m, size_y_m])

    def move_box(self, index: int, x_m: float, y_m: float) -> None:
        """Drag an obstacle to another place; it stops at the robot."""
        if not 0 <= index < len(self._boxes):
            raise PanelError(f"there is no obstacle {index}")
        try:
            self._panel(f"box move {index} {x_m:.4f} {y_m:.4f} 0")
        except PanelError:
            return  # it stops at the robot
        self._boxes[index][:2] = [x_m, y_m]

    def clear(self) -> None:
        """Remove all obstacles."""
        self._simulator.clear_obstacles()
        self._boxes.clear()

    def set_faults(self, faults: dict[str, float]) -> None:
        """Degrade the network between dashboard and robot; faults that are not named are off."""
        unknown = set(faults) - set(_FAULTS)
        if unknown:
            raise PanelError(f"no such fault: {', '.join(sorted(unknown))}")
        wanted = dict.fromkeys(_FAULTS, 0.0) | faults
        for name in ("delay_ms", "jitter_ms"):
            if not (math.isfinite(wanted[name]) and 0.0 <= wanted[name] <= _DELAYS_MS):
                raise PanelError(f"{name} is 0 to {_DELAYS_MS:g}, not {wanted[name]}")
        try:
            self._simulator.set_faults(**wanted)
        except ArgumentError as error:
            raise PanelError(str(error)) from None
        self._faults = wanted
