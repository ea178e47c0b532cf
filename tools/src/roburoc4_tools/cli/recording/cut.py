# SPDX-License-Identifier: MIT
"""`roburoc4 cut`: saves a part of a recording, or merges several by time."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ExitCode, usage
from ..options import Options, add_json
from ..output import print_json
from .recover import check_new
from .report import reading, written_whole

if TYPE_CHECKING:
    from ...recordings.between import When


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "cut",
        help="save a part of a recording, or merge several by time",
        description="Write what was recorded between two times to a new pcapng file, with what the "
        "robots had answered before, so that it can be read alone. Several recordings, such as "
        "those of a fleet, are merged by time.",
    )
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path, help="pcapng or pcap files")
    parser.add_argument("-o", "--output", metavar="OUT", type=Path, required=True)
    add_times(parser)
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_json(parser, "print JSON")
    parser.set_defaults(run=run)


def add_times(parser: argparse.ArgumentParser) -> None:
    """Add `--from` and `--to`."""
    for name, attribute, which in (("--from", "begin", "from"), ("--to", "end", "to before")):
        parser.add_argument(
            name,
            dest=attribute,
            metavar="TIME",
            type=_time,
            help=f"{which} this time: seconds or [H:]M:S after the beginning, or UTC such as "
            "2026-05-01T12:30:00",
        )


def _time(text: str) -> When:
    from ...recordings.between import when

    try:
        return when(text)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is no time: give seconds, [H:]M:S, or UTC such as 2026-05-01T12:30:00"
        ) from None


def run(options: Options) -> int:
    """Cut and merge."""
    from ...recordings.between import cut

    for file in options.files:
        check_new(options.output, options.force, file)
    with written_whole(options.output) as path:
        # Each error names its file.
        with reading(options.files[0]), path.open("wb") as target:
            datagrams, answers = cut(options.files, target, options.begin, options.end)
        if not datagrams:
            raise usage("nothing was recorded between these times: see roburoc4 report")
    if options.json:
        print_json({"file": str(options.output), "datagrams": datagrams, "answers": answers})
    else:
        earlier = f", and {answers} earlier requests and answers" if answers else ""
        print(f"{options.output}: {datagrams} datagrams{earlier}")
    return ExitCode.FINE
