# SPDX-License-Identifier: MIT
"""The figures of a recording, read once; series and lists have a fixed size."""

from __future__ import annotations

import math
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

from roburoc4.constants import BatteryState, Role
from roburoc4.errors import NotKnownError
from roburoc4.protocol import STATUS_SERVICES
from roburoc4.records import (
    BatteryStatus,
    DifferentialCommand,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    TelemeterStatus,
)

from ..recordings.recording import Command, RecordedEvent, RecordedRobot
from .series import Series

_PATH_POINTS = 4000
_PATH_STEP_M = 0.02
_MOST_EVENTS = 5000
_MOST_SPANS = 400
_MOST_CLIENTS = 100
_JUMP_M = 1.0
_PROGRESS_EVERY = 5000


class Path:
    """The path by odometry; the distance of points grows with the path."""

    def __init__(self) -> None:
        self.points: list[tuple[float, float]] = []
        self.breaks: set[int] = set()
        """Indices of points to which the robot did not drive: odometry was set, or it restarted.
        """
        self.driven_m = 0.0
        self._step_m = _PATH_STEP_M
        self.end: tuple[float, float] | None = None

    def add(self, x_m: float, y_m: float) -> None:
        """Add a position."""
        if not (math.isfinite(x_m) and math.isfinite(y_m)):
            return
        before, self.end = self.end, (x_m, y_m)
        if before is None:
            self.points.append((x_m, y_m))
            return
        moved_m = math.hypot(x_m - before[0], y_m - before[1])
        if moved_m > _JUMP_M:
            self.breaks.add(len(self.points))
            self.points.append((x_m, y_m))
            return
        self.driven_m += moved_m
        last = self.points[-1]
        if math.hypot(x_m - last[0], y_m - last[1]) >= self._step_m:
            self.points.append((x_m, y_m))
            if len(self.points) > 2 * _PATH_POINTS:
                self._thin()

    def _thin(self) -> None:
        self._step_m *= 2
        kept = [at for at in range(len(self.points)) if at % 2 == 0 or at in self.breaks]
        self.breaks = {new for new, at in enumerate(kept) if at in self.breaks}
        self.points = [self.points[at] for at in kept]


class Switch:
    """A digital input over time."""

    def __init__(self) -> None:
        self.spans: list[list[float]] = []
        """When it was on, from and until; only the first ones if there are too many."""
        self.times = 0
        self.on_s = 0.0
        self._since_s: float | None = None

    def set(self, on: bool, seconds: float) -> None:
        """Add its current value."""
        if on and self._since_s is None:
            self._since_s = seconds
            self.times += 1
        elif not on and self._since_s is not None:
            self.on_s += seconds - self._since_s
            if len(self.spans) < _MOST_SPANS:
                self.spans.append([self._since_s, seconds])
            self._since_s = None


class Figures:
    """Everything that a report shows."""

    def __init__(self, recording: RecordedRobot) -> None:
        begun_s = recording.begun_s
        self.name = recording.path.name
        self._recording = recording
        self._reading = recording.read()
        self._begun_s = self._now_s = begun_s
        self.speeds = [Series(begun_s) for _ in range(4)]
        """Target and current speed, target and current turn rate."""
        self.battery_percent = Series(begun_s)
        self.battery_v = Series(begun_s)
        self.distances: list[Series] = []
        self.switches: list[Switch] = []
        self.analog: list[tuple[float, float]] = []
        self.path = Path()
        self.heading_deg = Series(begun_s)
        """Beyond a whole turn, too, so that a line has no jumps."""
        self._theta_rad = 0.0
        self.events: list[RecordedEvent] = []
        self.more_events = 0
        self.bad_events = 0
        self._digital: tuple[bool, ...] = ()
        self._battery_state: BatteryState | int | None = None
        self._volts_index: int | None = None
        self._last_s: dict[str, float] = {}
        self._gap_s: dict[str, float] = {}
        self._clients: dict[str, dict[str, int]] = {}
        self._handlers: dict[type, Callable[[Any], None]] = {
            IoCardStatus: self._iocard,
            TelemeterStatus: self._telemeter,
            BatteryStatus: self._battery,
            LocalizationStatus: self._localization,
            DifferentialStatus: self._differential,
            Command: self._command,
            RecordedEvent: self._event,
        }

    def read(self, show: Callable[[int], None]) -> None:
        """Read the recording; ``show`` is called periodically with the number of bytes read."""
        handlers = self._handlers
        for count, item in enumerate(self._reading.items()):
            self._now_s = item.host_us / 1e6
            handlers[type(item)](item)
            if count % _PROGRESS_EVERY == 0:
                show(self._reading.capture.position)
        end_s = self.seconds
        for switch in self.switches:
            switch.set(False, end_s)
        self.events.sort(key=lambda event: event.host_us)

    # ---- items ----

    def _heard(self, kind: str) -> None:
        before = self._last_s.get(kind)
        self._last_s[kind] = self._now_s
        if before is not None and self._now_s - before > self._gap_s.get(kind, 0.0):
            self._gap_s[kind] = self._now_s - before

    def _iocard(self, status: IoCardStatus) -> None:
        self._heard("iocard")
        if status.digital_inputs != self._digital:
            self._digital = status.digital_inputs
            seconds = self._now_s - self._begun_s
            while len(self.switches) < len(self._digital):
                self.switches.append(Switch())
            for switch, on in zip(self.switches, self._digital, strict=False):
                switch.set(on, seconds)
        analog = status.analog_inputs
        if len(self.analog) != len(analog):
            self.analog = [(value, value) for value in analog]
            self._volts_index = self._reading.robot.role_index(Role.BATTERY_V)
        for at, (low, high) in enumerate(self.analog):
            value = analog[at]
            if not low <= value <= high:
                self.analog[at] = (min(low, value), max(high, value))
        if self._volts_index is not None and self._volts_index < len(analog):
            self.battery_v.add(self._now_s, analog[self._volts_index])

    def _telemeter(self, status: TelemeterStatus) -> None:
        self._heard("telemeter")
        while len(self.distances) < len(status.distances_m):
            self.distances.append(Series(self._begun_s))
        for series, metres in zip(self.distances, status.distances_m, strict=False):
            series.add(self._now_s, metres)

    def _battery(self, status: BatteryStatus) -> None:
        self._heard("battery")
        self.battery_percent.add(self._now_s, status.remaining_percent)
        if self._battery_state != status.state:
            if self._battery_state is not None:
                text = f"the battery's state is {status.state_name}"
                self._event(RecordedEvent(status.host_us, "plain", text))
            self._battery_state = status.state

    def _localization(self, status: LocalizationStatus) -> None:
        self._heard("localization")
        self.path.add(status.x_m, status.y_m)
        if math.isfinite(status.theta_rad):
            self._theta_rad += math.remainder(status.theta_rad - self._theta_rad, math.tau)
            self.heading_deg.add(self._now_s, math.degrees(self._theta_rad))

    def _differential(self, status: DifferentialStatus) -> None:
        self._heard("differential")
        now_s = self._now_s
        for series, value in zip(self.speeds, status[1:5], strict=True):
            series.add(now_s, value)

    def _command(self, command: Command) -> None:
        sender = command.sender
        if sender not in self._clients and len(self._clients) >= _MOST_CLIENTS:
            sender = "others"
        client = self._clients.setdefault(sender, {"commands": 0, "speeds": 0})
        client["commands"] += 1
        telegram = command.telegram
        if isinstance(telegram, DifferentialCommand) and any(telegram):
            client["speeds"] += 1

    def _event(self, event: RecordedEvent) -> None:
        if len(self.events) < _MOST_EVENTS:
            self.events.append(event)
        else:
            self.more_events += 1
        self.bad_events += event.level == "bad"

    # ---- results ----

    @property
    def seconds(self) -> float:
        """The duration of the recording."""
        return max(0.0, self._reading.counts.last_us / 1e6 - self._begun_s)

    @property
    def channel_names(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the analog and the digital inputs."""
        try:
            channels = self._reading.robot.channels
        except NotKnownError:
            return (), ()
        return channels.analog_inputs, channels.digital_inputs

    def document(self) -> dict[str, Any]:
        """Return the figures, ready for JSON."""
        reading, recording = self._reading, self._recording
        counts = reading.counts
        analog_names, digital_names = self.channel_names
        target, current, target_turn, turn = self.speeds
        return {
            "file": str(recording.path),
            "robot": recording.address,
            "begun": utc(self._begun_s),
            "seconds": round(self.seconds, 3),
            "cut_bytes": reading.capture.cut,
            "not_recorded": reading.capture.dropped,
            "assumed": not recording.head.answers.complete,
            "path": {
                "driven_m": round(self.path.driven_m, 3),
                "begin": _place(self.path.points[:1]),
                "end": _place([self.path.end] if self.path.end else []),
            },
            "heading_deg": _range(self.heading_deg),
            "speeds": {
                "target_linear_m_s": _range(target),
                "current_linear_m_s": _range(current),
                "target_angular_rad_s": _range(target_turn),
                "current_angular_rad_s": _range(turn),
            },
            "battery": {
                "percent": _range(self.battery_percent),
                "volts": _range(self.battery_v),
            },
            "distances_m": [_range(series) for series in self.distances],
            "analog_inputs": [
                {
                    "index": at,
                    "name": _name(analog_names, at),
                    "low": _round(low),
                    "high": _round(high),
                }
                for at, (low, high) in enumerate(self.analog)
            ],
            "digital_inputs": [
                {
                    "index": at,
                    "name": _name(digital_names, at),
                    "times_on": switch.times,
                    "seconds_on": round(switch.on_s, 3),
                }
                for at, switch in enumerate(self.switches)
            ],
            "link": {
                "datagrams": counts.from_robot,
                "copies": counts.copies,
                "requests": counts.requests,
                "answered": counts.answered,
                "round_trip_ms": None
                if not counts.answered
                else {
                    "low": counts.round_trip_min_us / 1000,
                    "mean": round(counts.round_trip_sum_us / counts.answered / 1000, 3),
                    "high": counts.round_trip_max_us / 1000,
                },
                "services": [self._service(name) for name in STATUS_SERVICES],
            },
            "clients": [{"address": name, **client} for name, client in self._clients.items()],
            "events": [
                {
                    "time": utc(event.host_us / 1e6),
                    "seconds": round(event.host_us / 1e6 - self._begun_s, 3),
                    "level": event.level,
                    "text": event.text,
                }
                for event in self.events
            ],
            "more_events": self.more_events,
            "bad_events": self.bad_events,
        }

    def _service(self, name: str) -> dict[str, Any]:
        figures = self._reading.robot.service_link(name)
        expected = figures.received + figures.lost
        return {
            "service": name,
            "received": figures.received,
            "lost": figures.lost,
            "loss": round(figures.lost / expected, 5) if expected else None,
            "rate_hz": round(figures.received / self.seconds, 2) if self.seconds else None,
            "jitter_ms": round(figures.jitter_us / 1000, 2) if figures.received else None,
            "longest_gap_s": round(self._gap_s[name], 3) if name in self._gap_s else None,
        }


def utc(time_s: float) -> str:
    """Write Unix time as ISO 8601, in UTC, with milliseconds."""
    try:
        moment = datetime.fromtimestamp(round(time_s, 3), UTC)
    except (OverflowError, ValueError, OSError):  # a file with damaged times
        return f"{time_s:.3f}"
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _round(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


def _range(series: Series) -> dict[str, float | None] | None:
    if not series.points:
        return None
    return {
        "first": _round(series.first),
        "low": _round(series.low),
        "high": _round(series.high),
        "last": _round(series.latest),
    }


def _place(points: list[tuple[float, float]]) -> list[float] | None:
    return [round(value, 3) for value in points[0]] if points else None


def _name(names: tuple[str, ...], index: int) -> str:
    return names[index] if index < len(names) else ""
