# SPDX-License-Identifier: MIT
"""`roburoc4 foxglove`: shows the live robot in Foxglove, without ROS."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Never

from .. import session
from ..errors import ExitCode, usage
from ..options import Options, add_robot, whole
from ..output import print_json
from ..recording.recover import check_new

if TYPE_CHECKING:
    from roburoc4 import Robot

    from ...ros.live import Live

_DEFAULT_PORT = 8765
_LOOK_S = 0.2
LAYOUT = Path(__file__).with_name("foxglove_layout.json")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "foxglove",
        help="show the live robot in Foxglove, without ROS",
        description="Serve the messages of `roburoc4 ros2 --list` over Foxglove's WebSocket "
        "protocol until Ctrl-C. Nobody who connects can send commands.",
    )
    parser.add_argument(
        "--bind",
        metavar="ADDR",
        default="127.0.0.1",
        help="address to listen on (default 127.0.0.1; 0.0.0.0: all, and anybody can watch)",
    )
    parser.add_argument(
        "--port",
        metavar="N",
        type=whole(0, 65535, "a port"),
        default=_DEFAULT_PORT,
        help=f"TCP port (default {_DEFAULT_PORT}, which Foxglove proposes; 0 picks a free one)",
    )
    parser.add_argument(
        "--layout",
        metavar="FILE.json",
        type=Path,
        help="only write a layout for it, to be imported in Foxglove, and end",
    )
    add_robot(parser, json="print an object when it is ready")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Serve until a signal."""
    if options.layout is not None:
        check_new(options.layout, force=False)
        options.layout.write_bytes(LAYOUT.read_bytes())
        print(f"{options.layout}: import it in Foxglove, under Layouts")
        return ExitCode.FINE
    from ...ros.live import Live

    with session.connected(options) as robot:
        offset_s = time.time() - robot.now_s
        try:
            live = Live(robot, options.bind, options.port, offset_s)
        except (OSError, RuntimeError) as error:
            raise usage(
                f"{options.bind}:{options.port} cannot be used ({error}): give another --port or "
                "--bind"
            ) from None
        url = f"ws://{'127.0.0.1' if options.bind == '0.0.0.0' else options.bind}:{live.port}"
        if options.json:
            print_json({"url": url}, line=True)
        else:
            print(
                f"foxglove: ready at {url}; in Foxglove: Open connection, Foxglove WebSocket",
                flush=True,
            )
        try:
            _serve(robot, live)
        finally:
            live.close()


def _serve(robot: Robot, live: Live) -> Never:
    from roburoc4.notices import texts_of

    from ...recordings import RecordedEvent

    statuses, events, facts = robot.statuses(), robot.events(), robot.facts
    while True:
        for status in statuses.take(_LOOK_S):
            live.add(status)
        before, facts = facts, robot.facts
        for level, text in texts_of(events.take(), before, facts, watches=True):
            live.add(RecordedEvent(round(robot.now_s * 1e6), level, text))
