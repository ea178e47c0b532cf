# SPDX-License-Identifier: MIT
"""Drive, watch and simulate a RobuROC4 mobile robot.

    import roburoc4

    with roburoc4.connect("192.168.0.2") as robot:
        robot.arm()
        robot.drive_for(0.5, 0.0, seconds=2)

Units are SI and radians; X is forward, Y left, angles counter-clockwise.
"""

from typing import TYPE_CHECKING, Any

from . import _native, constants, errors, iocard, records
from .connection import RecorderState
from .constants import *
from .constants import CYCLE_S, DEFAULT_HOST, DEFAULT_PORT
from .errors import *
from .iocard import *
from .moves import MoveError, MoveResult
from .records import *
from .robot import ManualRobot, Robot, connect, resolve
from .samples import Events, Gap, Reader, Recording, Statuses, flatten
from .settings import Settings
from .simulator import SimSettings, Simulator
from .telegrams import Batch, Layout, decode, decode_batch

__all__ = [
    "CYCLE_S",
    "DEFAULT_HOST",
    "DEFAULT_PORT",
    "Batch",
    "Command",
    "Events",
    "Gap",
    "Layout",
    "ManualRobot",
    "MoveError",
    "MoveResult",
    "Reader",
    "RecordedEvent",
    "RecordedRobot",
    "RecorderState",
    "Recording",
    "RecordingError",
    "Robot",
    "Settings",
    "SimSettings",
    "Simulator",
    "Statuses",
    "aio",
    "connect",
    "decode",
    "decode_batch",
    "flatten",
    "open_recording",
    "resolve",
]
__all__ += constants.__all__
__all__ += errors.__all__
__all__ += iocard.__all__
__all__ += records.__all__

__version__ = "{}.{}.{}".format(*_native.roburoc4_version().to_bytes(3, "big"))

if TYPE_CHECKING:
    from . import aio
    from .recording import (
        Command,
        RecordedEvent,
        RecordedRobot,
        RecordingError,
        open_recording,
    )

# These take longer to import than everything else.
_LATER = {
    "aio": ".aio",
    "Command": ".recording",
    "RecordedEvent": ".recording",
    "RecordedRobot": ".recording",
    "RecordingError": ".recording",
    "open_recording": ".recording",
}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    module = importlib.import_module(_LATER[name], __name__)
    return module if name == "aio" else getattr(module, name)
