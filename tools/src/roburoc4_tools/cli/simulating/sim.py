# SPDX-License-Identifier: MIT
"""`roburoc4 sim`: starts the simulator, and prints how other commands reach it."""

from __future__ import annotations

import argparse
import ctypes
import importlib.metadata
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable

from ...terminal.signals import Signalled
from ..errors import refused, usage

_PROGRAM = "roburoc4-sim" + (".exe" if sys.platform == "win32" else "")
_HIGHEST_PORT = 65535
_PR_SET_PDEATHSIG = 1
_READY = re.compile(r"^roburoc4-sim: ready on ([^\s,]+:\d+)")
_TELNET_HELP = """
One more option, of roburoc4 sim only:
  --telnet PORT    serve the controller's telnet console, too, to try roburoc4 set-ip on
                   (0 picks a free port)"""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "sim",
        help="start the simulator",
        description="Start roburoc4-sim; all arguments but --telnet are its own.",
        add_help=False,
        prefix_chars="\0",
    )
    parser.add_argument("arguments", nargs=argparse.REMAINDER)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Relay the simulator's output; it ends with this program."""
    arguments = [text.lstrip() for text in options.arguments]
    arguments, telnet_port = _without_telnet(arguments)
    with subprocess.Popen(
        [_program(), *arguments],
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=_ending_with_parent(),
    ) as program:
        try:
            code = _relay(program, telnet_port)
        except Signalled:
            program.terminate()
            code = program.wait()  # as roburoc4-sim promises: 0
        finally:
            program.terminate()
    if code == 0 and "--help" in arguments:
        print(_TELNET_HELP)
    return code


def _ending_with_parent() -> Callable[[], None] | None:
    """Return what makes Linux end the simulator where this program is killed, and cannot do it."""
    if sys.platform != "linux":
        return None
    prctl, parent = ctypes.CDLL(None).prctl, os.getpid()

    def prepare() -> None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != parent:  # it was killed just now
            os._exit(1)

    return prepare


def _program() -> str:
    """Return the path of the program that was installed with this package."""
    for file in importlib.metadata.files("roburoc4") or []:
        if file.name == _PROGRAM:
            return str(file.locate())
    # A distribution's package does not list its files.
    if program := shutil.which(_PROGRAM):
        return program
    raise refused(f"{_PROGRAM} is not where the package put it: install the package again")


def _without_telnet(arguments: list[str]) -> tuple[list[str], int | None]:
    """Remove --telnet PORT, the one option that is ours."""
    if "--telnet" not in arguments:
        return arguments, None
    index = arguments.index("--telnet")
    port = "".join(arguments[index + 1 : index + 2])
    if not port.isdecimal() or not 0 <= int(port) <= _HIGHEST_PORT:
        raise usage(f"--telnet: '{port}' is not a port: give 0 (any free one) to {_HIGHEST_PORT}")
    return arguments[:index] + arguments[index + 2 :], int(port)


def _serve_console(address: str, port: int) -> None:
    """Serve the controller's telnet console, on which `set-ip` can be tried, beside the robot."""
    from .sim_console import serve

    host = address.rpartition(":")[0]
    try:
        bound = serve(host, port, lambda settings: print(f"telnet: {settings}", flush=True))
    except OSError as error:
        raise refused(
            f"--telnet: {host}:{port} cannot be used ({error.strerror or error}): give another port"
        ) from None
    print(f"telnet console on {host}:{bound}", flush=True)


def _relay(program: subprocess.Popen[str], telnet_port: int | None) -> int:
    assert program.stdout is not None
    for line in program.stdout:
        print(line, end="", flush=True)
        if ready := _READY.match(line):
            # 0.0.0.0 is all addresses of this machine: only some systems can send to it.
            address = ready[1].replace("0.0.0.0:", "127.0.0.1:")
            print(f"export ROBUROC4_ROBOT={address}", flush=True)
            if telnet_port is not None:
                _serve_console(address, telnet_port)
    return program.wait()
