# SPDX-License-Identifier: MIT
"""Statuses as the rows of a table: one row for each robot cycle in which there was a status."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from .output import plain

if TYPE_CHECKING:
    from roburoc4 import Properties, Status

Cell = float | int | None

_CYCLES_IN_A_SECOND = 100
_LATE_CYCLES = 50  # a status that comes later than this gets a row of its own
_REBOOT_CYCLES = 100

_FIXED = (
    "localization_x_m",
    "localization_y_m",
    "localization_theta_rad",
    "localization_flags",
    "differential_target_linear_m_s",
    "differential_current_linear_m_s",
    "differential_target_angular_rad_s",
    "differential_current_angular_rad_s",
    "battery_state",
    "battery_remaining_percent",
)


def columns(properties: Properties) -> list[str]:
    """Name the columns: the time, then all that a robot with these properties reports."""
    names = ["utc_s", "robot_s", "robot_cycles", *_FIXED]
    names += [f"telemeter_distance_{index}_m" for index in range(len(properties.telemeter))]
    card = properties.iocard
    if card is not None:
        names += [f"iocard_analog_input_{index}" for index in range(card.analog_inputs)]
        names += [f"iocard_digital_input_{index}" for index in range(card.digital_inputs)]
    return names


def cells(status: Status) -> dict[str, Cell]:
    """Give the values of one status by column."""
    from roburoc4 import flatten

    # 1 and 0 rather than True and False: every reader of CSV takes them for numbers.
    return {
        f"{status.kind}_{name}": None if value is None else +value
        for name, value in plain(flatten(status)).items()
        if name not in ("robot_cycles", "host_us", "utc_s")
    }


class Rows:
    """Statuses in, rows out, in the robot's order."""

    def __init__(self) -> None:
        self._open: dict[int, dict[str, Cell]] = {}
        self._newest = 0

    def add(self, status: Status) -> Iterator[dict[str, Cell]]:
        """Take a status; yield the rows to which nothing can be added any more."""
        cycles = status.robot_cycles
        if cycles + _REBOOT_CYCLES < self._newest:
            yield from self.rest()
            self._newest = 0
        self._newest = max(self._newest, cycles)
        self._open.setdefault(cycles, {"utc_s": status.utc_s}).update(cells(status))
        for old in sorted(self._open):
            if old + _LATE_CYCLES > self._newest:
                break
            yield self._close(old)

    def rest(self) -> Iterator[dict[str, Cell]]:
        """Yield the rows that are open at the end."""
        for cycles in sorted(self._open):
            yield self._close(cycles)

    def _close(self, cycles: int) -> dict[str, Cell]:
        return {
            **self._open.pop(cycles),
            "robot_s": cycles / _CYCLES_IN_A_SECOND,
            "robot_cycles": cycles,
        }
