# SPDX-License-Identifier: MIT
"""`roburoc4 replay`: serves a recording on a port as if it were the robot."""

from __future__ import annotations

import argparse
import socket
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ExitCode, usage
from ..options import Options, add_json, number, whole
from ..output import note, print_json
from ..progress import progress
from .report import add_recorded, opened

if TYPE_CHECKING:
    from ...recordings.replay import Peer, ReplayedRobot
    from ..progress import Show

_DEFAULT_PORT = 60000
_LONGEST_WAIT_S = 0.2
_MOST_DATAGRAM = 65535
_RECEIVED_AT_ONCE = 100


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "replay",
        help="serve a recording as if it were the robot",
        description="Answer on a UDP port as the recorded robot did, and send its statuses in "
        "their time, starting when somebody subscribes. Commands are counted and change "
        "nothing.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a pcapng or pcap file")
    parser.add_argument(
        "--bind", metavar="ADDR", default="127.0.0.1", help="IPv4 address (default 127.0.0.1)"
    )
    parser.add_argument(
        "--port",
        metavar="N",
        type=whole(0, 65535, "a port"),
        default=_DEFAULT_PORT,
        help=f"UDP port (default {_DEFAULT_PORT}; 0 picks a free one)",
    )
    parser.add_argument(
        "--speed",
        metavar="N",
        type=number(0.01, 100.0, "times as fast"),
        default=1.0,
        help="this many times as fast (default 1)",
    )
    parser.add_argument("--loop", action="store_true", help="start over at the end")
    add_recorded(parser)
    add_json(parser, "print a document at the end")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Serve the recording until its end."""
    with opened(options.file, options.recorded) as recording, _bound(options) as port:
        from ...recordings.replay import ReplayedRobot

        robot = ReplayedRobot(
            recording,
            lambda peer, data: _send(port, peer, data),
            note,
            speed=options.speed,
            loop=options.loop,
        )
        host, number = port.getsockname()
        # with --json, stdout is for the document
        out = sys.stderr if options.json else sys.stdout
        print(f"replay: ready on {host}:{number}, recorded from {recording.address}", file=out)
        address = "127.0.0.1" if host == "0.0.0.0" else host
        print(f"export ROBUROC4_ROBOT={address}:{number}", file=out, flush=True)
        if options.speed != 1.0:
            note(
                f"at speed {options.speed:g}, what clients show of loss, periods and lateness is "
                "of the replay, not of the recording"
            )
        try:
            with progress("waiting", options.file.stat().st_size / 1e6, "MB") as show:
                _serve(port, robot, show)
        finally:
            _report(options, robot)
    return ExitCode.FINE


def _bound(options: Options) -> socket.socket:
    port = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        port.bind((options.bind, options.port))
    except (OSError, OverflowError) as error:
        port.close()
        cause = error.strerror if isinstance(error, OSError) else error
        raise usage(
            f"{options.bind}:{options.port} cannot be used ({cause}): give another --port or --bind"
        ) from None
    return port


def _send(port: socket.socket, peer: Peer, data: bytes) -> None:
    try:
        port.sendto(data, peer)
    except OSError:  # as the network would lose it
        return


def _serve(port: socket.socket, robot: ReplayedRobot, show: Show) -> None:
    while not robot.ended:
        now_s = time.monotonic()
        due_s = robot.due_s
        wait_s = _LONGEST_WAIT_S if due_s is None else min(due_s - now_s, _LONGEST_WAIT_S)
        _receive(port, robot, wait_s)
        robot.advance(time.monotonic())
        if robot.statuses:
            show(robot.capture.position / 1e6, f"playing  {robot.statuses} statuses")


def _receive(port: socket.socket, robot: ReplayedRobot, wait_s: float) -> None:
    port.settimeout(max(wait_s, 1e-4))
    for _ in range(_RECEIVED_AT_ONCE):
        try:
            data, peer = port.recvfrom(_MOST_DATAGRAM)
        except (TimeoutError, BlockingIOError):
            return
        except OSError:  # Windows reports that a client is gone
            continue
        robot.receive((peer[0], peer[1]), data, time.monotonic())
        port.settimeout(0)


def _report(options: Options, robot: ReplayedRobot) -> None:
    commands = sum(client.commands for client in robot.clients.values())
    if options.json:
        print_json(
            {
                "file": str(options.file),
                "statuses": robot.statuses,
                "commands": commands,
                "clients": [
                    {"address": f"{peer[0]}:{peer[1]}", "commands": client.commands}
                    for peer, client in robot.clients.items()
                ],
            }
        )
    else:
        clients = len(robot.clients)
        print(
            f"{robot.statuses} statuses, {clients} client{'' if clients == 1 else 's'}, "
            f"{commands} commands that changed nothing"
        )
