# SPDX-License-Identifier: MIT
"""Names for the numbers of the manual and of the client.

Each class mirrors a family of ``ROBUROC4_*`` constants in the headers; a test compares them.
Members are described by ``text``, which comes from the C library, or by a docstring here.
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
    "StopOutcome",
    "WireError",
]

DEFAULT_HOST = "192.168.0.2"
DEFAULT_PORT = 60000
CYCLE_S = 0.01
"""One low-level cycle of the robot in seconds: the unit of ``robot_cycles``."""
MAX_DRIVE_M_S = _native.ROBUROC4_MAX_DRIVE_M_S
MAX_DRIVE_RAD_S = _native.ROBUROC4_MAX_DRIVE_RAD_S
"""The highest speeds that ``drive`` takes, and the highest ceilings."""


class Service(IntEnum):
    """A service, named by its id on a RobuROC4 (manual 4.2.1); a robot may use other ids."""

    DIRECTORY = 0
    """Lists the services."""
    NOTIFICATION = 1
    """Accepts subscriptions."""
    IOCARD = 2
    """Inputs and outputs, analog and digital."""
    TELEMETER = 3
    """Ultrasonic distances."""
    BATTERY = 4
    """State and charge of the battery."""
    LOCALIZATION = 5
    """Odometry: the pose."""
    DIFFERENTIAL = 6
    """Speeds, and drive commands."""


class Action(IntEnum):
    """What a request asks for (4.2.2 to 4.2.6)."""

    GET = 0
    """Read properties."""
    QUERY = 1
    """Read a text."""
    REPLACE = 2
    """Set the pose."""
    UPDATE = 3
    """Known from other robots of the family."""
    INSERT = 4
    """Subscribe."""
    DELETE = 5
    """Unsubscribe; known from other robots of the family."""
    SUBMIT = 6
    """Known from other robots of the family."""


class WireError(IntEnum):
    """Error byte of an answer (4.2.2.2); 0x10 and above are specific to the service."""

    NONE = 0
    """Success."""
    TARGET = 1
    """There is no such service."""
    UNSUPPORTED = 2
    """The service does not have this action."""
    ACTION = 3
    """There is no such action."""
    LENGTH = 4
    """The request has the wrong length."""
    DATA = 5
    """The request has invalid contents."""
    SERVICE = 0x10
    """This and above: specific to the service."""


class BatteryState(IntEnum):
    """State of the battery (4.2.4.6)."""

    CHARGING = 0
    """The charger is plugged in."""
    CHARGED = 1
    """Full."""
    OK = 2
    """In use, with enough charge."""
    CRITICAL = 3
    """Charge it now."""


class LocalizationFlag(IntFlag):
    """Quality of the localization (4.2.4.7)."""

    INVALID = 0x01
    """The pose is meaningless."""
    METRIC = 0x02
    """Accurate to metres."""
    DECIMETRIC = 0x04
    """Accurate to decimetres."""
    CENTIMETRIC = 0x08
    """Accurate to centimetres."""
    PROPRIOCEPTIVE = 0x10
    """From the robot's own motion: odometry."""
    EXTEROCEPTIVE = 0x20
    """From the robot's surroundings."""
    ERROR = 0x40
    """The localization does not work."""


class IoType(IntEnum):
    """Kind of a channel of the IO card (4.2.3.3)."""

    ANALOG_INPUT = 0
    """Generally volts."""
    ANALOG_OUTPUT = 1
    """Generally volts; a RobuROC4 has none."""
    DIGITAL_INPUT = 2
    """On or off: bumpers, game pad buttons."""
    DIGITAL_OUTPUT = 3
    """On or off."""


class State(IntEnum):
    """State of a client."""

    IDLE = 0
    """Closed, or not started."""
    CONNECTING = 1
    """Asks whether a robot is there."""
    DISCOVERING = 2
    """Reads the list of services and their properties."""
    SUBSCRIBING = 3
    """Subscribes to statuses."""
    READY = 4
    """Statuses arrive; it can be armed."""
    LOST = 5
    """Was ready, then the robot fell silent: requests are repeated."""
    CLOSING = 6
    """Sends the last zero commands."""


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
    LAPSED = 10
    ODOMETRY = 11
    RELOCALIZED = 12
    OFF_COURSE = 13
    TOO_FAST = 14
    NO_FRONT_BUMPER = 15
    NO_REAR_BUMPER = 16
    NO_FRONT_TELEMETER = 17
    NO_REAR_TELEMETER = 18

    @property
    def text(self) -> str:
        """What it means and what to do, as a sentence."""
        return _native.roburoc4_move_outcome_text(self)


class StopOutcome(IntEnum):
    """How the last stop sequence ended."""

    NONE = 0
    """None was sent yet."""
    RUNNING = 1
    """It has not ended."""
    CONFIRMED = 2
    """A status from well after the zeros shows targets of 0."""
    TIMED_OUT = 3
    """The robot did not show that in time."""
    OVERRIDDEN = 4
    """Somebody held [A] on the game pad, so the robot may have ignored the zeros."""


class Role(IntEnum):
    """The role of an input, whatever its index."""

    OVERRIDE = 0
    """Game pad [A]: somebody drives by hand."""
    FRONT_BUMPER = 1
    """The front bumper is pressed."""
    REAR_BUMPER = 2
    """The rear bumper is pressed."""
    BATTERY_V = 3
    """The battery's voltage."""


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
    LAPSED = 0x00002000
    STOP_CONFIRMED = 0x00004000
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
    STOP_UNCONFIRMED = 0x20000000

    @property
    def text(self) -> str:
        """What happened, as a sentence; several events one after the other."""
        return "; ".join(
            _native.roburoc4_name(_native.ROBUROC4_NAME_EVENT, event) for event in self
        )


class Fault(IntEnum):
    """Why the network did not accept or deliver a datagram."""

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
    """Counters of datagrams by what became of them."""

    RECEIVED = 0
    """Datagrams received."""
    SENT = 1
    """Datagrams that were sent."""
    RETRIES = 2
    """Requests that were repeated."""
    SHORT = 3
    """Dropped: shorter than their layout."""
    MALFORMED = 4
    """Dropped: invalid contents."""
    UNMATCHED = 5
    """Dropped: answers to no open request."""
    UNEXPECTED_STATUS = 6
    """Dropped: statuses that were not subscribed to."""
    OLD = 7
    """Dropped: statuses not newer than the last."""
    SURPLUS = 8
    """Used, but longer than their layout."""
    REFUSED = 9
    """Requests that the robot answered with an error."""
    ABANDONED = 10
    """Requests without an answer after all tries."""
    LOST = 11
    """How often the robot fell silent."""
    REBOOTS = 12
    """How often the robot restarted."""
    CLOCK_FAULTS = 13
    """How often this machine's clock went back."""


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
    NOT_KNOWN = -10
    INDEX = -11
    RESERVED = -12
    NOT_FINITE = -13
    UNMATCHED = -14
    UNEXPECTED_STATUS = -15
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
    STOP_CALLED = -34
    LAPSED = -35
    UPLINK = -36
    UNITS = -37
    SUBSCRIPTION_REFUSED = -38
    SYSTEM = -40
    RESOLVE = -41
    CLOSED = -42
    BUSY = -43
    ADDRESS = -44

    @property
    def text(self) -> str:
        """What it means, in one sentence."""
        return _native.roburoc4_result_text(self)
