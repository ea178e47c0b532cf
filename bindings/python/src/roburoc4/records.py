# SPDX-License-Identifier: MIT
"""What the robot reports, as immutable records.

All values are SI units and radians; X is forward, Y left, angles counter-clockwise.
``robot_cycles`` counts the robot's cycles of 10 ms since power on. ``host_us`` is when a status
was received, in microseconds of the robot object's clock (``Robot.now_s``). ``utc_s`` is when the
robot made it, in seconds since 1970 by this machine's clock: computed from ``robot_cycles``, so
without the network's jitter. Both are 0 in decoded bytes. A simulator's virtual time begins in
1970. The fields are those of the C structs in the headers, in any order.
"""

from typing import Any, NamedTuple, TypeAlias

from . import _native
from .constants import BatteryState, LocalizationFlag, Result, Service, State, StopOutcome

__all__ = [
    "Answer",
    "BatteryProperties",
    "BatteryStatus",
    "ChannelNames",
    "DifferentialCommand",
    "DifferentialProperties",
    "DifferentialStatus",
    "DirectoryEntry",
    "Facts",
    "Gap",
    "IoCardCommand",
    "IoCardProperties",
    "IoCardStatus",
    "Link",
    "LocalizationProperties",
    "LocalizationStatus",
    "Pose",
    "Properties",
    "RecorderState",
    "Request",
    "ServiceEntry",
    "ServiceLink",
    "SimState",
    "Status",
    "Subscription",
    "Telegram",
    "TelemeterProperties",
    "TelemeterStatus",
    "UnknownCommand",
    "UnknownStatus",
]


# ------------------------------------------------------------------------------------ statuses


class IoCardStatus(NamedTuple):
    """All inputs of the IO card (4.2.4.4), by their index on the wire."""

    robot_cycles: int
    analog_inputs: tuple[float, ...]
    """Generally volts; the game pad's axes are -1 to 1."""
    digital_inputs: tuple[bool, ...]
    host_us: int = 0
    utc_s: float = 0.0

    @property
    def service(self) -> str:
        """The name of its service."""
        return "iocard"


class TelemeterStatus(NamedTuple):
    """All ultrasonic distances (4.2.4.5); on a RobuROC4 front, then rear.

    The simulator reports 6 m where it sees nothing; the manual is silent about that.
    """

    robot_cycles: int
    distances_m: tuple[float, ...]
    host_us: int = 0
    utc_s: float = 0.0

    @property
    def service(self) -> str:
        """The name of its service."""
        return "telemeter"


class BatteryStatus(NamedTuple):
    """The battery (4.2.4.6)."""

    robot_cycles: int
    state: BatteryState | int
    """A plain integer if the manual does not define the state."""
    remaining_percent: int
    host_us: int = 0
    utc_s: float = 0.0

    @property
    def service(self) -> str:
        """The name of its service."""
        return "battery"

    @property
    def state_name(self) -> str:
        """The state's name in lower case, or its number."""
        state = self.state
        return state.name.lower() if isinstance(state, BatteryState) else str(state)


class LocalizationStatus(NamedTuple):
    """The pose by odometry (4.2.4.7): inaccurate after turns."""

    robot_cycles: int
    x_m: float
    y_m: float
    theta_rad: float
    flags: LocalizationFlag | int
    """A plain integer if it has bits that the manual does not define."""
    host_us: int = 0
    utc_s: float = 0.0

    @property
    def service(self) -> str:
        """The name of its service."""
        return "localization"


class DifferentialStatus(NamedTuple):
    """Speeds (4.2.4.8): commanded, and measured at the wheels."""

    robot_cycles: int
    target_linear_m_s: float
    current_linear_m_s: float
    target_angular_rad_s: float
    current_angular_rad_s: float
    host_us: int = 0
    utc_s: float = 0.0

    @property
    def service(self) -> str:
        """The name of its service."""
        return "differential"


class UnknownStatus(NamedTuple):
    """A status of a service that the layout does not name."""

    robot_cycles: int
    service: int
    """Its id on the wire."""
    payload: bytes


Status: TypeAlias = (
    IoCardStatus | TelemeterStatus | BatteryStatus | LocalizationStatus | DifferentialStatus
)
"""Any status that a robot object returns."""


# ---------------------------------------------------------------------------------- properties


class DirectoryEntry(NamedTuple):
    """A service in the directory (4.2.2.2)."""

    type: int
    id: int


class Subscription(NamedTuple):
    """An entry of the list of subscriptions (4.2.2.3)."""

    service: int
    period_cycles: int


class IoCardProperties(NamedTuple):
    """How many channels the IO card has (4.2.2.4)."""

    analog_inputs: int
    analog_outputs: int
    digital_inputs: int
    digital_outputs: int


class TelemeterProperties(NamedTuple):
    """Where a telemeter is mounted in the robot's frame, and what it can measure (4.2.2.5)."""

    x_m: float
    y_m: float
    theta_rad: float
    field_of_view_rad: float
    min_distance_m: float
    max_distance_m: float
    distance_m: float
    """Measured when the properties were read; on a connected robot, by the latest status."""


class BatteryProperties(NamedTuple):
    """The battery's data (4.2.2.6)."""

    nominal_voltage_v: float
    capacity_ah: float
    minimum_percent: int


class LocalizationProperties(NamedTuple):
    """The pose at power on (4.2.2.7)."""

    x_m: float
    y_m: float
    theta_rad: float
    flags: LocalizationFlag | int


class DifferentialProperties(NamedTuple):
    """Speeds when the properties were read, and the robot's limits (4.2.2.8)."""

    target_linear_m_s: float
    target_angular_rad_s: float
    current_linear_m_s: float
    current_angular_rad_s: float
    max_linear_m_s: float
    min_linear_m_s: float
    max_angular_rad_s: float
    min_angular_rad_s: float
    max_linear_m_s2: float
    min_linear_m_s2: float
    max_angular_rad_s2: float
    min_angular_rad_s2: float
    width_m: float


class ServiceEntry(NamedTuple):
    """A service of a connected robot."""

    id: int
    type: int
    service: str | None
    """``iocard``, ``battery`` ...; None for a service that this library does not know."""
    name: str
    """The robot's own text, else the manual's name, else empty."""


class Properties(NamedTuple):
    """What a connected robot reported about itself; None or empty for what it lacks."""

    services: tuple[ServiceEntry, ...]
    iocard: IoCardProperties | None
    telemeter: tuple[TelemeterProperties, ...]
    """Of each telemeter; on a RobuROC4 front, then rear."""
    battery: BatteryProperties | None
    localization: LocalizationProperties | None
    differential: DifferentialProperties | None


# ------------------------------------------------------------------------------ a robot object


class ChannelNames(NamedTuple):
    """Names of all channels: the robot's own text, else the manual's name."""

    analog_inputs: tuple[str, ...]
    analog_outputs: tuple[str, ...]
    digital_inputs: tuple[str, ...]
    digital_outputs: tuple[str, ...]


class RecorderState(NamedTuple):
    """Counters of a recording."""

    path: str
    """The file that is being written, or was written last."""
    recorded: int
    """Datagrams that are in the files, or soon will be."""
    dropped: int
    """Datagrams that were lost because the disk was full or too slow."""
    bytes: int
    """Bytes written to all files."""
    files: int
    """Files begun so far."""
    system_error: int
    """``errno`` of the last failed write; 0 once one succeeds."""


class Gap(NamedTuple):
    """A gap in a recording: services that were silent for several of their periods."""

    utc_s: float
    """When the last status before it was made."""
    seconds: float
    services: tuple[str, ...]


# ---------------------------------------------------------------------- telegrams of tools only


AnswerBody: TypeAlias = (
    tuple[DirectoryEntry, ...]
    | tuple[Subscription, ...]
    | tuple[TelemeterProperties, ...]
    | IoCardProperties
    | BatteryProperties
    | LocalizationProperties
    | DifferentialProperties
    | str
    | bytes
)


class Answer(NamedTuple):
    """The robot's answer to a request (4.2.2, 4.2.3)."""

    id: int
    """The request's identifier; 0 for an error telegram."""
    action: int
    service: int
    error: int
    body: AnswerBody
    """Properties for GET, a text for QUERY, else the remaining bytes."""


class Request(NamedTuple):
    """A client's request; fields that its action does not use are 0."""

    id: int
    action: int
    service: int
    subject: int
    period_cycles: int
    io_type: int
    index: int  # type: ignore[assignment] # instead of the method of tuples
    """Of the directory's entry, or of the IO channel."""
    timestamp: int
    x_m: float
    y_m: float
    theta_rad: float


class IoCardCommand(NamedTuple):
    """A client's command that sets all outputs (4.2.5.2)."""

    analog_outputs: tuple[float, ...]
    digital_outputs: tuple[bool, ...]


class DifferentialCommand(NamedTuple):
    """A client's speed command (4.2.5.6)."""

    linear_m_s: float
    angular_rad_s: float


class UnknownCommand(NamedTuple):
    """A command to a service that the layout does not name."""

    service: int
    payload: bytes


Telegram: TypeAlias = (
    Status | UnknownStatus | Answer | Request | IoCardCommand | DifferentialCommand | UnknownCommand
)
"""Whatever :func:`roburoc4.protocol.decode` can return."""


# --------------------------------------------------------------------------- facts and figures


class Facts(NamedTuple):
    """The current facts."""

    state: State
    armed: bool
    """``drive`` is accepted."""
    driving: bool
    """A drive command is within its lease."""
    lapsed: bool
    """The last lease expired, and none of ``drive``, ``arm``, ``pause`` or ``stop`` was called
    since."""
    stopping: bool
    """Zero commands are being sent, or ``stop`` waits for the robot."""
    stop_outcome: StopOutcome
    """How the last stop sequence ended."""
    overridden: bool | None
    """Somebody holds [A] on the game pad. None, here and below: not known."""
    other_commander: bool
    """Another client commands the robot."""
    inhibited: bool
    """The robot does not follow its commands: too slow (emergency stop, brakes, bumper), too
    fast, or the wrong way."""
    fixed_id: bool
    front_bumper: bool | None
    """Pressed, by the last IO card status."""
    rear_bumper: bool | None
    battery_low: bool | None
    """Below the minimum, or critical."""
    missing: tuple[Service, ...]
    """Services that the robot does not list, or whose subscription it refused, or did not
    acknowledge yet."""
    descriptions_done: bool
    disarm_cause: Result
    """Why it is not armed; ``OK`` while it is."""
    arm_refusal: Result
    """The result that ``arm`` would raise; ``OK`` if it would succeed."""
    relocalize_result: Result
    """Result of the last ``relocalize``; ``NOT_KNOWN`` until it is answered."""
    lease_left_us: int
    sent_linear_m_s: float
    """The last speeds sent; 0 after a stop."""
    sent_angular_rad_s: float


class ServiceLink(NamedTuple):
    """Statistics of one service's statuses."""

    subscribed: bool
    received: int
    lost: int
    late: int
    duplicates: int
    period_us: int
    jitter_us: int
    age_us: int | None
    """Upper bound of the age of the last status; None before the first."""
    loss: float
    """Share of recent statuses that were lost, 0 to 1."""


class Link(NamedTuple):
    """Statistics of the link."""

    round_trip_us: int
    """Round trip of answered requests, smoothed; 0 before the first."""
    round_trip_min_us: int
    silence_us: int
    """Time since the last datagram that was used."""
    received: int
    """Statuses of all services."""
    lost: int
    loss: float
    """Share of recent statuses that were lost, 0 to 1."""


class Pose(NamedTuple):
    """A position and a heading in the plane."""

    x_m: float
    y_m: float
    theta_rad: float


class SimState(NamedTuple):
    """The whole state of a simulated robot; see ``roburoc4_sim.h``."""

    battery_state: BatteryState | int
    now_us: int
    cycles: int
    true_x_m: float
    true_y_m: float
    true_theta_rad: float
    true_linear_m_s: float
    true_angular_rad_s: float
    odometry_x_m: float
    odometry_y_m: float
    odometry_theta_rad: float
    wheel_linear_m_s: float
    wheel_angular_rad_s: float
    target_linear_m_s: float
    target_angular_rad_s: float
    last_linear_m_s: float
    """The last speed command, accepted or not, as it was sent."""
    last_angular_rad_s: float
    last_command_us: int
    distances_m: tuple[float, float]
    battery_percent: float
    battery_v: float
    powered: bool
    motors_enabled: bool
    estop_local: bool
    estop_remote: bool
    brakes_released: bool
    charger: bool
    overridden: bool
    watchdog_tripped: bool
    front_bumper: bool
    rear_bumper: bool
    reboots: int
    requests: int
    errors: int
    speed_commands: int
    nonzero_speed_commands: int
    refused_speed_commands: int
    io_commands: int
    ignored: int
    dropped: int
    peers: int
    subscriptions: int


# -------------------------------------------------------------------------- made by the extension


_MEANINGS: dict[object, dict[int, object]] = {
    bool: {0: False, 1: True},
    BatteryState | int: {int(state): state for state in BatteryState},
    LocalizationFlag | int: {bits: LocalizationFlag(bits) for bits in range(128)},
    int | None: {0xFFFFFFFF: None},
    State: {int(state): state for state in State},
    Result: {int(result): result for result in Result},
    StopOutcome: {int(outcome): outcome for outcome in StopOutcome},
    tuple[Service, ...]: {
        bits: tuple(service for service in Service if bits >> service & 1) for bits in range(128)
    },
}
"""What the numbers of a field are, by its type; others stay numbers."""
_MEANINGS[bool | None] = _MEANINGS[bool]
_KNOWN = {
    "overridden": "override_known",
    "front_bumper": "front_bumper_known",
    "rear_bumper": "rear_bumper_known",
    "battery_low": "battery_known",
}
"""Which field says whether a field that may be None is known."""


def made_of(struct: str, record: Any) -> None:
    """Let the extension make this record of a C struct, or by hand if no struct is named."""
    members = [
        (name, _KNOWN[name] if type_ == bool | None else None, _MEANINGS.get(type_))
        for name, type_ in record.__annotations__.items()
        if struct and name not in ("host_us", "utc_s")
    ]
    _native.register_record(struct, record, members)


# Those of statuses come first, in the order of the services.
for _struct, _record in (
    ("", IoCardStatus),
    ("", TelemeterStatus),
    ("roburoc4_battery_status", BatteryStatus),
    ("roburoc4_localization_status", LocalizationStatus),
    ("roburoc4_differential_status", DifferentialStatus),
    ("roburoc4_directory_entry", DirectoryEntry),
    ("roburoc4_subscription", Subscription),
    ("roburoc4_iocard_properties", IoCardProperties),
    ("roburoc4_telemeter", TelemeterProperties),
    ("roburoc4_battery_properties", BatteryProperties),
    ("roburoc4_localization_properties", LocalizationProperties),
    ("roburoc4_differential_properties", DifferentialProperties),
    ("roburoc4_request", Request),
    ("roburoc4_differential_command", DifferentialCommand),
    ("roburoc4_facts", Facts),
    ("roburoc4_link", Link),
    ("roburoc4_service_link", ServiceLink),
    ("roburoc4_sim_state", SimState),
    ("roburoc4_recorder_state", RecorderState),
):
    made_of(_struct, _record)
