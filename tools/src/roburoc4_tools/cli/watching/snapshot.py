# SPDX-License-Identifier: MIT
"""Everything that is known about a robot at one moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from roburoc4 import (
    BatteryStatus,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    TelemeterStatus,
)
from roburoc4.latest import latest

if TYPE_CHECKING:
    from roburoc4 import Facts, Robot
    from roburoc4.records import ChannelNames

SERVICES = ("iocard", "telemeter", "battery", "localization", "differential")


@dataclass(frozen=True)
class StreamFigures:
    """How the statuses of one service arrive; `age_s` is None before the first."""

    service: str
    rate_hz: float
    age_s: float | None
    loss: float
    jitter_ms: float


@dataclass(frozen=True)
class Snapshot:
    """What a person wants to see at a glance; a status is None before the first."""

    address: str
    elapsed_s: float
    state: str
    facts: Facts
    round_trip_ms: float
    loss: float
    streams: list[StreamFigures]
    channels: ChannelNames
    reaches_m: list[float]  # of the telemeters
    iocard: IoCardStatus | None
    telemeter: TelemeterStatus | None
    battery: BatteryStatus | None
    localization: LocalizationStatus | None
    differential: DifferentialStatus | None


def _stream(robot: Robot, service: str) -> StreamFigures:
    figures = robot.service_link(service)
    return StreamFigures(
        service,
        1e6 / figures.period_us if figures.period_us else 0.0,
        None if figures.age_us is None else figures.age_us / 1e6,
        figures.loss,
        figures.jitter_us / 1e3,
    )


def take(robot: Robot, elapsed_s: float, channels: ChannelNames) -> Snapshot:
    """Take a snapshot."""
    link = robot.link
    return Snapshot(
        robot.address,
        elapsed_s,
        robot.state.name.lower(),
        robot.facts,
        link.round_trip_us / 1e3,
        link.loss,
        [_stream(robot, service) for service in SERVICES],
        channels,
        [telemeter.max_distance_m for telemeter in robot.properties.telemeter],
        latest(robot, IoCardStatus),
        latest(robot, TelemeterStatus),
        latest(robot, BatteryStatus),
        latest(robot, LocalizationStatus),
        latest(robot, DifferentialStatus),
    )
