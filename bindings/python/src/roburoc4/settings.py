# SPDX-License-Identifier: MIT
"""Settings of a client: from keyword arguments to the C library's struct."""

import re
from collections.abc import Mapping
from os import PathLike
from typing import Any, TypedDict

from . import _native, robot_file
from .constants import Result, Role, Service
from .errors import ArgumentError, is_within, switch, unusable

__all__ = ["Settings"]


class Settings(TypedDict, total=False):
    """Keyword arguments of ``connect`` and ``Simulator.connect``; all have defaults."""

    period_ms: Mapping[str, int | None]
    """Status periods by service ("iocard", "telemeter", "battery", "localization",
    "differential"): a multiple of 10, 10 to 2550; None to leave a service out. Defaults: 50, 100,
    1000, 50, 50. The periods of IO card and differential may be at most a third of ``fresh_ms``.
    """
    lease_ms: int
    """Lease of a drive command; 20 to 1000; 250."""
    lapse_disarm_ms: int
    """Disarm if a lease expired and was not renewed for this long; 0 to 60000; 1000."""
    drive_period_ms: int
    """Period of drive commands; 10 to 500, at most half of ``lease_ms``
    and of ``robot_watchdog_ms``; 50."""
    fresh_ms: int
    """Maximum age of a status that counts for driving; 50 to 1000; 300."""
    lost_ms: int
    """Silence after which the robot counts as lost; 200 to 60000; 1000."""
    first_retry_ms: int
    """Time until a request is repeated, doubling to 1 s; 10 to 100; 100."""
    robot_watchdog_ms: int
    """The watchdog time of the robot itself; 100 to 60000; 1000."""
    max_linear_m_s: float
    """Ceiling of speed, before and after `scale_linear`; 0.001 to 5; 1.0."""
    max_angular_rad_s: float
    """Ceiling of turn rate, likewise; 0.001 to 10; 1.5."""
    scale_linear: float
    """Factor on the speed given to ``drive``, and of what the wheels count; 0.01 to 10; 1."""
    scale_angular: float
    """Factor on the turn rate, likewise."""
    robot_file: str | PathLike[str]
    """File of ``roburoc4 first-contact`` or ``calibrate``: ids, indices of inputs, the robot's
    watchdog and both scales, as far as it has them. Other arguments take precedence."""
    keep_curvature: bool
    """At a limit, slow down instead of turning less; off."""
    allow_unknown_override: bool
    """Arm although no text names [A]; off. Gives up a protection."""
    ignore_other_commander: bool
    """Stay armed while another client commands; off. Gives up a protection."""
    override_index: int
    """Index of game pad [A] among the digital inputs, if the robot's texts do not identify it."""
    front_bumper_index: int
    """Index of the front bumper among the digital inputs, likewise."""
    rear_bumper_index: int
    """Index of the rear bumper among the digital inputs, likewise."""
    battery_voltage_index: int
    """Index of the battery voltage among the analog inputs, likewise."""
    iocard_id: int
    """Id of the IO card's service, if neither its type nor its text identifies it; 2 to 65535."""
    differential_id: int
    """Id of the differential service, likewise."""
    buffer: int
    """Number of statuses kept for slow readers; 16 to 1000000; 10000."""
    record: str | PathLike[str]
    """File (``.pcapng``) in which every datagram is recorded, or a folder for a file named after
    the time. Existing files are not overwritten: ``run.2.pcapng`` is created beside
    ``run.pcapng``.
    """
    record_max_bytes: int | None
    """Begin a new file before this one grows longer; None: never; None."""
    record_max_s: int | None
    """Begin a new file when this one is older; None: never; None."""


BUFFER_DEFAULT = 10_000

_OPTIONS = {"keep_curvature": 1, "allow_unknown_override": 2, "ignore_other_commander": 4}
_ELSEWHERE = ("buffer", "record", "record_max_bytes", "record_max_s")
_ROLES = {
    "override_index": Role.OVERRIDE,
    "front_bumper_index": Role.FRONT_BUMPER,
    "rear_bumper_index": Role.REAR_BUMPER,
    "battery_voltage_index": Role.BATTERY_V,
}
STATUS_MASK = 0x7C
"""Bit k set: service k sends statuses."""
STATUS_SERVICES = {
    "iocard": Service.IOCARD,
    "telemeter": Service.TELEMETER,
    "battery": Service.BATTERY,
    "localization": Service.LOCALIZATION,
    "differential": Service.DIFFERENTIAL,
}
"""The services that send statuses, by name."""


def service_of(service: str | Service) -> Service:
    """Return the service with this name; the error lists those that send statuses."""
    name = service.lower() if isinstance(service, str) else None
    number = service if isinstance(service, int) else None
    found = next((s for n, s in STATUS_SERVICES.items() if name == n or number == s), None)
    if found is None:
        raise unusable("service", service, f"one of {', '.join(STATUS_SERVICES)}")
    return found


def set_member(struct: str, settings: object, name: str, value: float) -> None:
    """Change a member of settings of the C library; OverflowError, TypeError."""
    getattr(_native, f"roburoc4_{struct}_{name}_set")(settings, value)


def known_of(file: object) -> dict[str, float]:
    """Return what the robot file says that a setting names."""
    if not isinstance(file, str | PathLike):
        raise unusable("robot_file", file, "a path", Result.CONFIG)
    try:
        return robot_file.load(file)
    except ArgumentError as error:
        raise ArgumentError(f"robot_file: {error}", Result.CONFIG) from error


def _set_periods(config: "_native.Config", periods: Mapping[str, int | None]) -> None:
    if not isinstance(periods, Mapping):
        raise unusable(
            "period_ms", periods, 'periods by service, such as {"battery": 500}', Result.CONFIG
        )
    wanted = STATUS_MASK
    for name, period_ms in periods.items():
        service = service_of(name)
        if period_ms is None:
            wanted &= ~(1 << service)
        else:
            _native.roburoc4_config_period_ms_set(config, service, period_ms)
    _native.roburoc4_config_subscriptions_set(config, wanted)


# Settings gives each name its type.
def _set(config: "_native.Config", name: str, value: Any) -> None:
    if name in _ROLES:
        _native.roburoc4_config_role_index_set(config, _ROLES[name], value)
    elif name == "period_ms":
        _set_periods(config, value)
    elif name == "robot_file":
        _native.robot_file_config(known_of(value), config)
    elif name not in _OPTIONS and name not in _ELSEWHERE:
        set_member("config", config, name, value)


def config_of(settings: Settings) -> "_native.Config":
    """Make the C struct."""
    config = _native.new_config()
    for name, value in sorted(settings.items(), key=lambda item: item[0] != "robot_file"):
        if name not in Settings.__annotations__:
            known = ", ".join(sorted(Settings.__annotations__))
            raise ArgumentError(f"no setting {name!r}: there are {known}", Result.CONFIG)
        try:
            _set(config, name, value)
        except ArgumentError:
            raise
        except (OverflowError, TypeError, ValueError) as error:
            raise unusable(name, value, _range_of(name) or str(error), Result.CONFIG) from error
    options = sum(
        bit
        for name, bit in _OPTIONS.items()
        if switch(name, settings.get(name, False), Result.CONFIG)
    )
    _native.roburoc4_config_options_set(config, options)
    wrong = _native.roburoc4_config_error(config)
    if wrong is not None:
        raise _wrong(settings, wrong)
    buffer_of(settings)
    return config


def _names_of(wrong: str) -> set[str]:
    """Return the settings that the C library's name and range refer to."""
    name = wrong.partition(":")[0].partition(" ")[0]
    return set(_ROLES) if name == "role_index" else {name}


def _wrong(settings: Settings, wrong: str) -> ArgumentError:
    about = _names_of(wrong)
    given = {
        name: value
        for name, value in settings.items()
        if name in about or re.search(rf"\b{name}\b", wrong)
    }
    if len(given) == 1:
        name, value = next(iter(given.items()))
        usable = wrong.removeprefix(f"{name}: ").removeprefix("iocard_id, differential_id: ")
        return unusable(name, value, usable, Result.CONFIG)
    values = ", ".join(f"{name}={value!r}" for name, value in given.items())
    return ArgumentError(f"{values} cannot be used; give {wrong}", Result.CONFIG)


def _range_of(name: str) -> str | None:
    """Ask the C library for the range by passing an invalid value."""
    config = _native.new_config()
    _set(config, name, {"battery": 0} if name == "period_ms" else -2 if name in _ROLES else 0)
    wrong = _native.roburoc4_config_error(config)
    return wrong.removeprefix(f"{name}: ") if wrong is not None else None


def buffer_of(settings: Settings) -> int:
    """Return how many statuses are kept for slow readers."""
    buffer = settings.get("buffer", BUFFER_DEFAULT)
    if not is_within(16, buffer, 1_000_000):
        raise unusable("buffer", buffer, "16 to 1000000", Result.CONFIG)
    return int(buffer)
