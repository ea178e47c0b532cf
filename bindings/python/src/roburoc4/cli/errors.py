# SPDX-License-Identifier: MIT
"""Exit codes, and how a command ends early: with one line on stderr of what to do."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
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
    """Make the error of a command line that does not make sense."""
    return CommandError(ExitCode.USAGE, message)


def unreachable(message: str) -> CommandError:
    """Make the error of a robot that does not answer."""
    return CommandError(ExitCode.UNREACHABLE, message)


_START_AGAIN = "then start again"
_REMEDIES = {
    "NOT_READY": f"run roburoc4 doctor, {_START_AGAIN}",
    "NO_DIFFERENTIAL": "see roburoc4 info",
    "LIMITS": "see roburoc4 info",
    "STALE_DIFFERENTIAL": f"run roburoc4 doctor, {_START_AGAIN}",
    "STALE_IOCARD": f"run roburoc4 doctor, {_START_AGAIN}",
    "OVERRIDE_UNKNOWN": "run roburoc4 doctor, or drive all the same with --ignore-override",
    "OVERRIDE": f"wait until [A] is released, {_START_AGAIN}",
    "MOVING": f"run roburoc4 stop, {_START_AGAIN}",
    "OTHER_COMMANDER": f"end the other program, {_START_AGAIN}",
    "LOST": f"look at power and cable, {_START_AGAIN}",
    "REBOOT": f"look at the robot, {_START_AGAIN}",
    "INHIBITED": f"release its emergency stops and brakes, {_START_AGAIN}",
}


def why_not_armed(error: NotArmedError) -> str:
    """Name the cause, for people who can see the robot, without advice for programs."""
    from roburoc4 import Result

    return Result(error.code).text


def of_library(error: Exception) -> CommandError | None:
    """Translate an exception of the library; None for an unexpected one."""
    from roburoc4 import NotArmedError, Result, RobotError

    if isinstance(error, NotArmedError):
        # Its own text advises people who write programs.
        remedy = _REMEDIES.get(Result(error.code).name, _START_AGAIN.removeprefix("then "))
        return refused(f"{why_not_armed(error)}: {remedy}")
    return refused(str(error)) if isinstance(error, RobotError) else None
