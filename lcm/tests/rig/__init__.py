# SPDX-License-Identifier: MIT
"""What the tests stand on: real processes, a tap on the robot's wire, and an ear on the bus."""

from .bridge import Bridge
from .bus import Bus, Message, Planner
from .process import Program
from .programs import Programs
from .robot import Robot
from .strain import MachineTooBusyError, Strain
from .tap import Tap
from .waiting import holds, until

__all__ = [
    "Bridge",
    "Bus",
    "MachineTooBusyError",
    "Message",
    "Planner",
    "Program",
    "Programs",
    "Robot",
    "Strain",
    "Tap",
    "holds",
    "until",
]
