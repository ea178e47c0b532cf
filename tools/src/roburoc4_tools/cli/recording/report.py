# SPDX-License-Identifier: MIT
"""`roburoc4 report`: shows a recording as a page or as figures."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ExitCode, refused, unwritable, usage
from ..options import Options, add_json
from ..output import note, print_json
from ..progress import progress
from .recover import check_new

if TYPE_CHECKING:
    from ...recordings import RecordedRobot


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "report",
        help="show a recording as a page",
        description="Write one HTML page, which needs no network: path, speeds, battery, "
        "distances, inputs, link, and every event with its time.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a pcapng or pcap file")
    parser.add_argument(
        "-o", "--output", metavar="OUT.html", type=Path, help="the page (default: FILE.html)"
    )
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_recorded(parser)
    add_json(parser, "print the figures instead; a page only with -o")
    parser.set_defaults(run=run)


def add_recorded(parser: argparse.ArgumentParser) -> None:
    """Add `--robot`, which here selects a robot of the recording."""
    parser.add_argument(
        "--robot",
        dest="recorded",
        metavar="HOST[:PORT]",
        help="the robot, if the recording has several",
    )


def run(options: Options) -> int:
    """Read the recording, and write the page."""
    from ...report.figures import Figures
    from ...report.page import page

    output = options.output or options.file.with_name(options.file.name + ".html")
    writes = options.output is not None or not options.json
    if writes:
        check_new(output, options.force, options.file)
    with opened(options.file, options.recorded) as recording:
        figures = Figures(recording)
        size = options.file.stat().st_size
        with progress("reading", size / 1e6, "MB") as show:
            figures.read(lambda done: show(done / 1e6, "reading"))
    document = figures.document()
    if document["cut_bytes"]:
        note(f"{options.file} is truncated: everything before that was read")
    if options.json:
        print_json(document)
    if writes:
        with written_whole(output) as path:
            path.write_bytes(page(figures).encode())
    if not options.json:
        events = len(document["events"]) + document["more_events"]
        print(f"{output}: {events:,} events in {document['seconds']:.1f} s")
    return ExitCode.FINE


@contextmanager
def opened(path: Path, robot: str | None) -> Iterator[RecordedRobot]:
    """Open a recording; end the command with one line if it cannot be read."""
    from ...recordings import open_recording

    with reading(path):
        yield open_recording(path, robot)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """End the command with one line if this file cannot be read."""
    from roburoc4 import RecordingError, Result

    try:
        yield
    except RecordingError as error:
        if error.code is Result.SYSTEM:
            raise usage(f"{error}: give another name") from None
        raise refused(str(error)) from None
    except OSError as error:
        if error.filename is None or Path(os.fspath(error.filename)) != path:
            raise
        raise usage(f"{path} cannot be read ({error.strerror}): give another name") from None


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Give a name to write to; it becomes the file at the end, and is deleted after an error."""
    if os.path.exists(path) and not path.is_file():  # a device would become a file
        raise usage(f"{path} is not a file: give another name")
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise unwritable(path, error) from None
    os.close(handle)
    try:
        yield Path(name)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    except OSError as error:
        if error.filename not in (None, name):
            raise
        raise refused(
            f"{path} cannot be written ({error.strerror}): free some space, or give another name"
        ) from None
    finally:
        with suppress(OSError):
            os.unlink(name)
