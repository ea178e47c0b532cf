# SPDX-License-Identifier: MIT
"""Commands from ROS 2 to one robot: what they mean, before its gate. It knows no DDS."""

import contextlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from .._gate import Counts, DriveCommand, Gate, Rejection, Verdict
from ..errors import ClosedError
from ..robot import Robot
from ..ros_topics import Diagnosis, yes_or_no
from .remembered import keep

_RECENT_S = 5.0
_FINE, _WARNING = 0, 1
# A publisher may send a stamp again (nav2's velocity smoother does): they are told apart by this.
_NEXT_US = 1


@dataclass(frozen=True)
class DriveConfig:
    """Which commands are obeyed."""

    enabled: bool = False
    stamped: bool = True
    """TwistStamped; else Twist, of which only DDS says when it was sent."""
    lease_ms: int = 250
    max_age_ms: int = 200
    max_linear_m_s: float = 2.6
    """Ceilings beside the robot's own limits."""
    max_angular_rad_s: float = 6.5


class Sender(NamedTuple):
    """A publisher."""

    gid: str
    """In hexadecimal."""
    node: str
    """Empty where it is not known."""

    @property
    def text(self) -> str:
        """For a person, and so without what would command a terminal."""
        name = "".join(letter if letter.isprintable() else "?" for letter in self.node)
        return name or f"a publisher without a known node (gid {self.gid})"


class DriveState(NamedTuple):
    """Who drives, and why not."""

    enabled: bool
    can_drive: bool
    """Whether the next command of whoever may be in control moves the robot."""
    is_waiting: bool
    """Whether commands are held until all publishers have paused for half a second."""
    in_control: str
    stopped_by: str
    """Who sent the last stop, while no command was obeyed after it."""
    rejected: str
    """The last rejection, with its sender and what to do."""
    is_rejecting: bool
    """Whether that was within the last seconds."""
    counts: Counts

    def diagnosis(self, node: str) -> Diagnosis:
        """Return what diagnostics show."""
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
    """Messages of the topics cmd_vel and stop, as they come; used by one thread at a time."""

    def __init__(
        self,
        robot: Robot,
        config: DriveConfig,
        tell: Callable[[str], None],
        utc_us: Callable[[], int] = lambda: time.time_ns() // 1000,
    ) -> None:
        """Begin, on hold; ``tell`` is given sentences for the person at the terminal."""
        self._robot = robot
        self._config = config
        self._tell = tell
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
            self._tell(
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
        """Obey a message of cmd_vel, or tell why not; DDS says that it was sent then.

        Linear x and angular z count, as that is what the robot can do; NaN or infinity in any
        place is refused, as whoever sends that is broken.
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
        """Return a stamp, a little later where it is the sender's last one again.

        DDS delivers nothing twice, so this is no repeated message; the gate judges its age.
        """
        last, used = self._last.get(sender.gid, (0, 0))
        used = used + _NEXT_US if stamp_us == last else stamp_us
        keep(self._last, sender.gid, (stamp_us, used))
        return used

    def unreadable(self, sender: Sender) -> None:
        """Tell about a message of cmd_vel that is none."""
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
            self._tell(f"cmd_vel of {sender.text} rejected: {why}")

    def stop(self, sender: Sender) -> None:
        """Stop, and hold: whatever came on the topic, and from whom."""
        if not self._stopped_by:
            self._tell(f"stopped by {sender.text}: commands are held until all publishers pause")
        self._stopped_by = sender.text
        self._gate.stop(sender.gid)

    def end(self) -> None:
        """Leave the robot standing, if it was driven from here."""
        with contextlib.suppress(ClosedError):
            self._robot.disarm()
