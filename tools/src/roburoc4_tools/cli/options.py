# SPDX-License-Identifier: MIT
"""The options that commands share, and numbers that are checked before anything is sent."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from typing import Any

from .errors import usage

DEFAULT_ROBOT = "192.168.0.2:60000"
FARTHEST = 1e4
"""Metres or radians of a move: the limit of roburoc4_move.h."""


class Options(argparse.Namespace):
    """The options of a command: of every one, and those that its `add` names."""

    robot: str
    json: bool


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose errors are one line, and which accepts no abbreviated options."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)

    def parse_known_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        """Reject what is unknown here, where the command's own help can be named."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return found, unknown

    def error(self, message: str) -> None:  # type: ignore[override] # it raises, too
        """Reject the command line."""
        raise usage(f"{message}: see {self.prog} --help")


def number(low: float, high: float, unit: str) -> Callable[[str], float]:
    """Make a converter to a finite number in this range."""

    def convert(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"'{text.strip()}' is not {low:g} to {high:g} {unit}")
        return value

    return convert


def whole(low: int, high: int, what: str) -> Callable[[str], int]:
    """Make a converter to a whole number in this range."""

    def convert(text: str) -> int:
        if not (text.strip().isdecimal() and low <= int(text) <= high):
            raise argparse.ArgumentTypeError(f"'{text.strip()}' is not {what} ({low} to {high})")
        return int(text)

    return convert


# Beyond these the library takes a speed for a mistake of units.
linear_m_s = number(-5.0, 5.0, "m/s")
angular_rad_s = number(-10.0, 10.0, "rad/s")
way_m = number(-FARTHEST, FARTHEST, "m")
coordinate = number(-1e7, 1e7, "m")  # the main frame may be that of a map
metres = number(-1e9, 1e9, "m")
seconds = number(0.001, 1e6, "seconds")


def angle(text: str) -> float:
    """Convert radians, or degrees as in 90deg."""
    degrees = text.strip().lower().removesuffix("deg")
    if degrees == text.strip().lower():
        plain = f"rad; did you mean {degrees}deg?" if _is_number(degrees) else "rad"
        return number(-2 * math.tau, 2 * math.tau, plain)(text)
    return math.radians(number(-570000.0, 570000.0, "degrees")(degrees))


def shield_numbers(arguments: list[str]) -> list[str]:
    """Put a blank before negative numbers, so that argparse does not take them for options."""
    return [f" {text}" if text.startswith("-") and _is_number(text) else text for text in arguments]


def _is_number(text: str) -> bool:
    try:
        float(text.removesuffix("deg"))
    except ValueError:
        return False
    return True


def add_robot(
    parser: argparse.ArgumentParser, *, top: bool = False, json: str = "print JSON"
) -> None:
    """Add `--robot` and `--json`, which may come before or after the command."""
    parser.add_argument(
        "--robot",
        metavar="HOST[:PORT]",
        default=(os.environ.get("ROBUROC4_ROBOT") or DEFAULT_ROBOT) if top else argparse.SUPPRESS,
        help="the robot's address (default: $ROBUROC4_ROBOT, else " + DEFAULT_ROBOT + ")",
    )
    add_json(parser, json, top=top)


def add_json(parser: argparse.ArgumentParser, text: str, *, top: bool = False) -> None:
    """Add `--json`."""
    parser.add_argument(
        "--json", action="store_true", default=False if top else argparse.SUPPRESS, help=text
    )


def add_seconds(parser: argparse.ArgumentParser, text: str, *, required: bool = False) -> None:
    """Add `--seconds`."""
    parser.add_argument("--seconds", metavar="N", type=seconds, required=required, help=text)
