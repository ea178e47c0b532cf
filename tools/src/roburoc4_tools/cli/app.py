# SPDX-License-Identifier: MIT
"""The command line: its commands, and how their results become exit codes."""

from __future__ import annotations

import argparse
import os
import sys

from . import completion
from .connecting import dissector, doctor, first_contact, set_ip
from .driving import calibrate, drive, moves, one_shot, teleop
from .errors import CommandError, ExitCode, of_library, refused, usage
from .options import Parser, add_robot, shield_numbers
from .recording import convert, cut, events, record, recover, replay, report
from .simulating import sim
from .watching import dashboard, foxglove, info, monitor, ros2

_COMMANDS = (
    info,
    monitor,
    moves,
    first_contact,
    calibrate,
    drive,
    teleop,
    dashboard,
    foxglove,
    ros2,
    one_shot,
    doctor,
    record,
    recover,
    replay,
    report,
    events,
    cut,
    convert,
    dissector,
    set_ip,
    sim,
    completion,
)
_EXAMPLES = """\
try it without a robot:
  roburoc4 sim                           in one terminal; it prints a line for the others
  roburoc4 monitor                       in another
  roburoc4 move 1
  roburoc4 turn 90deg

exit codes: 0 success, 1 the robot refused or was lost, 2 usage, 3 not reachable,
129, 130, 131 and 143 after SIGHUP, Ctrl-C, Ctrl-\\ and SIGTERM
"""


def parser() -> argparse.ArgumentParser:
    """Make the whole command line."""
    top = Parser(
        prog="roburoc4",
        description="Watch, check and drive a RobuROC4 robot or its simulator.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="store_true", help="print the version and exit")
    top.set_defaults(parser=top)  # for completion
    add_robot(top, top=True)
    commands = top.add_subparsers(metavar="COMMAND", title="commands")
    for command in _COMMANDS:
        command.add(commands)
    return top


def run(arguments: list[str]) -> int:
    """Run one command line; return its exit code."""
    _prepare_streams()
    try:
        try:
            code = _run(arguments)
        except SystemExit as end:  # argparse has shown its help
            code = int(end.code or 0)
        sys.stdout.flush()
    except CommandError as error:
        return _complain(error)
    except BrokenPipeError:
        _let_go_of_stdout()
        return ExitCode.FINE
    except ModuleNotFoundError:
        raise  # main() reports what to install
    except Exception as error:
        if os.environ.get("ROBUROC4_DEBUG"):
            raise
        return _complain(of_library(error) or _surprise(error))
    return code


def _prepare_streams() -> None:
    """Make all three streams usable, whatever the shell closed; replace what cannot be encoded."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
        elif mode == "w":
            stream.reconfigure(errors="replace")


def _let_go_of_stdout() -> None:
    """Keep Python from complaining about a closed pipe when it flushes at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _surprise(error: Exception) -> CommandError:
    if isinstance(error, OSError):
        _let_go_of_stdout()
        return refused(f"the output cannot be written ({error.strerror or error}): free some space")
    return refused(
        f"unexpected {type(error).__name__} ({error}): please report it, with what this command "
        "prints under ROBUROC4_DEBUG=1"
    )


def _run(arguments: list[str]) -> int:
    top = parser()
    options = top.parse_args(shield_numbers(arguments))
    if options.version:
        from roburoc4 import __version__

        print(f"roburoc4 {__version__}")
        return ExitCode.FINE
    if "run" not in options:
        raise usage("a command is missing: see roburoc4 --help")
    code: int = options.run(options)
    return code


def _complain(error: CommandError) -> int:
    if error.message:
        print(f"roburoc4: {error.message}", file=sys.stderr)
    return error.code
