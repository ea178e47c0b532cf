# SPDX-License-Identifier: MIT
"""What is on the wire: addresses, telegrams as typed records, and what the robot's answers hold."""

from .connection import resolve
from .constants import (
    CYCLE_S,
    DEFAULT_HOST,
    DEFAULT_PORT,
    MAX_DRIVE_M_S,
    MAX_DRIVE_RAD_S,
    Action,
    IoType,
    WireError,
)
from .errors import DecodeError
from .records import (
    Answer,
    BatteryProperties,
    DifferentialCommand,
    DifferentialProperties,
    DirectoryEntry,
    IoCardCommand,
    IoCardProperties,
    LocalizationProperties,
    Request,
    Subscription,
    Telegram,
    TelemeterProperties,
    UnknownCommand,
    UnknownStatus,
)
from .settings import STATUS_SERVICES, service_of
from .telegrams import Batch, Layout, decode, decode_batch, encode_answer, usual_answer

__all__ = [
    "CYCLE_S",
    "DEFAULT_HOST",
    "DEFAULT_PORT",
    "MAX_DRIVE_M_S",
    "MAX_DRIVE_RAD_S",
    "STATUS_SERVICES",
    "Action",
    "Answer",
    "Batch",
    "BatteryProperties",
    "DecodeError",
    "DifferentialCommand",
    "DifferentialProperties",
    "DirectoryEntry",
    "IoCardCommand",
    "IoCardProperties",
    "IoType",
    "Layout",
    "LocalizationProperties",
    "Request",
    "Subscription",
    "Telegram",
    "TelemeterProperties",
    "UnknownCommand",
    "UnknownStatus",
    "WireError",
    "decode",
    "decode_batch",
    "encode_answer",
    "resolve",
    "service_of",
    "usual_answer",
]
