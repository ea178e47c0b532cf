# SPDX-License-Identifier: MIT
"""Who drives, and which inputs count. Nothing else in the dashboard moves the robot.

One page at a time has control. Its inputs answer to a tick: the number of the frame that its
driver saw. An input that answers a tick of age `a` gets a lease of `lease - a`, so that the robot
stops one lease after the driver last saw it, however late or often inputs arrive. No timer renews:
only a valid input does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from roburoc4.constants import State
from roburoc4.errors import NotArmedError
from roburoc4.robot import Robot

from .advice import why_disarmed, why_refused
from .going import Goal, Going
from .ticks import Ticks

SHORTEST_LEASE_S = 0.02
"""The client accepts no shorter one."""
HELD_UP_S = 0.02
"""A delay before the command lengthens its lease; after a longer delay it is sent again."""
_ATTEMPTS = 3
IDLE_S = 5.0
"""Whose page drives nothing for this long can be relieved while the robot stands."""
FORGOTTEN_S = 30.0
"""A driver's page that shows nothing for this long loses control."""


class ControlError(Exception):
    """Why a page may not do something, to be shown on it."""


Sides = tuple[float, float]
"""Speeds at full deflection backward or right, and forward or left; both 0 or more."""


class Limits(NamedTuple):
    """The meaning of full deflection: the lower of the robot's limit and the ceiling."""

    linear_m_s: Sides
    angular_rad_s: Sides


NO_LIMITS = Limits((0.0, 0.0), (0.0, 0.0))


@dataclass(frozen=True)
class Input:
    """The driver's inputs: shares of -1 to 1 of the limits, X forward and counter-clockwise."""

    tick: int
    forward: float
    left: float
    scale: float
    going: bool = False
    """The page shows where the robot goes by itself, and its driver allows it."""

    def __post_init__(self) -> None:
        shares = (self.forward, self.left, self.scale)
        if not all(math.isfinite(share) and -1.0 <= share <= 1.0 for share in shares):
            raise ValueError(f"inputs are -1 to 1, not {shares}")
        if not self.scale > 0.0:
            raise ValueError(f"scale is above 0 and up to 1, not {self.scale}")

    @property
    def neutral(self) -> bool:
        """Whether nothing is deflected."""
        return self.forward == 0.0 and self.left == 0.0


@dataclass(eq=False)
class Viewer:
    """What control needs to know about a page."""

    number: int
    name: str = ""
    """As its user calls it."""
    sent_tick: int = 0
    """The newest tick that was sent to it."""
    heard_s: float = field(default=-math.inf)
    """When it last showed a frame."""

    def __post_init__(self) -> None:
        self.name = self.name or f"page {self.number}"


class Control:
    """Control of a robot."""

    def __init__(self, robot: Robot, ticks: Ticks, lease_s: float, *, offered: bool) -> None:
        self._robot = robot
        self._ticks = ticks
        self._lease_s = lease_s
        self.offered = offered
        self.limits = NO_LIMITS
        self.driver: Viewer | None = None
        self.asker: Viewer | None = None
        """The page that asks the driver for control."""
        self.why = ""
        """Why the robot was stopped, or does not move; shown to the driver."""
        self.dropped = 0
        """Inputs that were too old, or answered no tick of this page."""
        self.going: Going | None = None
        self.begun: list[Going] = []
        """Moves that nobody has noted yet."""
        self.idle_s = IDLE_S
        self._active_s = -math.inf
        self._gone: Going | None = None
        self._armed = False
        self._floor = 0
        self.must_let_go = True
        """All inputs must be released once before anything moves."""
        self._lease_end_s: float | None = None

    # ---- taking and giving up ----

    def take(self, page: Viewer) -> None:
        """Take control, which no other page has."""
        if not self.offered:
            raise ControlError("this dashboard only watches: start it with --enable-drive to drive")
        if self.driver is None:
            self.driver = page
            self._active_s = self._robot.now_s
            self._begin_anew("")

    def ask(self, page: Viewer) -> None:
        """Take control, or ask the driver for it.

        It is given when the driver agrees, or is gone.
        """
        if self.driver in (None, page) or not self.offered:
            self.take(page)
        elif self.asker not in (None, page):
            raise ControlError("another page has already asked: wait for the answer")
        else:
            self.asker = page

    def is_idle(self, now_s: float) -> bool:
        """Whether the driver has driven nothing for a while."""
        driven = self.going is not None or self._robot.facts.driving
        return self.driver is not None and not driven and now_s - self._active_s >= self.idle_s

    def relieve(self, page: Viewer, now_s: float, *, at_rest: bool) -> None:
        """Take control from a driver that drives nothing, while the robot stands."""
        if self.driver not in (None, page):
            if not (at_rest and self.is_idle(now_s)):
                raise ControlError(f"{self.driver.name} drives: ask for control")
            self.asker = None
            self.leave(self.driver)
        self.take(page)

    def keep(self, page: Viewer) -> Viewer | None:
        """Deny control to the page that asks for it; return that page."""
        self.check_driver(page)
        asker, self.asker = self.asker, None
        return asker

    def leave(self, page: Viewer, why: str = "") -> None:
        """Release control, if this page has it; the robot is stopped and disarmed.

        A page that asked for control then gets it, disarmed.
        """
        if self.asker is page:
            self.asker = None
        if self.driver is page:
            self.driver, self.asker = self.asker, None
            self._end_driving(why)

    def _begin_anew(self, why: str) -> None:
        """Invalidate earlier ticks, and require that all inputs are released once."""
        self._end_going()
        self._floor = self._ticks.last + 1
        self.must_let_go = True
        self._lease_end_s = None
        self.why = why

    def _end_driving(self, why: str) -> None:
        self._armed = False
        if self._robot.facts.armed:  # else zeros would take the robot from the program that has it
            self._robot.stop()
        self._begin_anew(why)

    # ---- arming and stopping ----

    def arm(self, page: Viewer, tick: int, now_s: float) -> None:
        """Allow driving; the page must have seen the robot recently."""
        self.check_driver(page)
        if self._lease_left_s(page, tick, now_s) is None:
            raise ControlError("the page is late: its link is slow or stalled; try again")
        if self._lease_end_s is not None and self._robot.facts.armed:
            self._robot.pause()
        self._begin_anew("")
        try:
            self._robot.arm(timeout=0.0)
        except NotArmedError as error:
            raise ControlError(why_refused(error.code)) from None
        self._armed = True
        self._active_s = now_s

    def disarm(self, page: Viewer, why: str = "") -> None:
        """Stop and disarm, if this page has control."""
        self.check_driver(page)
        self._end_driving(why)

    def stop(self, page: Viewer) -> None:
        """Stop the robot, armed or not: any page may do this, if driving is enabled at all."""
        if not self.offered:
            raise ControlError("this dashboard only watches, and sends the robot no command at all")
        self._robot.stop()
        where = "here" if page is self.driver else f"on {page.name}"
        self._end_driving(f"STOP was pressed {where}")

    def close(self) -> None:
        """End everything."""
        self.offered = False
        self.asker = None
        if self.driver is not None:
            self.leave(self.driver, "the dashboard ends")

    # ---- driving ----

    def drive(self, page: Viewer, inputs: Input, now_s: float) -> None:
        """Handle one input: the only place that renews a drive command."""
        self.check_driver(page)
        left_s = self._lease_left_s(page, inputs.tick, now_s)
        if left_s is None:
            self.dropped += 1
            return
        if self.going is not None:
            if inputs.neutral and inputs.going:
                self.going.renew(now_s + left_s)
            else:
                self._end_going()
                self.must_let_go = True
            return
        if inputs.neutral:
            self._let_go()
            return
        self._active_s = now_s
        if not self._robot.facts.armed:
            self.must_let_go = True
            return
        if self._lease_end_s is not None and now_s >= self._lease_end_s:
            self.must_let_go = True
            self._lease_end_s = None
            self.why = "inputs arrived too late and the robot was stopped: let go, then drive on"
        if not self.must_let_go:
            self._command(inputs, now_s + left_s)

    def go(self, page: Viewer, tick: int, goal: Goal, now_s: float) -> None:
        """Let the robot go to a place by itself, as long as this page keeps allowing it."""
        self.check_driver(page)
        left_s = self._lease_left_s(page, tick, now_s)
        if left_s is None:
            raise ControlError("the page is late: its link is slow or stalled; try again")
        speed = goal.scale * self.limits.linear_m_s[1]
        if not self._robot.facts.armed or not speed > 0.0:
            raise ControlError("the robot is disarmed: arm it first")
        self._end_going()
        self.why = ""
        self.going = Going(self._robot, goal, speed, now_s + left_s, self._gone)
        self.begun.append(self.going)

    def _end_going(self) -> None:
        if self.going is not None:
            self.going.end()
            self._gone, self.going = self.going, None
            self._active_s = self._robot.now_s

    def _let_go(self) -> None:
        facts = self._robot.facts
        if facts.armed:  # else the client stopped it, and zeros now would be another command
            if self.must_let_go:
                self.why = ""
            if self._lease_end_s is not None or facts.lapsed:
                self._robot.pause()
        self.must_let_go = False
        self._lease_end_s = None

    def _command(self, inputs: Input, end_s: float) -> None:
        """Drive until this time, and no longer even if this process is delayed right here."""
        for _ in range(_ATTEMPTS):
            now_s = self._robot.now_s
            left_s = end_s - now_s
            if left_s < SHORTEST_LEASE_S:
                break
            try:
                self._robot.drive(
                    _speed(inputs.forward * inputs.scale, self.limits.linear_m_s),
                    _speed(inputs.left * inputs.scale, self.limits.angular_rad_s),
                    lease_s=min(left_s, 1.0),
                )
            except NotArmedError as error:
                self._begin_anew(why_disarmed(error.code))
                return
            if self._robot.now_s - now_s <= HELD_UP_S:
                self._lease_end_s = end_s
                self.why = ""
                return
        self._robot.pause()
        self._begin_anew("this computer was delayed while it drove: let go, then drive on")

    def _lease_left_s(self, page: Viewer, tick: int, now_s: float) -> float | None:
        """Return what is left of the lease that started when this tick was issued."""
        age_s = self._ticks.age_s(tick, now_s)
        if age_s is None or not self._floor <= tick <= page.sent_tick:
            return None
        left_s = self._lease_s - age_s
        return left_s if left_s >= SHORTEST_LEASE_S else None

    def check_driver(self, page: Viewer) -> None:
        """Raise if this page is not in control."""
        if self.driver is not page:
            raise ControlError("this page has not taken control")

    # ---- supervision ----

    def watch(self, now_s: float) -> None:
        """Withdraw control if driving has become unsafe; called at each step."""
        facts = self._robot.facts
        if self.driver is None:
            return
        if self.why and self._robot.state is not State.READY:
            self.why = "the robot was lost"
        if self.going is not None and not self.going.on:
            self.why = self.going.why and f"it did not arrive: {self.going.why}"
            self.going = None
        if self._armed and not facts.armed:
            self._armed = False
            self._begin_anew(why_disarmed(facts.disarm_cause))
        if now_s - self.driver.heard_s > FORGOTTEN_S:
            self.leave(self.driver, "the driver's page showed nothing for 30 s and lost control")


def limits_of(robot: Robot, max_linear_m_s: float, max_angular_rad_s: float) -> Limits:
    """Return the meaning of full deflection on this robot; 0 while its limits are unknown."""
    found = robot.properties.differential
    if found is None:
        return NO_LIMITS
    return Limits(
        _sides(max_linear_m_s, found.min_linear_m_s, found.max_linear_m_s),
        _sides(max_angular_rad_s, found.min_angular_rad_s, found.max_angular_rad_s),
    )


def _sides(ceiling: float, low: float, high: float) -> Sides:
    if not (math.isfinite(low + high) and low <= 0.0 <= high):
        return NO_LIMITS.linear_m_s
    return min(ceiling, -low), min(ceiling, high)


def _speed(share: float, sides: Sides) -> float:
    return share * sides[share > 0.0]
