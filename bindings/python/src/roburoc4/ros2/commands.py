# SPDX-License-Identifier: MIT
"""Interprets commands from ROS 2 to one robot, for its gate. It does not depend on DDS."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from .._gate import Counts, DriveCommand, Gate, Rejection, Verdict
from ..robot import Robot
from ..ros_topics import Diagnosis, yes_or_no
from .remembered import keep

_RECENT_S = 5.0
_FINE, _WARNING = 0, 1
# A publisher may send a stamp again (nav2's velocity smoother does): this makes them distinct.
_NEXT_US = 1


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
        }
        level, message = _FINE, "commands drive the robot"
        if not self.enabled:
            message = "cmd_vel is not obeyed: --enable-drive"
        elif self.is_rejecting:
            level, message = _WARNING, f"rejected: {self.rejected}"
        elif self.stopped_by:
            level, message = _WARNING, f"stopped by {self.stopped_by}"
        elif not self.can_drive:
            level, message = _WARNING, "commands do not drive the robot now"
        return Diagnosis(level, f"{node}: commands", message, values)


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
        self.state = self._look()
        """For other threads, as of the last :meth:`look`."""

    def look(self, waited_s: float = 0.0) -> None:
        """Do what :meth:`Gate.look` does, and renew the state."""
        if step_s := self._gate.look(waited_s):
            self._report(
                f"this machine's clock was set by {step_s:.3f} s: all publishers must pause for "
                "500 ms"
            )
        self.state = self._look()

    def _look(self) -> DriveState:
        owner = self._gate.owner
        return DriveState(
            self._config.enabled,
            self._config.enabled and self._gate.can_drive,
            self._gate.is_waiting,
            self._names.get(owner, owner),
            self._stopped_by,
            self._rejected,
            self._robot.now_s - self._rejected_s < _RECENT_S,
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
        rejection = self._gate.drive(
            DriveCommand(sender.gid, stamp_us, axes[0], axes[5], all(map(math.isfinite, axes)))
        )
        if rejection is not None:
            self._note(sender, rejection)
        elif axes[0] or axes[5]:
            self._stopped_by = ""

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
        why = rejection.why
        if rejection.verdict is Verdict.CONTROL:
            owner = self._gate.owner
            why += f"; in control: {self._names.get(owner, owner)}"
        self._rejected = f"{sender.text}: {why}"
        self._rejected_s = self._robot.now_s
        if rejection.is_incident:
            self._report(f"cmd_vel of {sender.text} rejected: {why}")

    def stop(self, sender: Sender) -> None:
        """Stop, whatever the message contains and whoever sent it; then wait for a pause."""
        if not self._stopped_by:
            self._report(
                f"stopped by {sender.text}: commands are rejected until all publishers have paused "
                "for 500 ms"
            )
        self._stopped_by = sender.text
        self._gate.stop(sender.gid)

    def end(self) -> None:
        """Stop the robot, if it was driven from here."""
        if self._robot.facts.armed:
            self._robot.stop()
