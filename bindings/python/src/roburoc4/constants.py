# SPDX-License-Identifier: MIT
"""Names for the manual's numbers and for those of the client.

Each class mirrors a family of ``ROBUROC4_*`` constants of the headers; a test compares them.
"""

from enum import IntEnum, IntFlag

from . import _native

__all__ = [
    "Action",
    "BatteryState",
    "Count",
    "Event",
    "Fault",
    "IoType",
    "LocalizationFlag",
    "MoveOutcome",
    "Result",
    "Role",
    "Service",
    "State",
    "WireError",
]

DEFAULT_HOST = "192.168.0.2"
DEFAULT_PORT = 60000
CYCLE_S = 0.01
"""One low level cycle of the robot in seconds: the unit of ``robot_cycles``."""


class Service(IntEnum):
    """A service, named by its id on a RobuROC4 (manual 4.2.1), whatever id a robot gives it."""

    DIRECTORY = 0
    NOTIFICATION = 1
    IOCARD = 2
    TELEMETER = 3
    BATTERY = 4
    LOCALIZATION = 5
    DIFFERENTIAL = 6


class Action(IntEnum):
    """What a request asks for (4.2.2 to 4.2.6)."""

    GET = 0
    QUERY = 1
    REPLACE = 2
    UPDATE = 3
    INSERT = 4
    DELETE = 5
    SUBMIT = 6


class WireError(IntEnum):
    """Error byte of an answer (4.2.2.2); 0x10 and more are the service's own."""

    NONE = 0
    TARGET = 1
    UNSUPPORTED = 2
    ACTION = 3
    LENGTH = 4
    DATA = 5
    SERVICE = 0x10


class BatteryState(IntEnum):
    """State of the battery (4.2.4.6)."""

    CHARGING = 0
    CHARGED = 1
    OK = 2
    CRITICAL = 3


class LocalizationFlag(IntFlag):
    """Quality of the localization (4.2.4.7)."""

    INVALID = 0x01
    METRIC = 0x02
    DECIMETRIC = 0x04
    CENTIMETRIC = 0x08
    PROPRIOCEPTIVE = 0x10
    EXTEROCEPTIVE = 0x20
    ERROR = 0x40


class IoType(IntEnum):
    """Kind of a channel of the IO card (4.2.3.3)."""

    ANALOG_INPUT = 0
    ANALOG_OUTPUT = 1
    DIGITAL_INPUT = 2
    DIGITAL_OUTPUT = 3


class State(IntEnum):
    """State of a client."""

    IDLE = 0
    CONNECTING = 1
    DISCOVERING = 2
    SUBSCRIBING = 3
    READY = 4
    LOST = 5
    CLOSING = 6


class MoveOutcome(IntEnum):
    """How a move ended."""

    RUNNING = 0
    REACHED = 1
    OVERRIDE = 2
    BUMPER = 3
    OBSTACLE = 4
    INHIBITED = 5
    LOST = 6
    OTHER_COMMANDER = 7
    TIMEOUT = 8
    CANCELLED = 9

    @property
    def text(self) -> str:
        """What it means and what to do, as a sentence."""
        return _native.roburoc4_move_result_text(self)


class Role(IntEnum):
    """What an input is for, whatever its index."""

    OVERRIDE = 0
    FRONT_BUMPER = 1
    REAR_BUMPER = 2
    BATTERY_V = 3


class Event(IntFlag):
    """What changed."""

    STATE = 0x00000001
    READY = 0x00000002
    LOST = 0x00000004
    REBOOT = 0x00000008
    PROPERTIES = 0x00000010
    DESCRIPTION = 0x00000020
    IOCARD = 0x00000040
    TELEMETER = 0x00000080
    BATTERY = 0x00000100
    LOCALIZATION = 0x00000200
    DIFFERENTIAL = 0x00000400
    ARMED = 0x00000800
    DISARMED = 0x00001000
    LEASE_OVER = 0x00002000
    STOPPED = 0x00004000
    OVERRIDE = 0x00008000
    OTHER_COMMANDER = 0x00010000
    INHIBITED = 0x00020000
    BATTERY_LOW = 0x00040000
    BATTERY_CRITICAL = 0x00080000
    RELOCALIZED = 0x00100000
    RELOCALIZE_FAILED = 0x00200000
    SUBSCRIPTION_REFUSED = 0x00400000
    FIXED_ID = 0x00800000
    CLOCK = 0x01000000
    CAPACITY = 0x02000000
    DESCRIPTIONS_DONE = 0x04000000
    ROLE = 0x08000000
    ARMABLE = 0x10000000


class Fault(IntEnum):
    """Why the network did not take or deliver a datagram."""

    NONE = 0
    REFUSED = 1
    UNREACHABLE = 2
    DOWN = 3
    DENIED = 4
    FULL = 5
    OTHER = 6

    @property
    def text(self) -> str:
        """What it means and what to check, in one sentence."""
        return _native.roburoc4_udp_fault_text(self)


class Count(IntEnum):
    """Counters of what became of datagrams."""

    RECEIVED = 0
    SENT = 1
    RETRIES = 2
    SHORT = 3
    MALFORMED = 4
    UNMATCHED = 5
    UNSUBSCRIBED = 6
    OLD = 7
    SURPLUS = 8
    REFUSED = 9
    ABANDONED = 10
    LOST = 11
    REBOOTS = 12
    CLOCK_FAULTS = 13


class Result(IntEnum):
    """Why a call failed: the ``code`` of a :class:`~roburoc4.RobotError`."""

    OK = 0
    ARGUMENT = -1
    BUFFER = -2
    SHORT = -3
    KIND = -4
    VALUE = -5
    ROBOT = -6
    SIZE = -7
    CONFIG = -8
    STATE = -9
    UNKNOWN = -10
    INDEX = -11
    RESERVED = -12
    NOT_FINITE = -13
    UNMATCHED = -14
    UNSUBSCRIBED = -15
    OLD = -16
    TIMEOUT = -17
    DISARMED = -20
    NOT_READY = -21
    NO_DIFFERENTIAL = -22
    LIMITS = -23
    STALE_DIFFERENTIAL = -24
    STALE_IOCARD = -25
    OVERRIDE_UNKNOWN = -26
    OVERRIDE = -27
    MOVING = -28
    OTHER_COMMANDER = -29
    LOST = -30
    REBOOT = -31
    CLOCK = -32
    INHIBITED = -33
    SYSTEM = -40
    RESOLVE = -41
    CLOSED = -42

    @property
    def text(self) -> str:
        """What it means, in one sentence."""
        return _native.roburoc4_result_text(self)
