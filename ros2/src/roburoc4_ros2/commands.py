# SPDX-License-Identifier: MIT
"""Interprets commands from ROS 2 to one robot, for its gate. It does not depend on DDS."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from roburoc4.constants import Result, StopOutcome
from roburoc4.errors import RobotError
from roburoc4.gate import Counts, DriveCommand, Gate, Rejection, Verdict
from roburoc4.robot import Robot
from roburoc4_tools.ros.topics import Diagnosis, yes_or_no

from .remembered import keep

_RECENT_S = 5.0
_FINE, _WARNING = 0, 1
_NEVER_ARMED = (Result.DISARMED, Result.STATE, Result.OK)
# The robot may confirm a stop before the next command of another commander undoes it.
_UNDONE_S = 1.0
# Publishers that are slower than this send single commands.
_SLOWEST_S = 2.5
_SLOW_IN_A_ROW = 3
# The first command of several may be this much of the slope.
_FIRST_S = 0.05
# A publisher may send a stamp again (nav2's velocity smoother does): this makes them distinct.
_NEXT_US = 1
# What is beyond is a mistake of units, and rejected.
_UNITS_M_S, _UNITS_RAD_S = 5.0, 10.0


@dataclass(frozen=True)
class DriveConfig:
    """Which commands are obeyed."""

    enabled: bool = False
    stamped: bool = True
    """TwistStamped; else Twist, which has no other stamp than that of DDS."""
    lease_ms: int = 250
    max_age_ms: int = 200
    max_linear_m_s: float = 1.0
    """Ceilings in addition to the robot's own limits."""
    max_angular_rad_s: float = 1.5
    max_linear_m_s2: float = math.inf
    """How fast a commanded speed may grow; slowing down is never limited."""
    max_angular_rad_s2: float = math.inf
    scale_linear: float = 1.0
    """Of the robot file: what is sent is so many times what is asked for."""
    scale_angular: float = 1.0


class Sender(NamedTuple):
    """A publisher."""

    gid: str
    """In hexadecimal."""
    node: str
    """Empty if it is not known."""

    @property
    def text(self) -> str:
        """For a terminal: without characters that would control it."""
        name = "".join(letter if letter.isprintable() else "?" for letter in self.node)
        return name or f"a publisher without a known node (gid {self.gid})"


class DriveState(NamedTuple):
    """Who is in control, and why commands are rejected."""

    enabled: bool
    can_drive: bool
    """Whether the next command would move the robot, if its sender may be in control."""
    is_waiting: bool
    """Whether commands are rejected until all publishers have paused for 500 ms."""
    in_control: str
    stopped_by: str
    """Who sent the last stop, while no command was obeyed after it."""
    rejected: str
    """The last rejection, with its sender and what to do."""
    is_rejecting: bool
    """Whether that was within the last seconds."""
    slow: str
    """Who publishes more slowly than a command holds; empty again some seconds later."""
    counts: Counts

    def diagnosis(self, node: str) -> Diagnosis:
        """Return it as /diagnostics shows it."""
        rejected = sum(self.counts.rejected.values())
        values = {
            "in_control": self.in_control,
            "can_drive": yes_or_no(self.can_drive),
            "waiting_for_a_pause": yes_or_no(self.is_waiting),
            "stopped_by": self.stopped_by,
            "obeyed": str(self.counts.driven),
            "rejected": str(rejected),
            "last_rejection": self.rejected,
            "slow": self.slow,
        }
        level, message = _FINE, "commands drive the robot"
        if not self.enabled:
            message = "cmd_vel is not obeyed: --enable-drive"
        elif self.is_rejecting:
            level, message = _WARNING, f"rejected: {self.rejected}"
        elif self.stopped_by:
            level, message = _WARNING, f"stopped by {self.stopped_by}"
        elif self.slow:
            level, message = _WARNING, self.slow
        elif not self.can_drive:
            level, message = _WARNING, "commands do not drive the robot now"
        return Diagnosis(level, f"{node}: commands", message, values)


class _Pace(NamedTuple):
    """How a publisher's commands come."""

    last_s: float
    was_moving: bool
    slow: int
    """Commands in a row that came after the end of the one before."""


def _grown(from_speed: float, to_speed: float, most: float) -> float:
    if from_speed * to_speed < 0:
        from_speed = 0.0
    if abs(to_speed) <= max(abs(from_speed), 0.0) or math.isinf(most):
        return to_speed
    return math.copysign(min(abs(to_speed), abs(from_speed) + most), to_speed)


class Commands:
    """Handles messages of the topics cmd_vel and stop; used by one thread at a time."""

    def __init__(
        self,
        robot: Robot,
        config: DriveConfig,
        report: Callable[[str], None],
        utc_us: Callable[[], int] = lambda: time.time_ns() // 1000,
    ) -> None:
        """Begin by waiting for a pause; ``report`` is called with messages for the user."""
        self._robot = robot
        self._config = config
        self._report = report
        self._gate = Gate(
            robot,
            enabled=config.enabled,
            lease_s=config.lease_ms / 1000,
            max_age_s=config.max_age_ms / 1000,
            utc_us=utc_us,
        )
        self._last: dict[str, tuple[int, int]] = {}
        self._names: dict[str, str] = {}
        self._stopped_by = ""
        self._rejected = ""
        self._rejected_s = -math.inf
        self._why_disarmed = ""
        self._paces: dict[str, _Pace] = {}
        self._slow = ""
        self._slow_s = -math.inf
        self._obeyed_s = -math.inf
        self._watch_until_s = -math.inf
        self._told_lost_s = -math.inf

    def look(self, waited_s: float = 0.0) -> None:
        """Do what :meth:`Gate.look` does, and watch a stop."""
        if step_s := self._gate.look(waited_s):
            self._report(
                f"this machine's clock was set by {step_s:.3f} s: all publishers must pause for "
                "500 ms"
            )
        self._watch_stop()

    @property
    def state(self) -> DriveState:
        """Who is in control, and why commands are rejected."""
        owner = self._gate.owner
        return DriveState(
            self._config.enabled,
            self._config.enabled and self._gate.can_drive,
            self._gate.is_waiting,
            self._names.get(owner, owner),
            self._stopped_by,
            self._rejected,
            self._robot.now_s - self._rejected_s < _RECENT_S,
            self._slow if self._robot.now_s - self._slow_s < _RECENT_S else "",
            self._gate.counts,
        )

    def drive(self, sender: Sender, message: Any, sent_us: int) -> None:
        """Obey a message of cmd_vel, or report why not; ``sent_us`` is the stamp of DDS.

        Only linear x and angular z count, as the robot cannot move otherwise. NaN or infinity in
        any field rejects the message, because its sender is faulty.
        """
        twist, stamp_us = message, sent_us
        if self._config.stamped:
            twist = message.twist
            stamp = message.header.stamp
            stamp_us = self._distinct(sender, stamp.sec * 1_000_000 + stamp.nanosec // 1000)
        axes = [getattr(part, axis) for part in (twist.linear, twist.angular) for axis in "xyz"]
        keep(self._names, sender.gid, sender.text)
        is_finite = all(map(math.isfinite, axes))
        linear_m_s, angular_rad_s = self._sloped(axes[0], axes[5]) if is_finite else (0.0, 0.0)
        rejection = self._gate.drive(
            DriveCommand(sender.gid, stamp_us, linear_m_s, angular_rad_s, is_finite)
        )
        if rejection is not None:
            self._note(sender, rejection)
            return
        self._obeyed_s = self._robot.now_s
        is_moving = bool(axes[0] or axes[5])
        if is_moving:
            self._stopped_by = ""
        self._look_at_pace(sender, is_moving)

    def _sloped(self, linear_m_s: float, angular_rad_s: float) -> tuple[float, float]:
        """Return speeds that grow no faster than is allowed; mistakes of units stay as they are."""
        facts, config = self._robot.facts, self._config
        passed_s = self._robot.now_s - self._obeyed_s
        if passed_s > config.lease_ms / 1000:
            passed_s = _FIRST_S
        if abs(linear_m_s) <= _UNITS_M_S and abs(angular_rad_s) <= _UNITS_RAD_S:
            linear_m_s = max(-config.max_linear_m_s, min(config.max_linear_m_s, linear_m_s))
            most = config.max_angular_rad_s
            angular_rad_s = max(-most, min(most, angular_rad_s))
        last_m_s = facts.sent_linear_m_s / config.scale_linear
        last_rad_s = facts.sent_angular_rad_s / config.scale_angular
        return (
            _grown(last_m_s, linear_m_s, config.max_linear_m_s2 * passed_s),
            _grown(last_rad_s, angular_rad_s, config.max_angular_rad_s2 * passed_s),
        )

    def _look_at_pace(self, sender: Sender, is_moving: bool) -> None:
        """Report a publisher whose commands end before the next one comes."""
        now_s = self._robot.now_s
        pace = self._paces.get(sender.gid, _Pace(-math.inf, False, 0))
        gap_s, lease_s = now_s - pace.last_s, self._config.lease_ms / 1000
        is_slow = pace.was_moving and is_moving and lease_s < gap_s < _SLOWEST_S
        slow = pace.slow + 1 if is_slow else 0
        keep(self._paces, sender.gid, _Pace(now_s, is_moving, slow))
        if slow < _SLOW_IN_A_ROW:
            return
        text = (
            f"cmd_vel of {sender.text} comes every {gap_s * 1000:.0f} ms, but holds for "
            f"{self._config.lease_ms} ms: the robot stops in between; publish faster, or give "
            "--lease-ms, up to 1000"
        )
        if slow == _SLOW_IN_A_ROW:
            self._report(text)
        self._slow, self._slow_s = text, now_s

    def _distinct(self, sender: Sender, stamp_us: int) -> int:
        """Return a stamp, a little later if it is the sender's last one again.

        DDS delivers nothing twice, so this is no repeated message; the gate judges its age.
        """
        last, used = self._last.get(sender.gid, (0, 0))
        used = used + _NEXT_US if stamp_us == last else stamp_us
        keep(self._last, sender.gid, (stamp_us, used))
        return used

    def unreadable(self, sender: Sender) -> None:
        """Reject a message of cmd_vel that cannot be decoded."""
        rejection = self._gate.reject(Verdict.MALFORMED, sender.gid)
        if rejection is not None:
            self._note(sender, rejection)

    def _note(self, sender: Sender, rejection: Rejection) -> None:
        why = self._why(rejection)
        self._rejected = f"{sender.text}: {why}"
        self._rejected_s = self._robot.now_s
        has_changed = rejection.verdict is Verdict.DISARMED and why != self._why_disarmed
        if rejection.is_incident or has_changed:
            self._report(f"cmd_vel of {sender.text} rejected: {why}")
        if rejection.verdict is Verdict.DISARMED:
            self._why_disarmed = why

    def _why(self, rejection: Rejection) -> str:
        """Return the cause of a rejection as exactly as it is known."""
        if rejection.verdict is Verdict.CONTROL:
            owner = self._gate.owner
            return f"{rejection.why}; in control: {self._names.get(owner, owner)}"
        if rejection.verdict is not Verdict.DISARMED:
            return rejection.why
        facts = self._robot.facts
        if facts.arm_refusal:
            return f"the robot cannot be armed: {facts.arm_refusal.text}"
        cause = facts.disarm_cause.text if facts.disarm_cause else ""
        if self._stopped_by:
            cause = f"stopped by {self._stopped_by}"
        elif facts.disarm_cause in _NEVER_ARMED:
            cause = "this node has just started"
        pressed = [
            side
            for side, fact in (("front", facts.front_bumper), ("rear", facts.rear_bumper))
            if fact
        ]
        if pressed:
            cause += f" (pressed: {' and '.join(pressed)} bumper)"
        return f"{cause}; all publishers must pause (or send zero) for 500 ms"

    def _watch_stop(self) -> None:
        """Report a stop that another commander, or the game pad, undoes."""
        now_s = self._robot.now_s
        if now_s > self._watch_until_s:
            return
        facts = self._robot.facts
        if facts.stopping:
            return
        if math.isinf(self._watch_until_s):  # it has just ended
            self._watch_until_s = now_s + _UNDONE_S
        if facts.other_commander:
            self._watch_until_s = -math.inf
            if now_s - self._told_lost_s > _RECENT_S:
                self._report(
                    f"stopped by {self._stopped_by}, but another commander, which is not this "
                    "node, still drives the robot: end that program, or press an emergency stop"
                )
            self._told_lost_s = now_s
        elif facts.stop_outcome in {StopOutcome.TIMED_OUT, StopOutcome.OVERRIDDEN}:
            self._watch_until_s = -math.inf
            self._report(
                f"stopped by {self._stopped_by}, but the robot did not confirm it "
                f"({facts.stop_outcome.name.lower().replace('_', ' ')}): watch it"
            )

    def stop(self, sender: Sender) -> None:
        """Stop, whatever the message contains and whoever sent it; then wait for a pause."""
        if not self._stopped_by:
            self._report(
                f"stopped by {sender.text}: commands are rejected until all publishers have paused "
                "for 500 ms"
            )
        self._stopped_by = sender.text
        self._gate.stop(sender.gid)
        self._watch_until_s = math.inf

    def arm(self) -> tuple[bool, str]:
        """Arm, by the rules under which the next command would; and say why not."""
        if not self._config.enabled:
            return False, "cmd_vel is not obeyed: start the node with --enable-drive"
        if self._gate.is_waiting:
            return False, "all publishers must pause (or send zero) for 500 ms first"
        try:
            self._robot.arm()
        except RobotError as error:
            return False, str(error)
        return True, "armed: the next cmd_vel drives the robot"

    @property
    def config(self) -> DriveConfig:
        """Which commands are obeyed."""
        return self._config

    def limit(self, **limits: Any) -> None:
        """Change ceilings and slopes; a ceiling cannot exceed the one that it was started with."""
        self._config = replace(self._config, **limits)

    def end(self) -> None:
        """Stop the robot, if it was driven from here."""
        if self._robot.facts.armed:
            self._robot.stop()
