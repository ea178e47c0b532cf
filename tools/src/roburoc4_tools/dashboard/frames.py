# SPDX-License-Identifier: MIT
"""The robot as documents for the page: its properties, and its current state."""

from __future__ import annotations

import math
from typing import Any

from roburoc4.constants import (
    BatteryState,
    Count,
    Event,
    LocalizationFlag,
    Role,
    State,
    StopOutcome,
)
from roburoc4.errors import NotKnownError
from roburoc4.latest import latest
from roburoc4.notices import texts_of
from roburoc4.protocol import STATUS_SERVICES
from roburoc4.records import (
    BatteryProperties,
    BatteryStatus,
    ChannelNames,
    DifferentialProperties,
    DifferentialStatus,
    Facts,
    IoCardStatus,
    LocalizationStatus,
    TelemeterProperties,
    TelemeterStatus,
)
from roburoc4.robot import Robot

from ..recordings.replay import TEXT
from .advice import STALE_MS, advise, why_not_armed
from .history import History, number

_LINK_EVERY_S = 0.2
_ABOUT_EVERY_S = 1.0
_OVERDUE_PERIODS = 3.0
_UNCONFIRMED = (StopOutcome.TIMED_OUT, StopOutcome.OVERRIDDEN)
_PLUGGED_IN = (int(BatteryState.CHARGING), int(BatteryState.CHARGED))
_POSE_ERROR = int(LocalizationFlag.INVALID | LocalizationFlag.ERROR)
_NOTES = {
    ("front_bumper", True): ("bad", "the front bumper was pressed"),
    ("front_bumper", False): ("plain", "the front bumper was released"),
    ("rear_bumper", True): ("bad", "the rear bumper was pressed"),
    ("rear_bumper", False): ("plain", "the rear bumper was released"),
    ("tugs", True): ("bad", "armed or moving with the charger plugged in"),
    ("tugs", False): ("plain", "at rest and disarmed again, or unplugged"),
    ("charger", True): ("plain", "the charger was plugged in"),
    ("charger", False): ("plain", "the charger was unplugged"),
    ("pose_error", True): ("weak", "the localization reports an error: do not trust the pose"),
    ("pose_error", False): ("plain", "the localization works again"),
}
STILL = 0.02
"""Below this, in m/s and rad/s, it stands."""
_CHANGES = Event.READY | Event.PROPERTIES | Event.DESCRIPTION | Event.DESCRIPTIONS_DONE | Event.ROLE

Document = dict[str, Any]


class Frames:
    """Reads a robot without ever waiting for it."""

    def __init__(self, robot: Robot, history: History) -> None:
        self._robot = robot
        self._events = robot.events()
        self._history = history
        self._link: Document = {}
        self._stale: list[str] = []
        self._rested = True
        self._told: dict[str, bool] = {}
        self.at_rest: bool | None = None
        """Whether it stands, by its measured speeds; None: not known."""
        self._link_due_s = -math.inf
        self._about: Document = {}
        self._about_due_s = -math.inf
        self._about_old = True
        self._facts = robot.facts
        self._volts_index: int | None = None

    # ---- now ----

    def take(self, now_s: float, time_s: float) -> Document:
        """Return the robot's current state, and add to the history."""
        events = self._events.take()
        facts = self._robot.facts
        for level, text in texts_of(events, self._facts, facts):
            self._history.note(time_s, level, text)
        self._facts = facts
        speeds = latest(self._robot, DifferentialStatus)
        pose = latest(self._robot, LocalizationStatus)
        battery = latest(self._robot, BatteryStatus)
        at_rest = self.at_rest = self._is_at_rest(speeds)
        if facts.stop_outcome not in _UNCONFIRMED:
            self._rested = False
        elif at_rest:  # which is as good as a confirmation
            self._rested = True
        if events & _CHANGES:
            self._about_old = True
        if now_s >= self._link_due_s:
            self._link_due_s = now_s + _LINK_EVERY_S
            self._link = self._look_at_link()
        return {
            "time_s": round(time_s, 3),
            "state": State(facts.state).name.lower(),
            "link": self._link,
            "facts": {
                "armed": facts.armed,
                "driving": facts.driving,
                "overridden": facts.overridden,
                "other_commander": facts.other_commander,
                "inhibited": facts.inhibited,
                "front_bumper": facts.front_bumper,
                "rear_bumper": facts.rear_bumper,
                "battery_low": facts.battery_low,
                "missing": [service.name.lower() for service in facts.missing],
                "stop_unconfirmed": not self._rested and facts.stop_outcome in _UNCONFIRMED,
                "at_rest": at_rest,
                **self._conditions(time_s, battery, pose, facts),
                "blocked": why_not_armed(facts.arm_refusal),
            },
            "stale": self._stale,
            "speeds": self._speeds(time_s, speeds),
            "pose": self._pose(time_s, pose),
            "distances_m": self._distances(),
            **self._inputs(),
            "battery": self._battery(time_s, battery),
        }

    @property
    def _fresh(self) -> bool:
        """Whether its values are current: those of a lost robot are not."""
        return self._robot.state is State.READY

    def _is_at_rest(self, status: DifferentialStatus | None) -> bool | None:
        if status is None or not self._fresh or "differential" in self._stale:
            return None
        speeds = status.current_linear_m_s, status.current_angular_rad_s
        return all(abs(speed) < STILL for speed in speeds)  # False for NaN

    def _conditions(
        self,
        time_s: float,
        battery: BatteryStatus | None,
        pose: LocalizationStatus | None,
        facts: Facts,
    ) -> dict[str, bool]:
        """Return conditions that the library reports no events for, and note their changes."""
        charger = battery is not None and battery.state in _PLUGGED_IN
        now = {
            "charger": charger,
            "pose_error": pose is not None and bool(int(pose.flags) & _POSE_ERROR),
        }
        noted = now | {
            "front_bumper": facts.front_bumper,
            "rear_bumper": facts.rear_bumper,
            "tugs": charger and (facts.armed or self.at_rest is False),
        }
        for name, on in noted.items():
            if self._fresh and on is not None and on != self._told.get(name, False):
                self._told[name] = on
                self._history.note(time_s, *_NOTES[name, on])
        return now

    def _speeds(
        self, time_s: float, status: DifferentialStatus | None
    ) -> list[float | None] | None:
        if status is None:
            return None
        fresh = self._fresh and "differential" not in self._stale
        self._history.add_speeds(time_s, status[1:5] if fresh else (math.nan,) * 4)
        return [number(speed) for speed in status[1:5]]

    def _pose(self, time_s: float, status: LocalizationStatus | None) -> Document | None:
        if status is None:
            return None
        if self._fresh:
            self._history.add_place(time_s, status.x_m, status.y_m, status.theta_rad)
        return {
            "x_m": number(status.x_m),
            "y_m": number(status.y_m),
            "theta_rad": number(status.theta_rad, 4),
        }

    def _distances(self) -> list[float | None] | None:
        status = latest(self._robot, TelemeterStatus)
        return None if status is None else [number(metres) for metres in status.distances_m]

    def _inputs(self) -> Document:
        status = latest(self._robot, IoCardStatus)
        if status is None:
            return {"analog": None, "digital": None}
        return {
            "analog": [number(value) for value in status.analog_inputs],
            "digital": "".join("1" if on else "0" for on in status.digital_inputs),
        }

    def _battery(self, time_s: float, status: BatteryStatus | None) -> Document | None:
        if status is None:
            return None
        volts = self._volts()
        if self._fresh and "battery" not in self._stale:
            self._history.add_battery(time_s, status.remaining_percent, volts)
        else:
            self._history.add_battery(time_s, math.nan, math.nan)
        state = status.state
        return {
            "state": state.name.lower() if isinstance(state, BatteryState) else f"state {state}",
            "percent": status.remaining_percent,
            "volts": number(volts, 2),
            "trend_percent_h": self._history.trend_percent_h(),
        }

    def _volts(self) -> float:
        status = latest(self._robot, IoCardStatus)
        index = self._volts_index
        if status is None or index is None or index >= len(status.analog_inputs):
            return math.nan
        return status.analog_inputs[index]

    # ---- the link ----

    def _look_at_link(self) -> Document:
        link = self._robot.link
        services = {}
        oldest_ms = 0.0
        self._stale = []
        for name, service in STATUS_SERVICES.items():
            figures = self._robot.service_link(service)
            age_ms = None if figures.age_us is None else figures.age_us / 1000
            if age_ms is not None and figures.subscribed:
                overdue = age_ms > _OVERDUE_PERIODS * figures.period_us / 1000
                oldest_ms = max(oldest_ms, age_ms if overdue else 0.0)
                if overdue and age_ms > STALE_MS:
                    self._stale.append(name)
            services[name] = {
                "period_ms": figures.period_us / 1000,
                "age_ms": None if age_ms is None else round(age_ms),
                "loss": self._measured(figures.loss),
                "jitter_ms": self._measured(figures.jitter_us / 1000),
            }
        advice = advise(
            self._robot.state,
            self._robot.fault,
            link,
            self._robot.counts[Count.RECEIVED],
            self._robot.address,
            oldest_ms,
        )
        return {
            **advice._asdict(),
            "loss": self._measured(link.loss),
            "round_trip_ms": self._measured(link.round_trip_us / 1000 or math.nan),
            "silence_ms": round(link.silence_us / 1000),
            "services": services,
        }

    def _measured(self, value: float) -> float | None:
        """Round a figure of the link; None if the robot is silent."""
        return number(value, 4) if self._fresh else None

    # ---- what it is ----

    def about(self, now_s: float) -> Document | None:
        """Return the robot's properties if they have changed since the last call."""
        if not self._about_old or now_s < self._about_due_s:
            return None
        self._about_due_s = now_s + _ABOUT_EVERY_S
        self._about_old = False
        about = self._describe()
        if about == self._about:
            return None
        self._about = about
        return about

    @property
    def known(self) -> Document:
        """The robot's properties, as last sent."""
        return self._about

    def _describe(self) -> Document:
        properties = self._robot.properties
        channels = self._channels()
        self._volts_index = self._robot.role_index(Role.BATTERY_V)
        return {
            "address": self._robot.address,
            "recorded": any(TEXT in service.name for service in properties.services),
            "telemeter": [_numbers(telemeter) for telemeter in properties.telemeter],
            "battery": _numbers(properties.battery),
            "differential": _numbers(properties.differential),
            "channels": channels._asdict(),
        }

    def _channels(self) -> ChannelNames:
        try:
            return self._robot.channels
        except NotKnownError:
            return ChannelNames((), (), (), ())


def _numbers(
    properties: BatteryProperties | DifferentialProperties | TelemeterProperties | None,
) -> Document | None:
    """Make properties ready for JSON, whatever a robot reports."""
    if properties is None:
        return None
    return {name: number(value, 4) for name, value in properties._asdict().items()}
