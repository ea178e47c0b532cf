# SPDX-License-Identifier: MIT
"""The node's settings as parameters of ROS 2. It does not depend on DDS."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from roburoc4_tools.ros.cdr import Cdr, CdrReader

from .commands import DriveConfig
from .config import ROBOT_SETTINGS, ConfigError, RobotConfig, checked

Value = bool | int | float | str
# As in rcl_interfaces/ParameterType.
_NOT_SET = 0
_TYPES: dict[type, int] = {bool: 1, int: 2, float: 3, str: 4}
_CEILINGS = ("max_linear_m_s", "max_angular_rad_s")
_SLOPES = ("max_linear_m_s2", "max_angular_rad_s2")


class Parameter(NamedTuple):
    """A parameter, and what it may be."""

    value: Value
    usable: str
    read_only: bool


class Parameters:
    """Lists, reads and sets; ceilings and slopes can be set, all else is given at the start."""

    def __init__(
        self, config: RobotConfig, drive: Callable[[], DriveConfig], limit: Callable[..., object]
    ) -> None:
        """Begin; ``drive`` returns the limits that are in force, ``limit`` changes some."""
        self._config = config
        self._drive = drive
        self._limit = limit
        self._highest = {name: getattr(config.drive, name) for name in _CEILINGS}

    def all(self) -> dict[str, Parameter]:
        """Return all parameters, by name."""
        config, drive = self._config, self._drive()
        values: dict[str, Value] = {
            "address": config.address,
            "base_frame": config.frames.base,
            "enable_drive": drive.enabled,
            "frame_prefix": config.frames.prefix,
            "lease_ms": drive.lease_ms,
            "map_frame": config.frames.map,
            "max_age_ms": drive.max_age_ms,
            **{name: float(getattr(drive, name)) for name in (*_CEILINGS, *_SLOPES)},
            "odom_frame": config.frames.odom,
            "tf": config.tf,
            "twist": not drive.stamped,
        }
        found = {
            name: Parameter(value, ROBOT_SETTINGS[name].usable, name not in (*_CEILINGS, *_SLOPES))
            for name, value in values.items()
        }
        found["use_sim_time"] = Parameter(False, "false: stamps are this computer's time", True)
        return dict(sorted(found.items()))

    def refusal(self, name: str, value: Value | None) -> str:
        """Return why a parameter cannot be set to this; empty if it can."""
        known = self.all().get(name)
        if known is None:
            return f"there is no parameter {name}"
        if value == known.value and type(value) is type(known.value):
            return ""
        if known.read_only:
            return f"{name} is given at the start: start the node again with it"
        if isinstance(value, bool) or not isinstance(value, int | float):
            return f"{name}: give a number"
        try:
            checked(name, value)
        except ConfigError as error:
            return str(error)
        if name in self._highest and float(value) > self._highest[name]:
            return f"{name}: the node was started with {self._highest[name]:g}, which is the most"
        return ""

    def set(self, changes: Iterable[tuple[str, Value | None]]) -> str:
        """Set all of them, or none; return why not."""
        wanted = dict(changes)
        for name, value in wanted.items():
            if refusal := self.refusal(name, value):
                return refusal
        limits = {
            name: float(value)
            for name, value in wanted.items()
            if name in (*_CEILINGS, *_SLOPES) and isinstance(value, int | float)
        }
        self._limit(**limits)
        return ""

    # ---- services: from a request's members to a response's ----

    def list(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/ListParameters; none of the names has a prefix."""
        prefixes = _texts(request)
        names = [name for name in self.all() if not prefixes or name in prefixes]
        response.numbers("I", len(names))
        for name in names:
            response.text(name)
        response.numbers("I", 0)

    def get(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/GetParameters."""
        names, known = _texts(request), self.all()
        response.numbers("I", len(names))
        for name in names:
            _write(response, known[name].value if name in known else None)

    def types(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/GetParameterTypes."""
        names, known = _texts(request), self.all()
        types = [_TYPES[type(known[name].value)] if name in known else _NOT_SET for name in names]
        response.sequence("B", types)

    def describe(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/DescribeParameters."""
        names, known = _texts(request), self.all()
        response.numbers("I", len(names))
        for name in names:
            one = known.get(name)
            response.text(name).numbers("B", _TYPES[type(one.value)] if one else _NOT_SET)
            response.text(one.usable if one else "").text("")
            response.numbers("B", one.read_only if one else 0, 0)
            highest = self._highest.get(name)
            response.numbers("I", highest is not None)
            if highest is not None:
                response.numbers("d", 0.001, highest, 0.0)
            response.numbers("I", 0)

    def set_each(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/SetParameters."""
        changes = _changes(request)
        response.numbers("I", len(changes))
        for change in changes:
            _result(response, self.set([change]))

    def set_atomically(self, request: CdrReader, response: Cdr) -> None:
        """Serve rcl_interfaces/SetParametersAtomically."""
        _result(response, self.set(_changes(request)))


def _result(response: Cdr, refusal: str) -> None:
    response.numbers("B", not refusal).text(refusal)


def _count(request: CdrReader) -> int:
    count = int(request.numbers("I", 1)[0])
    if count > request.left:
        raise ValueError("a message ends too early")
    return count


def _texts(request: CdrReader) -> list[str]:
    return [request.text() for _ in range(_count(request))]


def _changes(request: CdrReader) -> list[tuple[str, Value | None]]:
    return [(request.text(), _read(request)) for _ in range(_count(request))]


def _read(request: CdrReader) -> Value | None:
    """Read a rcl_interfaces/ParameterValue; lists are no value here."""
    kind, flag = (int(number) for number in request.numbers("B", 2))
    (whole,), (real,) = request.numbers("q", 1), request.numbers("d", 1)
    text = request.text()
    for code in "BBqd":
        request.numbers(code, _count(request))
    _texts(request)
    values: dict[int, Value] = {1: bool(flag), 2: int(whole), 3: real, 4: text}
    return values.get(kind)


def _write(response: Cdr, value: Value | None) -> None:
    kind = _NOT_SET if value is None else _TYPES[type(value)]
    response.numbers("B", kind, value is True)
    response.numbers("q", value if type(value) is int else 0)
    response.numbers("d", value if isinstance(value, float) else 0.0)
    response.text(value if isinstance(value, str) else "")
    response.numbers("I", 0, 0, 0, 0, 0)
