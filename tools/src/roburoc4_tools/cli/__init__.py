# SPDX-License-Identifier: MIT
"""The command `roburoc4`: watch, check and drive a robot.

Each command has a file in the folder of its kind; the files beside the folders are shared.
"""

from __future__ import annotations

import sys

_INSTALLED_BY = {
    "rich": "./tools",
    "shtab": "./tools",
    "telnetlib3": "./tools",
    "starlette": '"./tools[dashboard]"',
    "uvicorn": '"./tools[dashboard]"',
    "websockets": '"./tools[dashboard]"',
    "mcap": '"./tools[record]"',
    "foxglove": '"./tools[foxglove]"',
    "cyclonedds": "./tools ./ros2",
    "yaml": "./tools ./ros2",
}


def main() -> None:
    """Run the command line and exit with its code."""
    from ..terminal import signals

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
        remedy = f"pip install ./bindings/python {packages} in a checkout (see docs/python.md)"
        if "dist-packages" in __file__:  # a distribution's package
            remedy = (
                f"apt install python3-{name} where that is new enough, else pip install {name} in "
                "a virtual environment with --system-site-packages (see docs/packages.md)"
            )
        print(f"roburoc4: {name} is not installed: {remedy}", file=sys.stderr)
        code = 2
    sys.exit(code)
