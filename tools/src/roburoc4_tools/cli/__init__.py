# SPDX-License-Identifier: MIT
"""The command `roburoc4`: watch, check and drive a robot.

Each command has its own file; the other files are shared.
"""

from __future__ import annotations

import sys

_INSTALLED_BY = {
    "rich": "./tools",
    "shtab": "./tools",
    "telnetlib3": "./tools",
    "mcap": '"./tools[record]"',
    "cyclonedds": "./tools ./ros2",
    "yaml": "./tools ./ros2",
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
        packages = _INSTALLED_BY.get(name)
        if packages is None:
            raise
        print(
            f"roburoc4: {name} is not installed: pip install ./bindings/python {packages} in a "
            "checkout (see docs/python.md)",
            file=sys.stderr,
        )
        code = 2
    sys.exit(code)
