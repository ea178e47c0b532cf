# SPDX-License-Identifier: MIT
"""Robot files: what is known about one robot, as ``roburoc4 first-contact`` measured it."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path

from . import _native
from .constants import Result
from .errors import ArgumentError

__all__ = ["can_hold", "load", "save"]


def can_hold(name: str, value: float) -> bool:
    """Return whether a robot file can have this name with this number."""
    try:
        _native.robot_file_write({name: value})
    except ValueError:
        return False
    return True


def load(path: str | PathLike[str]) -> dict[str, float]:
    """Return the numbers of a robot file by name; ArgumentError names line and remedy."""
    try:
        return _native.robot_file_read(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ArgumentError(
            f"{path}: cannot be read ({error.strerror}): give a file of roburoc4 first-contact or "
            "roburoc4 calibrate",
            Result.CONFIG,
        ) from error
    except ValueError as error:
        raise ArgumentError(f"{path}: {error}", Result.CONFIG) from error


def save(path: str | PathLike[str], values: Mapping[str, float]) -> None:
    """Write a robot file; ArgumentError for a name or a number that cannot be in one."""
    try:
        text = _native.robot_file_write(dict(values))
    except ValueError as error:
        raise ArgumentError(str(error), Result.CONFIG) from error
    Path(path).write_text(text, encoding="utf-8")
