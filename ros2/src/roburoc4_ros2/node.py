# SPDX-License-Identifier: MIT
"""The node as ROS 2 starts programs: ``node --ros-args -r odom:=wheel_odom -p address:=...``."""

import os
import sys

from roburoc4_tools.cli.errors import CommandError
from roburoc4_tools.cli.options import DEFAULT_ROBOT
from roburoc4_tools.cli.output import note
from roburoc4_tools.terminal import signals

from .command import serve
from .config import ConfigError, whole
from .environment import settings
from .ros_args import read


def main() -> None:
    """Run one robot's node until a signal, and exit with the command's codes."""
    signals.install()
    try:
        try:
            robot = read(sys.argv[1:], os.environ.get("ROBUROC4_ROBOT") or DEFAULT_ROBOT)
            code = serve(whole((robot,), settings(os.environ)))
        except ConfigError as error:
            note(str(error))
            code = 2
        except CommandError as error:
            note(error.message)
            code = error.code
    except signals.Signalled as ended:
        code = ended.exit_code
    sys.exit(code)


if __name__ == "__main__":
    main()
