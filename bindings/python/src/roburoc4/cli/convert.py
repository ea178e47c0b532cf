# SPDX-License-Identifier: MIT
"""`roburoc4 convert`: a recording in another form."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import ExitCode, refused, usage
from .options import Options, add_json
from .output import note, print_json
from .progress import progress
from .recover import check_new
from .report import add_recorded, opened

if TYPE_CHECKING:
    from roburoc4 import RecordedRobot

    from .progress import Show

_SHOW_EVERY = 5000


class ConvertOptions(Options):
    """What `convert` is given."""

    file: Path
    output: Path
    recorded: str | None
    force: bool


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "convert",
        help="convert a recording",
        description="Convert a recording (pcapng or pcap) by the suffix of OUT: .mcap (ROS 2 "
        "messages, for Foxglove, PlotJuggler and ros2 bag), .csv (statuses as columns), or .pcapng "
        "(only the robot's datagrams, without Ethernet, VLAN tags and fragments).",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a pcapng or pcap file")
    parser.add_argument("output", metavar="OUT", type=Path, help="its suffix says what it becomes")
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_recorded(parser)
    add_json(parser, "print JSON")
    parser.set_defaults(run=run)


def run(options: ConvertOptions) -> int:
    """Convert it."""
    suffix = options.output.suffix.lower()
    if suffix not in _FORMS:
        raise usage(f"{options.output}: give a name that ends in {', '.join(_FORMS)}")
    check_new(options.output, options.force)
    with opened(options.file, options.recorded) as recording:
        size = options.file.stat().st_size
        what, convert = _FORMS[suffix]
        if options.output.exists() and options.output.samefile(options.file):
            raise usage(f"{options.output} is the recording itself: give another name")
        try:
            with progress("converting", size / 1e6, "MB") as show:
                count, cut = convert(recording, options.output, show)
        except OSError as error:
            options.output.unlink(missing_ok=True)
            raise refused(
                f"{options.output} cannot be written ({error.strerror}): make room, or give "
                "another name"
            ) from None
    if cut:
        note(f"{options.file} is cut: all that is whole was converted")
    if options.json:
        print_json({"file": str(options.output), what: count, "cut_bytes": cut})
    else:
        print(f"{options.output}: {count} {what}")
    return ExitCode.FINE


def _to_mcap(recording: RecordedRobot, output: Path, show: Show) -> tuple[int, int]:
    from roburoc4.rosbag import RosBag

    reading = recording.read()
    with output.open("wb") as file:
        bag = RosBag(file, reading.robot, recording.address)
        for count, item in enumerate(reading.items()):
            bag.add(item)
            if count % _SHOW_EVERY == 0:
                show(reading.capture.position / 1e6, "converting")
        bag.finish()
    return bag.messages, reading.capture.cut


def _to_csv(recording: RecordedRobot, output: Path, show: Show) -> tuple[int, int]:
    from roburoc4 import Command, RecordedEvent

    from .record import Sheet
    from .rows import Rows, columns

    reading, rows = recording.read(), Rows()
    items = reading.items()
    first = next((item for item in items if not isinstance(item, Command | RecordedEvent)), None)
    with Sheet(output, columns(reading.robot.properties)) as sheet:
        if first is not None:
            sheet.write(rows.add(first))
        for count, item in enumerate(items):
            if not isinstance(item, Command | RecordedEvent):
                sheet.write(rows.add(item))
            if count % _SHOW_EVERY == 0:
                show(reading.capture.position / 1e6, "converting")
        sheet.write(rows.rest())
    return sheet.rows, reading.capture.cut


def _to_pcapng(recording: RecordedRobot, output: Path, show: Show) -> tuple[int, int]:
    from roburoc4.capture import Capture, RawWriter

    robot, capture = recording.head.robot, Capture(recording.path)
    with output.open("wb") as file:
        writer = RawWriter(file)
        for count, datagram in enumerate(capture):
            if robot in (datagram.source, datagram.destination):
                writer.add(datagram, inbound=datagram.source == robot)
            if count % _SHOW_EVERY == 0:
                show(capture.position / 1e6, "converting")
    return writer.datagrams, capture.cut


_FORMS: dict[str, tuple[str, Callable[[Any, Path, Any], tuple[int, int]]]] = {
    ".mcap": ("messages", _to_mcap),
    ".csv": ("rows", _to_csv),
    ".pcapng": ("datagrams", _to_pcapng),
}
