# SPDX-License-Identifier: MIT
"""What goes to stdout: JSON, or text for people."""

from __future__ import annotations

import json
import select
import sys
from typing import TYPE_CHECKING, Any

from ..plain import plain
from .errors import CommandError, ExitCode

if TYPE_CHECKING:
    from rich.console import Console


def print_json(value: Any, *, line: bool = False) -> None:
    """Print one document, or one object on its own line, at once."""
    print(json.dumps(plain(value), indent=None if line else 2), flush=True)


def note(text: str) -> None:
    """Print a message that is not the result, for the person at the terminal."""
    print(f"roburoc4: {text}", file=sys.stderr, flush=True)


def refuse_closed_pipe() -> None:
    """End the command, quietly, if nobody reads its output any more: who started it is gone."""
    if not hasattr(select, "poll"):
        return
    watched = select.poll()
    watched.register(sys.stdout.fileno(), 0)
    if any(event & select.POLLERR for _, event in watched.poll(0)):
        raise CommandError(ExitCode.REFUSED, "")


def is_terminal() -> bool:
    """Whether a person reads stdout."""
    return sys.stdout.isatty()


def console(*, stderr: bool = False) -> Console:
    """Make Rich's view of the terminal."""
    from rich.console import Console

    class Screen(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # a closed pipe is not an error; Rich would exit with 1

    return Screen(stderr=stderr, highlight=False)


def printable(text: str) -> str:
    """Keep a robot's text from controlling the terminal."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )
