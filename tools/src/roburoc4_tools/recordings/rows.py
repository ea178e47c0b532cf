# SPDX-License-Identifier: MIT
"""Statuses as table rows: one row for each robot cycle in which there was a status."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import IO, TYPE_CHECKING

from ..plain import plain

if TYPE_CHECKING:
    from pathlib import Path

    from roburoc4 import Status
    from roburoc4.records import Properties

Cell = float | int | None

_CYCLES_IN_A_SECOND = 100
_LATE_CYCLES = 50  # a status that arrives later than this gets its own row
_REBOOT_CYCLES = 100
_LONGEST_LINE = 1 << 16
_MOST = 3.4e38  # of a float on the wire
_MOST_S = 1 << 31
_NO_STATE = -1
_TELEMETERS = 2

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


def _telemeters(count: int) -> list[str]:
    return [f"telemeter_distance_{index}_m" for index in range(count)]


def columns(properties: Properties | None = None) -> list[str]:
    """Name the columns: the time, then everything that a robot with these properties reports.

    Without properties, those of a RobuROC4 without IO card.
    """
    names = ["utc_s", "robot_s", "robot_cycles", *_FIXED]
    names += _telemeters(len(properties.telemeter) if properties else _TELEMETERS)
    card = properties.iocard if properties else None
    if card is not None:
        names += [f"iocard_analog_input_{index}" for index in range(card.analog_inputs)]
        names += [f"iocard_digital_input_{index}" for index in range(card.digital_inputs)]
    return names


def cells(status: Status) -> dict[str, Cell]:
    """Give the values of one status by column."""
    from roburoc4 import flatten

    # 1 and 0 instead of True and False: every CSV reader takes them for numbers.
    return {
        f"{status.service}_{name}": None if value is None else +value
        for name, value in plain(flatten(status)).items()
        if name not in ("robot_cycles", "host_us", "utc_s")
    }


class Rows:
    """Collects statuses and returns rows, in the robot's order."""

    def __init__(self) -> None:
        self._open: dict[int, dict[str, Cell]] = {}
        self._newest = 0

    def add(self, status: Status) -> Iterator[dict[str, Cell]]:
        """Take a status; yield the rows that are complete."""
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


def statuses(path: Path, file: IO[bytes]) -> Iterator[Status]:
    """Read the statuses from a file of such rows, without those of the IO card.

    Missing values are 0, or NaN if another value of the same status is present.
    """
    from roburoc4 import RecordingError

    names: list[str] = []
    number = 0
    while line := file.readline(_LONGEST_LINE):
        number += 1
        row = line.decode(errors="replace").rstrip("\r\n").split(",")
        names = names or row
        if not line.endswith(b"\n") or b"\0" in line or len(row) != len(names):
            raise RecordingError(
                f"{path} is truncated or damaged in line {number}: save the rest with "
                f"roburoc4 recover {path}"
            )
        if number == 1:
            continue
        try:
            yield from _of_row(
                {name: _number(cell) for name, cell in zip(names, row, strict=True) if cell}
            )
        except ValueError as error:
            raise RecordingError(
                f"{path}, line {number}: {error}; correct or delete the line"
            ) from None
    if "utc_s" not in names:
        raise RecordingError(
            f"{path} has no column utc_s: give a CSV file that roburoc4 record has written"
        )


def _number(cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not abs(value) <= _MOST:
        raise ValueError(f"{cell!r} is not a number that a robot reports")
    return value


def _of_row(values: dict[str, float]) -> Iterator[Status]:
    from roburoc4 import (
        BatteryState,
        BatteryStatus,
        DifferentialStatus,
        LocalizationStatus,
        TelemeterStatus,
    )

    if not 0 <= values.get("utc_s", math.nan) < _MOST_S:
        raise ValueError("utc_s is missing or wrong")
    utc_s = values["utc_s"]
    cycles, times = int(values.get("robot_cycles", 0)), (round(utc_s * 1e6), utc_s)

    def take(names: Sequence[str]) -> Sequence[float]:
        found = [values.get(name, math.nan) for name in names]
        return () if all(map(math.isnan, found)) else found

    # speeds first: a pose in an MCAP file has those that came before it
    if speeds := take(_FIXED[4:8]):
        target_m_s, current_m_s, target_rad_s, current_rad_s = speeds
        yield DifferentialStatus(
            cycles, target_m_s, current_m_s, target_rad_s, current_rad_s, *times
        )
    if pose := take(_FIXED[:3]):
        x_m, y_m, theta_rad = pose
        flags = int(values.get("localization_flags", 0))
        yield LocalizationStatus(cycles, x_m, y_m, theta_rad, flags, *times)
    if distances_m := take(_telemeters(_TELEMETERS)):
        yield TelemeterStatus(cycles, tuple(distances_m), *times)
    if "battery_remaining_percent" in values:
        state = int(values.get("battery_state", _NO_STATE))
        known = BatteryState(state) if state in set(BatteryState) else state
        yield BatteryStatus(cycles, known, int(values["battery_remaining_percent"]), *times)
