# SPDX-License-Identifier: MIT
"""What goes to stdout: JSON, or text that a person reads."""

from __future__ import annotations

import json
import math
import struct
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
        return _shortest(value) if math.isfinite(value) else None
    if hasattr(value, "_asdict"):
        return {name: plain(item) for name, item in value._asdict().items()}
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def _shortest(value: float) -> float:
    """Give a number that the robot sent in 32 bits without the digits that it never had."""
    try:
        bits = struct.pack("<f", value)
    except OverflowError:
        return value
    if struct.unpack("<f", bits)[0] != value:
        return value
    candidates = (float(f"{value:.{digits}g}") for digits in (6, 7, 8))
    return next((short for short in candidates if struct.pack("<f", short) == bits), value)


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

    return Console(stderr=stderr, highlight=False)


def printable(text: str) -> str:
    """Keep a robot's text from steering the terminal."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )
