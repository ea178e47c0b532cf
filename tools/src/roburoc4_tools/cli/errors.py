# SPDX-License-Identifier: MIT
"""Exit codes, and the error that ends a command with one line on stderr: what to do."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from roburoc4 import NotArmedError


class ExitCode(IntEnum):
    """What the command returns to the shell; signals add 129, 130, 131 and 143."""

    FINE = 0
    REFUSED = 1  # the robot refused or was lost
    USAGE = 2
    UNREACHABLE = 3


class CommandError(Exception):
    """Ends a command with a code and one line."""

    def __init__(self, code: ExitCode, message: str) -> None:
        super().__init__(message)
        self.code = code
        self.message = " ".join(message.split())


def refused(message: str) -> CommandError:
    """Make the error of a robot that refused, or was lost."""
    return CommandError(ExitCode.REFUSED, message)


def usage(message: str) -> CommandError:
    """Make the error for a command line that makes no sense."""
    return CommandError(ExitCode.USAGE, message)


def unwritable(path: Path, error: OSError) -> CommandError:
    """Make the error for an output file that cannot be opened."""
    return usage(f"{path} cannot be written ({error.strerror}): give another name")


def unreachable(message: str) -> CommandError:
    """Make the error of a robot that does not answer."""
    return CommandError(ExitCode.UNREACHABLE, message)


def why_not_armed(error: NotArmedError) -> str:
    """Name the cause and the remedy, for people who can see the robot."""
    from roburoc4 import Result

    if error.code is Result.OVERRIDE_UNKNOWN:
        return "game pad input unknown: run roburoc4 doctor, or use --allow-unknown-override"
    if error.code is Result.STOP_CALLED:
        return "the robot was stopped"
    if error.code is Result.LAPSED:
        return "this program was held up, so the robot was stopped: start again"
    return error.code.text


def of_library(error: Exception) -> CommandError | None:
    """Translate an exception of the library; None for an unexpected one."""
    from roburoc4 import NotArmedError, RobotError

    if isinstance(error, NotArmedError):
        return refused(why_not_armed(error))
    return refused(str(error)) if isinstance(error, RobotError) else None
