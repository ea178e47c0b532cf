# SPDX-License-Identifier: MIT
"""Drive, watch and simulate a RobuROC4 mobile robot.

    import roburoc4

    with roburoc4.connect("192.168.0.2") as robot:
        robot.arm()
        robot.drive_for(0.5, 0.0, seconds=2)

Units are SI and radians; X is forward, Y left, angles counter-clockwise. What is on the wire is in
:mod:`roburoc4.protocol`, asyncio's robot in :mod:`roburoc4.aio`.
"""

from typing import TYPE_CHECKING, Any

from . import _native
from .constants import (
    BatteryState,
    Count,
    Event,
    Fault,
    LocalizationFlag,
    MoveOutcome,
    Result,
    Role,
    Service,
    State,
    StopOutcome,
)
from .errors import (
    ArgumentError,
    ClosedError,
    NetworkError,
    NotArmedError,
    NotKnownError,
    RecordingError,
    RefusedError,
    RobotError,
    RobotTimeoutError,
    SamplesLostError,
)
from .moves import MoveError, MoveResult
from .records import (
    BatteryStatus,
    DifferentialStatus,
    Facts,
    IoCardStatus,
    LocalizationStatus,
    Status,
    TelemeterStatus,
)
from .robot import Robot, UnthreadedRobot, connect
from .samples import Events, Recording, Statuses, flatten
from .settings import Settings
from .simulator import SimSettings, Simulator

if TYPE_CHECKING:
    from . import aio, protocol

__all__ = [
    "ArgumentError",
    "BatteryState",
    "BatteryStatus",
    "ClosedError",
    "Count",
    "DifferentialStatus",
    "Event",
    "Events",
    "Facts",
    "Fault",
    "IoCardStatus",
    "LocalizationFlag",
    "LocalizationStatus",
    "MoveError",
    "MoveOutcome",
    "MoveResult",
    "NetworkError",
    "NotArmedError",
    "NotKnownError",
    "Recording",
    "RecordingError",
    "RefusedError",
    "Result",
    "Robot",
    "RobotError",
    "RobotTimeoutError",
    "Role",
    "SamplesLostError",
    "Service",
    "Settings",
    "SimSettings",
    "Simulator",
    "State",
    "Status",
    "Statuses",
    "StopOutcome",
    "TelemeterStatus",
    "UnthreadedRobot",
    "aio",
    "connect",
    "flatten",
    "protocol",
]

__version__ = "{}.{}.{}".format(*_native.roburoc4_version().to_bytes(3, "big"))

# These take longer to import than everything else.
_LATER = {
    "aio": ".aio",
    "protocol": ".protocol",
}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    module = importlib.import_module(_LATER[name], __name__)
    return getattr(module, name, module)


def __dir__() -> list[str]:
    return __all__
