# SPDX-License-Identifier: MIT
"""`roburoc4 events`: what happened in a recording, by kind, text and time."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from ..errors import ExitCode
from ..options import Options, add_json
from ..output import print_json, printable
from .cut import add_times
from .report import add_recorded, opened

_KINDS = ("bad", "weak", "good", "plain")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "events",
        help="search the events of a recording",
        description="Print what happened to the recorded robot, as a client would have reported "
        "it: seconds after the beginning, time in UTC, kind and text.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a pcapng or pcap file")
    parser.add_argument(
        "--kind",
        dest="kinds",
        choices=_KINDS,
        action="append",
        help="only these, which `report` shows in red, amber, green and without colour; may be "
        "repeated",
    )
    parser.add_argument(
        "--text", metavar="WORDS", default="", help="only those that contain this, in any case"
    )
    add_times(parser)
    add_recorded(parser)
    add_json(parser, "print one object a line")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Print the events that fit; like grep, return 1 if there is none."""
    from ...recordings import RecordedEvent
    from ...report.figures import utc

    found = False
    with opened(options.file, options.recorded) as recording:
        begun_s = recording.begun_s
        begin_s = options.begin(begun_s) if options.begin else -math.inf
        end_s = options.end(begun_s) if options.end else math.inf
        for item in recording.items():
            time_s = item.host_us / 1e6
            # Not the end: some are known only later.
            if not isinstance(item, RecordedEvent) or not begin_s <= time_s < end_s:
                continue
            if options.kinds and item.level not in options.kinds:
                continue
            if options.text.casefold() not in item.text.casefold():
                continue
            found = True
            if options.json:
                row = {"time": utc(time_s), "seconds": round(time_s - begun_s, 3)}
                print_json({**row, "level": item.level, "text": item.text}, line=True)
            else:
                text = printable(item.text)
                print(f"{time_s - begun_s:10.3f}  {utc(time_s)}  {item.level:<5}  {text}")
    return ExitCode.FINE if found else ExitCode.REFUSED
