# SPDX-License-Identifier: MIT
"""``ros2 run roburoc4_bringup node --ros-args ...``."""

import sys


def main() -> None:
    """Run it, or say what installs it."""
    try:
        from roburoc4_ros2.node import main as run
    except ModuleNotFoundError as missing:
        sys.exit(
            f"roburoc4_bringup: {missing.name} is not installed for {sys.executable}: run pip "
            "install ./bindings/python ./tools ./ros2 in a checkout (see docs/ros2.md)"
        )
    run()
