# SPDX-License-Identifier: MIT
"""Exceptions. Each has the C library's result as ``code``, and a message with the remedy."""

import math
from inspect import iscoroutinefunction
from typing import Any

from . import _native
from .constants import MAX_DRIVE_M_S, MAX_DRIVE_RAD_S, Result

__all__ = [
    "ArgumentError",
    "ClosedError",
    "DecodeError",
    "NetworkError",
    "NotArmedError",
    "NotKnownError",
    "RecordingError",
    "RefusedError",
    "RobotError",
    "RobotTimeoutError",
    "SamplesLostError",
]


class RobotError(Exception):
    """Any error with a robot; ``code`` says which."""

    def __init__(self, message: str, code: int = Result.STATE) -> None:
        super().__init__(message)
        self.code = Result(code)

    def __reduce__(self) -> tuple[type["RobotError"], tuple[str, Result]]:
        return type(self), (str(self), self.code)


class ArgumentError(RobotError, ValueError):
    """An invalid value; the message gives its name and range."""


class DecodeError(RobotError, ValueError):
    """Bytes that are not a telegram."""


class RefusedError(RobotError):
    """The robot answered with an error."""


class NotKnownError(RobotError):
    """The robot has not reported this yet."""


class NotArmedError(RobotError):
    """Arming or driving was refused; ``code`` is the reason."""


class RobotTimeoutError(RobotError, TimeoutError):
    """Something did not happen in time."""


class SamplesLostError(RobotError):
    """Statuses arrived faster than they were read; ``lost`` is how many were overwritten."""

    def __init__(self, lost: int) -> None:
        super().__init__(
            f"{lost} statuses were overwritten before they were read: read more often, or give "
            "connect() a larger buffer=",
            Result.BUFFER,
        )
        self.lost = lost

    # Made from a count; the other errors are made from a text and a code.
    def __reduce__(self) -> tuple[type["SamplesLostError"], tuple[int]]:  # type: ignore[override]
        return type(self), (self.lost,)


class NetworkError(RobotError, OSError):
    """The operating system or the network refused."""


class RecordingError(RobotError, ValueError):
    """What is not a recording, or is damaged, or cannot be read or written."""

    def __init__(self, message: str, code: int = Result.VALUE) -> None:
        super().__init__(message, code)


class ClosedError(RobotError):
    """The robot object was closed, or belongs to the process from which this one was forked."""


def unusable(name: str, value: object, usable: str, code: int = Result.ARGUMENT) -> ArgumentError:
    """Make the error for an argument: its name, its value, and the allowed values."""
    shown = repr(value) if isinstance(value, str | bytes) else value
    return ArgumentError(f"{name}: {shown} cannot be used; give {usable}", code)


def is_within(low: float, value: object, high: float) -> bool:
    """Whether the value is a number in this range; a text is none, and NaN is in no range."""
    number: Any = value
    return hasattr(value, "__float__") and not _is_array(value) and bool(low <= number <= high)


def _is_array(value: object) -> bool:
    """Whether it is an array of NumPy or the like, other than of one number without dimensions."""
    return getattr(value, "shape", ()) != ()


def finite(**values: float) -> None:
    """Reject NaN, infinity, and values beyond the range of a C float."""
    for name, value in values.items():
        if not is_within(-_FLOAT_MAX, value, _FLOAT_MAX):
            usable = f"a finite number, {-_FLOAT_MAX:g} to {_FLOAT_MAX:g}"
            raise unusable(name, value, usable, Result.NOT_FINITE)


def check_heading(theta_rad: float) -> None:
    """Refuse what looks like degrees."""
    if not is_within(-MAX_HEADING_RAD, theta_rad, MAX_HEADING_RAD):
        usable = "radians (not degrees), within two turns"
        raise unusable("theta_rad", theta_rad, usable, Result.UNITS)


def check_speeds(linear_m_s: float, angular_rad_s: float) -> None:
    """Reject speeds that are not finite, or beyond any RobuROC4: mistakes of units."""
    finite(linear_m_s=linear_m_s, angular_rad_s=angular_rad_s)
    if abs(linear_m_s) > MAX_DRIVE_M_S:
        usable = f"m/s (not mm/s), at most {MAX_DRIVE_M_S:g}"
        raise unusable("linear_m_s", linear_m_s, usable, Result.UNITS)
    if abs(angular_rad_s) > MAX_DRIVE_RAD_S:
        usable = f"rad/s (not degrees), at most {MAX_DRIVE_RAD_S:g}"
        raise unusable("angular_rad_s", angular_rad_s, usable, Result.UNITS)


def duration_s(name: str, seconds: float) -> float:
    """Reject values that are not durations."""
    if not is_within(0, seconds, _LONGEST_S):
        raise unusable(name, seconds, f"0 to {_LONGEST_S:g} s")
    return float(seconds)


def timeout_s(seconds: float) -> float:
    """Reject values that are not timeouts; infinity is one."""
    if isinstance(seconds, float) and seconds == math.inf:
        return seconds
    return duration_s("timeout", seconds)


NOT_ASYNC = "a function that is not async"


def is_async(value: object) -> bool:
    """Whether this is a function, or an object with one as ``__call__``, that must be awaited."""
    return iscoroutinefunction(value) or (callable(value) and iscoroutinefunction(value.__call__))


def function(name: str, value: object) -> None:
    """Reject what cannot be called, and what would have to be awaited."""
    if not callable(value) or is_async(value):
        raise unusable(name, value, NOT_ASYNC)


def switch(name: str, value: object, code: int = Result.ARGUMENT) -> bool:
    """Reject values that are not true, false or None, such as "off", which Python takes as true."""
    if _is_array(value) or value not in (True, False, None):
        raise unusable(name, value, "True or False", code)
    return bool(value)


_FLOAT_MAX = 3.4e38
MAX_HEADING_RAD = 12.57
_LONGEST_S = 1e9
_CLASSES: dict[int, type[RobotError]] = {
    Result.ARGUMENT: ArgumentError,
    Result.ADDRESS: ArgumentError,
    Result.CONFIG: ArgumentError,
    Result.INDEX: ArgumentError,
    Result.RESERVED: ArgumentError,
    Result.NOT_FINITE: ArgumentError,
    Result.UNITS: ArgumentError,
    Result.SHORT: DecodeError,
    Result.KIND: DecodeError,
    Result.VALUE: DecodeError,
    Result.ROBOT: RefusedError,
    Result.NOT_KNOWN: NotKnownError,
    Result.TIMEOUT: RobotTimeoutError,
    Result.SYSTEM: NetworkError,
    Result.RESOLVE: NetworkError,
    Result.CLOSED: ClosedError,
}


def error_of(code: int) -> RobotError:
    """Make the exception for a result of the C library."""
    text = _native.roburoc4_result_text(code)
    if Result.SUBSCRIPTION_REFUSED <= code <= Result.DISARMED and code != Result.UNITS:
        why = text.removeprefix("not armed: ").replace(":", ";", 1)
        return NotArmedError(f"not armed: {why}", code)
    return _CLASSES.get(code, RobotError)(text, code)


_native.register_errors(error_of)
