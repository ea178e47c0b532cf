# SPDX-License-Identifier: MIT
"""`roburoc4 ros2`, where the package roburoc4-ros2 is installed; else what installs it."""

from __future__ import annotations

import argparse
import importlib

from ..errors import usage
from ..options import Options


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command of the other package."""
    try:
        command = importlib.import_module("roburoc4_ros2.command")
    except ModuleNotFoundError as missing:
        if missing.name != "roburoc4_ros2":
            raise
        parser = commands.add_parser(
            "ros2",
            prefix_chars="\0",  # whatever options it is given
            add_help=False,
            help="show the robot in a ROS 2 system (needs the package roburoc4-ros2)",
        )
        parser.add_argument("options", nargs="*")
        parser.set_defaults(run=_refuse)
    else:
        command.add(commands)


def _refuse(_options: Options) -> int:
    remedy = "pip install ./bindings/python ./tools ./ros2 in a checkout (see docs/ros2.md)"
    if __file__.startswith("/usr/lib/python3/dist-packages/"):  # a distribution's package
        remedy = "install the package beside this one (see docs/packages.md)"
    raise usage(f"ros2 needs roburoc4-ros2: {remedy}")
