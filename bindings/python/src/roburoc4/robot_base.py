# SPDX-License-Identifier: MIT
"""What the blocking and the asyncio robot have in common: everything that does not wait."""

from collections.abc import Callable
from contextvars import ContextVar
from typing import TYPE_CHECKING, ParamSpec, TypeVar, cast

from . import _native
from .connection import Connection
from .constants import Count, Event, Fault, Result, Role, Service, State
from .errors import (
    ArgumentError,
    ClosedError,
    NotArmedError,
    NotKnownError,
    RefusedError,
    RobotError,
    RobotTimeoutError,
    check_speeds,
    duration_s,
    error_of,
    is_within,
    unusable,
)
from .iocard import AnalogOutputs, DigitalOutputs, Inputs, decode_text
from .records import (
    BatteryStatus,
    ChannelNames,
    DifferentialStatus,
    Facts,
    IoCardStatus,
    Link,
    LocalizationStatus,
    Properties,
    RecorderState,
    ServiceEntry,
    ServiceLink,
    Status,
    TelemeterStatus,
)
from .settings import STATUS_SERVICES, Settings, service_of

_P = ParamSpec("_P")
_R = TypeVar("_R")

_RENEWALS_PER_LEASE = 4
_STATUS_MARGIN_S = 0.5


class RobotBase:
    """A robot; see :func:`roburoc4.connect` and :mod:`roburoc4.aio`."""

    def __init__(self, connection: Connection, settings: Settings) -> None:
        self._connection = connection
        self._lease_s = settings.get("lease_ms", 250) / 1000
        self._ready_s = connection.now_s()
        self._stops = 0
        self._inputs = Inputs(connection)
        self._digital_outputs = DigitalOutputs(connection)
        self._analog_outputs = AnalogOutputs(connection)

    if not TYPE_CHECKING:  # type checkers would accept any attribute

        def __setattr__(self, name, value):
            if name in Settings.__annotations__:
                raise AttributeError(f"{name} is a setting: give it to connect({name}={value!r})")
            super().__setattr__(name, value)

    def __repr__(self) -> str:
        state = "closed" if self.closed else self.state.name.lower()
        return f"<{type(self).__module__}.{type(self).__name__} {self.address}, {state}>"

    # ---- the link ----

    @property
    def address(self) -> str:
        """The robot's address and port in numbers."""
        return self._connection.address

    @property
    def closed(self) -> bool:
        """Whether ``close`` was called."""
        return self._connection.closed

    @property
    def state(self) -> State:
        """State of the client."""
        return State(_native.roburoc4_client_state(self._connection.handle))

    @property
    def facts(self) -> Facts:
        """The current facts: armed, overridden, bumpers, speeds sent ..."""
        return _native.roburoc4_client_facts(self._connection.handle)

    @property
    def link(self) -> Link:
        """Statistics of the link: round trip, silence, loss."""
        return _native.roburoc4_client_link(self._connection.handle)

    def service_link(self, service: str | Service) -> ServiceLink:
        """Return the statistics of one service's statuses: period, jitter, age, loss."""
        return _native.roburoc4_client_service_link(self._connection.handle, service_of(service))

    def period_s(self, service: str | Service) -> float:
        """Return the observed seconds between two statuses of a service."""
        return self.service_link(service).period_us / 1e6

    def age_s(self, service: str | Service) -> float | None:
        """Return how old the latest status of a service can be at most; None before the first.

        On a good link that is about 0.05 s more than it is.
        """
        age_us = self.service_link(service).age_us
        return None if age_us is None else age_us / 1e6

    @property
    def counts(self) -> dict[Count, int]:
        """Counters of datagrams by what became of them."""
        return {
            counter: _native.roburoc4_client_count(self._connection.handle, counter)
            for counter in Count
        }

    @property
    def fault(self) -> Fault:
        """Why the network does not accept or deliver datagrams; NONE once one arrives."""
        return Fault(_native.connection_fault(self._connection.handle))

    @property
    def recorder(self) -> RecorderState | None:
        """What ``connect(record=...)`` has recorded so far; None if nothing is recorded."""
        return self._connection.recorder

    @property
    def now_s(self) -> float:
        """The clock of ``host_us``, leases and timeouts, in seconds; its zero is arbitrary."""
        return self._connection.now_s()

    def host_time_s(self, robot_cycles: int) -> float:
        """Estimate when, on ``now_s``, the robot's clock showed ``robot_cycles``."""
        handle = self._connection.handle
        try:
            return _native.roburoc4_client_host_time(handle, robot_cycles) / 1e6
        except (OverflowError, TypeError, ValueError):
            raise unusable("robot_cycles", robot_cycles, f"0 to {(1 << 64) - 1}") from None

    # ---- what the robot is ----

    def _service_entry(self, index: int, kinds: dict[int, Service]) -> ServiceEntry:
        entry = _native.roburoc4_client_service_at(self._connection.handle, index)
        service = kinds.get(entry.id)
        text = self._connection.description(-1, index)
        name = decode_text(text) if text is not None else ""
        if text is None and service is not None:
            name = _native.roburoc4_name(_native.ROBUROC4_NAME_SERVICE, service)
        return ServiceEntry(
            entry.id, entry.type, None if service is None else service.name.lower(), name
        )

    @property
    def properties(self) -> Properties:
        """What the robot reported about itself; texts may arrive after it is ready."""
        handle = self._connection.handle
        ids = {_known(_native.roburoc4_client_service_id, handle, s): s for s in Service}
        kinds = {wire_id: service for wire_id, service in ids.items() if wire_id is not None}
        return Properties(
            _listed(lambda index: self._service_entry(index, kinds)),
            _known(_native.roburoc4_client_iocard_properties, handle),
            _listed(lambda index: _native.roburoc4_client_telemeter(handle, index)),
            _known(_native.roburoc4_client_battery_properties, handle),
            _known(_native.roburoc4_client_localization_properties, handle),
            _known(_native.roburoc4_client_differential_properties, handle),
        )

    def role_index(self, role: Role) -> int | None:
        """Return the index on the wire of the input with this role; None if it is unknown."""
        if not isinstance(role, int) or role not in list(Role):
            raise unusable("role", role, "a member of Role, such as Role.FRONT_BUMPER")
        return _known(_native.roburoc4_client_role_index, self._connection.handle, role)

    # ---- statuses ----

    def _first(self, service: Service) -> Status:
        """Read the latest status; before the first, raise an error that names the remedy."""
        try:
            return _native.latest_status(self._connection.handle, service)
        except NotKnownError as error:
            name = service.name.lower()
            raise NotKnownError(
                f"the robot has sent no {name} status yet: wait_for({name!r})", error.code
            ) from None

    @property
    def battery(self) -> BatteryStatus:
        """The latest battery status."""
        return cast(BatteryStatus, self._first(Service.BATTERY))

    @property
    def localization(self) -> LocalizationStatus:
        """The latest localization status: odometry, inaccurate after turns."""
        return cast(LocalizationStatus, self._first(Service.LOCALIZATION))

    @property
    def differential(self) -> DifferentialStatus:
        """The latest speeds, commanded and measured."""
        return cast(DifferentialStatus, self._first(Service.DIFFERENTIAL))

    @property
    def telemeter(self) -> TelemeterStatus:
        """The latest ultrasonic distances."""
        return cast(TelemeterStatus, self._first(Service.TELEMETER))

    @property
    def iocard(self) -> IoCardStatus:
        """The latest inputs of the IO card."""
        return cast(IoCardStatus, self._first(Service.IOCARD))

    @property
    def inputs(self) -> Inputs:
        """Inputs of the IO card by name or index."""
        return self._inputs

    @property
    def channels(self) -> ChannelNames:
        """Names of all channels of the IO card."""
        return self._inputs.channels

    # ---- commands ----

    @property
    def digital_outputs(self) -> DigitalOutputs:
        """Digital outputs: ``robot.digital_outputs[3] = True``."""
        return self._digital_outputs

    @property
    def analog_outputs(self) -> AnalogOutputs:
        """Analog outputs."""
        return self._analog_outputs

    def drive(
        self, linear_m_s: float, angular_rad_s: float, *, lease_s: float | None = None
    ) -> None:
        """Drive at these speeds for one lease; call it repeatedly to keep driving.

        Never waits. The lease is ``lease_s``, 0.02 to 1 s (default: the setting ``lease_ms``); then
        the robot is stopped, and after ``lapse_disarm_ms`` disarmed. Speeds are scaled and limited
        to the robot's limits and the settings' ceilings; more than 5 m/s or 10 rad/s are refused.
        Raises NotArmedError while disarmed, with cause and remedy.
        """
        if lease_s is not None and not is_within(0.02, lease_s, 1.0):
            raise unusable("lease_s", lease_s, "0.02 to 1 s")
        try:
            _native.roburoc4_client_drive(
                self._connection.handle, linear_m_s, angular_rad_s, round((lease_s or 0.0) * 1e6)
            )
        except (ArgumentError, OverflowError, TypeError, ValueError):
            check_speeds(linear_m_s, angular_rad_s)
            raise

    def stop(self) -> None:
        """Stop the robot and disarm: end the drive command and send zeros, armed or not.

        Driving needs ``arm`` again. Never waits. After ``close`` it does nothing.
        """
        self._stops += 1
        self._end_lease(_native.roburoc4_client_stop)

    def pause(self) -> None:
        """Stop the robot as ``stop`` does, but stay armed: for a program that drives on later."""
        self._end_lease(_native.roburoc4_client_pause)

    def _end_lease(self, end: "Callable[[_native.Connection], int]") -> None:
        try:
            end(self._connection.handle)
        except ClosedError:
            _native.roburoc4_client_state(self._connection.handle)  # raises in a forked child

    def subscribe(self, service: str | Service, period_ms: int) -> None:
        """Subscribe to a service, or change its period: a multiple of 10, 10 to 2550."""
        kind = service_of(service)
        if not (is_within(10, period_ms, 2550) and period_ms % 10 == 0):
            raise unusable("period_ms", period_ms, "a multiple of 10, 10 to 2550")
        _native.roburoc4_client_subscribe(self._connection.handle, kind, int(period_ms))

    def unsubscribe(self, service: str | Service) -> None:
        """End a subscription."""
        _native.roburoc4_client_subscribe(self._connection.handle, service_of(service), 0)

    # ---- for subclasses, which wait ----

    def _readiness(self, timeout_s: float) -> Callable[[], bool]:
        """Return a check whether it is ready, which raises after too long a silence."""
        heard_s = self._connection.now_s()

        def look() -> bool:
            nonlocal heard_s
            now_s = self._connection.now_s()
            if self.state is State.READY:
                self._ready_s = now_s
                return True
            heard_s = max(heard_s, now_s - self.link.silence_us / 1e6)
            if now_s - heard_s >= timeout_s:
                raise RobotTimeoutError(self._silence_text(timeout_s), Result.TIMEOUT)
            return False

        return look

    def _silence_text(self, timeout_s: float) -> str:
        counts = self.counts
        sent, heard = counts[Count.SENT], counts[Count.RECEIVED]
        if self.fault is not Fault.NONE:
            check = self.fault.text
        elif heard == 0:
            check = (
                "check that the robot is on, its cable is plugged in, this machine is in "
                "the robot's network, and no firewall drops UDP"
            )
        else:
            check = "something answers there; check that it is a RobuROC4, and the loss of the link"
        return (
            f"no answer from {self.address} for {timeout_s:g} s (state {self.state.name.lower()}, "
            f"{sent} datagrams sent, {heard} received): {check}"
        )

    def _first_status_until_s(self, service: Service) -> float:
        """Until when the first status of a service can be expected."""
        return self._ready_s + 2 * self.service_link(service).period_us / 1e6 + _STATUS_MARGIN_S

    def _has_first_statuses(self) -> bool:
        """Whether each subscribed service has sent a status, or its time is over."""
        now_s = self._connection.now_s()
        return all(
            self.age_s(service) is not None
            or not self.service_link(service).subscribed
            or now_s >= self._first_status_until_s(service)
            for service in STATUS_SERVICES.values()
        )

    def _try_to_arm(self, end_s: float, stops: int) -> float:
        """Arm and return 0; or return the seconds during which retrying makes sense.

        Raises if ``stop`` was called since ``stops``: it also ends a wait for arming.
        """
        left_s = 0.0
        try:
            _native.roburoc4_client_arm(self._connection.handle)
        except NotArmedError as error:
            left_s = end_s - self._connection.now_s()
            if not _native.roburoc4_refusal_may_pass(error.code) or left_s <= 0:
                raise
        if self._stops != stops:
            self.stop()
            raise error_of(Result.STOP_CALLED)
        return left_s

    def _end_of_drive_s(self, seconds: float) -> float:
        return self._connection.now_s() + duration_s("seconds", seconds)

    def _renew(self, linear_m_s: float, angular_rad_s: float) -> None:
        """Renew the command of drive_for, unless its lease has ended."""
        if _native.renew_drive(self._connection.handle, linear_m_s, angular_rad_s):
            return
        if self.facts.lapsed:
            raise RobotError(
                "drive_for ended: the program did not renew its command in time, so the robot was "
                "stopped; find what blocked it",
                Result.LAPSED,
            )
        raise RobotError("drive_for ended: the robot was paused meanwhile", Result.STATE)

    @property
    def _renewal_s(self) -> float:
        """How often drive_for renews its command."""
        return self._lease_s / _RENEWALS_PER_LEASE

    def _is_relocalized(self) -> bool:
        """Whether relocalize was answered; raises if it was refused."""
        code = self.facts.relocalize_result
        if code == Result.NOT_KNOWN:
            return False
        if code == Result.TIMEOUT:
            raise RobotTimeoutError("relocalize was not answered", code)
        if code != Result.OK:
            raise RefusedError(f"relocalize: {error_of(code)}", code)
        return True


def _known(function: Callable[_P, _R], *arguments: _P.args, **names: _P.kwargs) -> _R | None:
    """Call a function of the client; None for what the robot has not reported yet."""
    try:
        return function(*arguments, **names)
    except NotKnownError:
        return None


def _listed(read: Callable[[int], _R]) -> tuple[_R, ...]:
    """Read a list of the client by index, to its end."""
    entries: list[_R] = []
    try:
        while True:
            entries.append(read(len(entries)))
    except ArgumentError:
        return tuple(entries)


RELOCALIZE_S = 3.0
"""Longer than the client's own timeout (2 s)."""
in_condition = ContextVar("in_condition", default=False)
"""Whether a condition of wait_for is being evaluated: then properties do not wait."""


def true_or_unknown(condition: Callable[[_R], object], robot: _R) -> Callable[[], object]:
    """Return a check of the condition; it is false while it needs something unknown."""

    def look() -> object:
        token = in_condition.set(True)
        try:
            return condition(robot)
        except NotKnownError:
            return None
        finally:
            in_condition.reset(token)

    return look


def name_of(condition: object) -> str:
    """Describe what did not happen."""
    if isinstance(condition, Event):
        return f"no {condition.name or repr(condition)} event"
    if isinstance(condition, Service):
        return f"no {condition.name.lower()} status arrived"
    return f"{getattr(condition, '__name__', 'the condition')} was not true"
