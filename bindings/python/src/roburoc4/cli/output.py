# SPDX-License-Identifier: MIT
"""What goes to stdout: JSON, or text that a person reads."""

from __future__ import annotations

import json
import math
import sys
from enum import Enum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console


def plain(value: Any) -> Any:
    """Turn records into what JSON has: a named tuple into an object, NaN into null."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "_asdict"):
        return {name: plain(item) for name, item in value._asdict().items()}
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def print_json(value: Any, *, line: bool = False) -> None:
    """Print one document, or one object in a line of its own, at once."""
    print(json.dumps(plain(value), indent=None if line else 2), flush=True)


def note(text: str) -> None:
    """Tell the person at the terminal something that is not the result."""
    print(f"roburoc4: {text}", file=sys.stderr, flush=True)


def is_terminal() -> bool:
    """Whether a person reads stdout."""
    return sys.stdout.isatty()


def console(*, stderr: bool = False) -> Console:
    """Make Rich's view of the terminal."""
    from rich.console import Console

    class Screen(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # a pipe that was closed is no failure; Rich would exit with 1

    return Screen(stderr=stderr, highlight=False)


def printable(text: str) -> str:
    """Keep a robot's text from steering the terminal."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )
