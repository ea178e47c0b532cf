# SPDX-License-Identifier: MIT
"""Which drive commands of a network may reach a robot: the rules of gate/gate.h, for bridges."""

import contextlib
import math
import time
from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

from . import _native
from .errors import ClosedError
from .robot_base import RobotBase

__all__ = ["Counts", "DriveCommand", "Gate", "Rejection", "Verdict"]

_FAR = 1e6  # beyond any limit; the client clamps to the robot's own


class Verdict(IntEnum):
    """What becomes of a command."""

    TAKEN = _native.GATE_TAKEN
    """Obeyed."""
    MALFORMED = _native.GATE_MALFORMED
    """Not a command that can be read."""
    DISABLED = _native.GATE_DISABLED
    """Commands are not enabled."""
    SENDER = _native.GATE_SENDER
    """This sender is not allowed."""
    NO_STAMP = _native.GATE_NO_UTIME
    """It does not say when it was sent."""
    NOT_FINITE = _native.GATE_NOT_FINITE
    """A number is NaN or infinite."""
    STARTING = _native.GATE_STARTING
    """It was sent before the gate began."""
    TOO_OLD = _native.GATE_TOO_OLD
    """Sent longer ago than allowed."""
    IN_FUTURE = _native.GATE_IN_FUTURE
    """Sent in the future: the clocks differ."""
    REPEATED = _native.GATE_REPEATED
    """No newer than the last one of its sender."""
    CONTROL = _native.GATE_CONTROL
    """Another sender is in control."""
    NOT_READY = _native.GATE_NOT_READY
    """The robot is not ready."""
    DISARMED = _native.GATE_DISARMED
    """Driving ended; all senders must pause."""
    UNITS = _native.GATE_UNITS
    """Faster than any such robot."""


class DriveCommand(NamedTuple):
    """A drive command from the network."""

    sender: str
    stamp_us: int
    """When it was sent, in microseconds since 1970."""
    linear_m_s: float
    angular_rad_s: float
    finite: bool = True
    """False if another number of its message is NaN or infinite."""


class Rejection(NamedTuple):
    """Why a command was rejected."""

    verdict: Verdict
    sender: str
    why: str
    """The cause, and what to do."""
    is_incident: bool
    """Whether to report it to the user; others repeat one that was reported."""


class Counts(NamedTuple):
    """What became of all commands so far."""

    driven: int
    stopped: int
    rejected: dict[Verdict, int]


def _utc_us() -> int:
    return time.time_ns() // 1000


class Gate:
    """The gate in front of one robot; used by one thread at a time.

    A command is a lease from its arrival. The gate first waits for a pause: 500 ms without a
    command that has a speed. The next speed arms the robot. After a stop, a disarm, or anything
    else that ends driving, commands are rejected until the next pause. One sender is in control
    until its lease ends.
    """

    def __init__(
        self,
        robot: RobotBase,
        *,
        enabled: bool,
        lease_s: float = 0.25,
        max_age_s: float = 0.2,
        utc_us: Callable[[], int] = _utc_us,
    ) -> None:
        """Begin by waiting for a pause. With ``max_age_s`` 0, stamps of any age are accepted."""
        self._robot = robot
        self._client = robot._connection.handle
        self._events = robot._connection.reader()
        self._utc_us = utc_us
        self._rules = _native.new_gate_rules()
        _native.gate_rules_enabled_set(self._rules, _native.GATE_DRIVE, enabled)
        _native.gate_rules_lease_us_set(self._rules, round(lease_s * 1e6))
        _native.gate_rules_max_age_us_set(self._rules, round(max_age_s * 1e6))
        self._gate = _native.new_gate()
        self._stall = _native.new_stall()
        _native.gate_init(self._gate, self._rules, self._now())

    def _now(self) -> tuple[int, int]:
        return _native.connection_now_us(self._client), self._utc_us()

    def look(self, waited_s: float = 0.0) -> float:
        """Notice that driving ended, that this program hung, or that the clock was set.

        Call it after each wait, with the time that the caller meant to wait. If the wait took
        some milliseconds longer, commands that arrive now count as old. Returns by how many
        seconds the clock was set, usually 0.
        """
        self._heed_events()
        now = self._now()
        stalled, since_us = _native.gate_look_for_stall(self._stall, round(waited_s * 1e6), now)
        if stalled:
            _native.gate_was_stalled(self._gate, since_us, now[0])
        return _native.gate_look_at_clock(self._gate, now) / 1e6

    def _heed_events(self) -> None:
        """Wait for a pause if driving ended."""
        with contextlib.suppress(ClosedError):
            _native.gate_heed_events(self._gate, self._client, self._events.take_events())

    def drive(self, command: DriveCommand) -> Rejection | None:
        """Obey a command that has just arrived, or return why it is rejected."""
        robot = _native.gate_robot_of(self._client)
        self._heed_events()
        now = self._now()
        speeds = command.linear_m_s, command.angular_rad_s
        finite = command.finite and all(map(math.isfinite, speeds))
        arrived_us = _native.gate_arrival(self._stall, now[1])
        verdict, lease_us = _native.gate_judge(
            self._gate,
            (command.sender, command.stamp_us, arrived_us, finite, not any(speeds)),
            robot,
            now,
        )
        if verdict == Verdict.TAKEN:
            linear_m_s, angular_rad_s = (max(-_FAR, min(_FAR, speed)) for speed in speeds)
            verdict = _native.gate_drive(
                self._gate, self._client, linear_m_s, angular_rad_s, lease_us
            )
            # The robot's thread may have ended driving since it was checked: no arming then.
            self._heed_events()
            if self.is_waiting and any(speeds):
                self._robot.stop()
                verdict = Verdict.DISARMED
        return self._rejection(verdict, command.sender, command.stamp_us)

    def reject(self, verdict: Verdict, sender: str) -> Rejection | None:
        """Count a command that could not be read."""
        _native.gate_reject(self._gate, verdict)
        return self._rejection(verdict, sender, 0)

    def _rejection(self, verdict: int, sender: str, stamp_us: int) -> Rejection | None:
        if verdict == Verdict.TAKEN:
            return None
        now = self._now()
        why = _native.gate_reason((verdict, stamp_us), self._rules, now)
        is_incident = _native.gate_is_incident(self._gate, verdict, sender, now[0])
        return Rejection(Verdict(verdict), sender, why, is_incident)

    def stop(self, sender: str) -> None:
        """Stop the robot, and reject drive commands until all senders have paused."""
        _native.gate_stop_client(self._gate, self._client, sender)

    @property
    def owner(self) -> str:
        """The sender in control; empty if there is none."""
        return _native.gate_control_owner(self._gate, self._now()[0])

    @property
    def is_waiting(self) -> bool:
        """Whether commands are rejected until all senders have paused."""
        return _native.gate_is_waiting(self._gate, self._now()[0])

    @property
    def can_drive(self) -> bool:
        """Whether the next command would move the robot, if its sender may be in control."""
        robot = _native.gate_robot_of(self._client)
        return _native.gate_can_drive(self._gate, robot, self._now()[0])

    @property
    def counts(self) -> Counts:
        """What became of all commands so far."""
        taken = _native.gate_taken_get(self._gate)
        rejected = _native.gate_rejected_get(self._gate)
        return Counts(
            taken[_native.GATE_DRIVE],
            taken[_native.GATE_STOP],
            {verdict: rejected[verdict] for verdict in Verdict},
        )
