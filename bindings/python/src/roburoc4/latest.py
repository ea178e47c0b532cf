# SPDX-License-Identifier: MIT
"""What tools show of a robot: its latest statuses, or None where there are none."""

from typing import TypeVar, cast

from .records import (
    BatteryStatus,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    Status,
    TelemeterStatus,
)
from .robot_base import RobotBase

__all__ = ["latest"]

_S = TypeVar("_S", bound=Status)
_SERVICES: dict[type, str] = {
    IoCardStatus: "iocard",
    TelemeterStatus: "telemeter",
    BatteryStatus: "battery",
    LocalizationStatus: "localization",
    DifferentialStatus: "differential",
}


def latest(robot: RobotBase, kind: type[_S]) -> _S | None:
    """Return the latest status of this kind, without waiting for the first."""
    service = _SERVICES[kind]
    return None if robot.age_s(service) is None else cast(_S, getattr(robot, service))
