# SPDX-License-Identifier: MIT
"""`roburoc4 sim`: start the simulator, and say how to point the other commands at it."""

from __future__ import annotations

import argparse
import re
import subprocess
import sys

_PROGRAM = [
    sys.executable,
    "-c",
    "import sys; from roburoc4.sim_program import main; sys.exit(main())",
]
_READY = re.compile(r"ready on ([^\s,]+)")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "sim",
        help="start the simulator",
        description="Start roburoc4-sim; all arguments are its own.",
        add_help=False,
        prefix_chars="\0",
    )
    parser.add_argument("arguments", nargs=argparse.REMAINDER)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Relay what the simulator says; it ends with this program."""
    arguments = [text.lstrip() for text in options.arguments]
    with subprocess.Popen([*_PROGRAM, *arguments], stdout=subprocess.PIPE, text=True) as program:
        try:
            return _relay(program)
        finally:
            program.terminate()


def _relay(program: subprocess.Popen[str]) -> int:
    assert program.stdout is not None
    for line in program.stdout:
        print(line, end="", flush=True)
        if ready := _READY.search(line):
            # 0.0.0.0 is all addresses of this machine: only some systems can send to it.
            address = ready[1].replace("0.0.0.0:", "127.0.0.1:")
            print(f"export ROBUROC4_ROBOT={address}", flush=True)
    return program.wait()
