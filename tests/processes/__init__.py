# SPDX-License-Identifier: MIT
"""Real processes for tests: programs, simulated robots, and a tap on the robot's wire."""

from .driving import drives, first_zero_us
from .process import Program
from .programs import Programs
from .robot import Robot
from .tap import Tap
from .waiting import until

__all__ = [
    "Program",
    "Programs",
    "Robot",
    "Tap",
    "drives",
    "first_zero_us",
    "until",
]
