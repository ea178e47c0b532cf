# SPDX-License-Identifier: MIT
"""Names of channels, telemeters and flags."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from roburoc4 import Robot
    from roburoc4.records import ChannelNames

TELEMETER_NAMES = ("front", "rear")

_FLAGS = (
    "invalid",
    "metric",
    "decimetric",
    "centimetric",
    "proprioceptive",
    "exteroceptive",
    "error",
)


def flag_names(flags: int) -> list[str]:
    """List the names of the bits that are set."""
    return [name for bit, name in enumerate(_FLAGS) if flags >> bit & 1]


def names_of(robot: Robot) -> ChannelNames:
    """Name the IO channels; none for a robot without an IO card."""
    from roburoc4 import NotKnownError
    from roburoc4.records import ChannelNames

    try:
        return robot.channels
    except NotKnownError:
        return ChannelNames((), (), (), ())
