# SPDX-License-Identifier: MIT
"""`roburoc4 recover`: saves what is complete in a truncated or damaged recording."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from ..errors import ExitCode, refused, usage
from ..options import Options, add_json
from ..output import print_json
from ..progress import progress


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "recover",
        help="save what is complete in a damaged recording",
        description="Copy everything complete from a pcapng, pcap, MCAP or CSV file after its "
        "program was killed or the disk was full, to another file.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="the recording; it is not changed")
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        type=Path,
        help="where to write it (default: with .recovered before the suffix of FILE)",
    )
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_json(parser, "print JSON")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Recover it."""
    from roburoc4 import RecordingError

    from ...recordings.repair import recover

    source = options.file
    output = options.output or source.with_name(f"{source.stem}.recovered{source.suffix}")
    check_new(output, options.force, source)
    try:
        size = source.stat().st_size
        with (
            output.open("wb") as target,
            progress("recovering", size / 1e6, "MB") as show,
        ):
            found = recover(source, target, lambda done: show(done / 1e6, "recovering"))
    except RecordingError as error:
        output.unlink(missing_ok=True)
        raise refused(str(error)) from None
    except OSError as error:
        raise unusable(error) from None
    if options.json:
        print_json({"file": str(output), **found._asdict()})
    else:
        names = {".csv": "rows", ".mcap": "messages"}
        what = names.get(source.suffix.lower(), "datagrams")
        left = f"; {found.left_out} bytes were not usable" if found.left_out else ""
        print(f"{output}: {found.packets} {what}{left}")
    return ExitCode.FINE


def check_new(path: Path, force: bool, source: Path | None = None) -> None:
    """End the command if a file would be replaced without --force, or the recording itself."""
    # Those of os.path return False for a name that is too long; opening it reports the reason.
    exists = os.path.exists(path)
    if exists and source and os.path.exists(source) and path.samefile(source):
        raise usage(f"{path} is the recording itself: give another name")
    if exists and not force and path.is_file() and path.stat().st_size > 0:
        raise usage(f"{path} exists: give another name, or --force to replace it")


def unusable(error: OSError) -> Exception:
    """Report which file cannot be used, and what to do."""
    return usage(f"{error.filename} cannot be used ({error.strerror}): give another name")
