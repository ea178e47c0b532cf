# SPDX-License-Identifier: MIT
"""The command `roburoc4`, part of the extra `cli`: watch, check and drive a robot.

Each command has its own file; the other files are shared.
"""

from __future__ import annotations

import sys

_EXTRAS = {
    "rich": "cli",
    "shtab": "cli",
    "telnetlib3": "cli",
    "mcap": "record",
    "cyclonedds": "ros2",
    "yaml": "ros2",
}


def main() -> None:
    """Run the command line and exit with its code."""
    from . import signals

    signals.install()
    try:
        from .app import run

        code = run(sys.argv[1:])
    except signals.Signalled as ended:
        code = ended.exit_code
    except ModuleNotFoundError as missing:
        name = (missing.name or "").partition(".")[0]
        extra = _EXTRAS.get(name)
        if extra is None:
            raise
        print(
            f'roburoc4: {name} is not installed: pip install "./bindings/python[{extra}]" in a '
            "checkout (see docs/python.md)",
            file=sys.stderr,
        )
        code = 2
    sys.exit(code)
