# SPDX-License-Identifier: MIT
"""Turns the signals that end a program into one exception, so that every robot is stopped."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_NUMBERS = [
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    if hasattr(signal, name)
]


class Signalled(BaseException):
    """A signal asked this program to end."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number

    @property
    def exit_code(self) -> int:
        """The exit code that a shell reports for a program that this signal ended: 130, 143."""
        return 128 + self.number


def _end(number: int, _frame: FrameType | None) -> None:
    # A second Ctrl-C must not interrupt the zeros that the first one sends; they take little time.
    for other in _NUMBERS:
        signal.signal(other, signal.SIG_IGN)
    raise Signalled(number)


@contextmanager
def unsuspendable() -> Iterator[None]:
    """Ignore Ctrl-Z: a suspended program cannot stop a robot."""
    number = getattr(signal, "SIGTSTP", None)
    if number is None:
        yield
        return
    before = signal.signal(number, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(number, before)


def install() -> None:
    """Raise Signalled in the main thread, except for signals that our parent made us ignore."""
    for number in _NUMBERS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
