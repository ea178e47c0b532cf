# SPDX-License-Identifier: MIT
"""What the tests stand on: real processes, a tap on the robot's wire, and an ear on the bus."""

from processes import Program, Programs, Robot, Tap, until

from .bridge import Bridge
from .bus import Bus, Message, Planner

__all__ = [
    "Bridge",
    "Bus",
    "Message",
    "Planner",
    "Program",
    "Programs",
    "Robot",
    "Tap",
    "until",
]
