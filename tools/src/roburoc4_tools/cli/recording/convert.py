# SPDX-License-Identifier: MIT
"""`roburoc4 convert`: converts recordings."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ...recordings.rows import Rows, columns
from ..errors import ExitCode, usage
from ..options import Options, add_json
from ..output import note, print_json
from ..progress import progress
from .recover import check_new
from .report import add_recorded, reading, written_whole

if TYPE_CHECKING:
    from roburoc4 import Robot

    from ...recordings import RecordedRobot
    from ...recordings.rows import Cell
    from ...ros.topics import Item
    from ..progress import Show

_SHOW_EVERY = 5000
_COUNTED = {".mcap": "messages", ".csv": "rows", ".pcapng": "datagrams"}
_MISSING = {
    ".csv": "a CSV file has no commands, events, properties or names of inputs: /cmd_vel_sent, "
    "/diagnostics, /pad/joy, the battery's voltage, limits and poses of telemeters are left out",
    ".mcap": "an MCAP file has no robot_s, robot_cycles, localization_flags, battery_state or "
    "inputs of the IO card by index: these columns are left out",
}
_NOT_IN_MCAP = ("robot_s", "robot_cycles", "localization_flags", "battery_state")
_T = TypeVar("_T")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "convert",
        help="convert a recording",
        description="Convert a recording to the format of OUT's suffix: .mcap (ROS 2 messages, for "
        "Foxglove, PlotJuggler and ros2 bag), .csv (statuses as columns), or .pcapng (only the "
        "robot's datagrams, without Ethernet, VLAN tags and fragments). A CSV file can become MCAP "
        "and an MCAP file CSV; neither has the datagrams that a pcapng file consists of.",
    )
    parser.add_argument(
        "file",
        metavar="FILE",
        type=Path,
        help="a pcapng or pcap file, or a .csv or .mcap file by roburoc4",
    )
    parser.add_argument("output", metavar="OUT", type=Path, help="its suffix chooses the format")
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_recorded(parser)
    add_json(parser, "print JSON")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Convert it."""
    suffix = options.output.suffix.lower()
    if suffix not in _COUNTED:
        raise usage(f"{options.output}: give a name that ends in {', '.join(_COUNTED)}")
    convert = _of_capture
    if options.file.suffix.lower() in _MISSING:
        _check_statuses(options)
        convert = _of_statuses
    check_new(options.output, options.force, options.file)
    with reading(options.file):
        size = options.file.stat().st_size
        with (
            written_whole(options.output) as path,
            progress("converting", size / 1e6, "MB") as show,
        ):
            count, cut = convert(options, path, show)
    if cut:
        note(f"{options.file} is truncated: everything before that was converted")
    if options.json:
        print_json({"file": str(options.output), _COUNTED[suffix]: count, "cut_bytes": cut})
    else:
        print(f"{options.output}: {count} {_COUNTED[suffix]}")
    return ExitCode.FINE


def _check_statuses(options: Options) -> None:
    """Reject conversions that need more than statuses."""
    source, suffix = options.file.suffix.lower(), options.output.suffix.lower()
    if suffix == ".pcapng":
        raise usage(
            f"{options.file} holds statuses, not the datagrams that a pcapng file consists of: "
            "convert a recording that roburoc4 record FILE.pcapng made"
        )
    if suffix == source:
        raise usage(f"{options.file} already is such a file: copy it")
    if options.recorded is not None:
        raise usage(f"--robot: {options.file} holds only one robot: omit --robot")


def _of_statuses(options: Options, output: Path, show: Show) -> tuple[int, int]:
    """Convert a CSV file to MCAP, or the reverse."""
    from ...recordings import rows
    from ...ros import rosbag

    source = options.file.suffix.lower()
    with options.file.open("rb") as file:
        statuses = (rows if source == ".csv" else rosbag).statuses(options.file, file)
        items = _shown(statuses, file.tell, show)
        if source == ".csv":
            count = _write_mcap(items, output, None, "")
        else:
            count = _write_csv(items, output, _columns_of_mcap)
    note(_MISSING[source])
    return count, 0


def _of_capture(options: Options, output: Path, show: Show) -> tuple[int, int]:
    from ...recordings import open_recording

    recording = open_recording(options.file, options.recorded)
    suffix = options.output.suffix.lower()
    if suffix == ".pcapng":
        return _to_pcapng(recording, output, show)
    reading = recording.read()
    items = _shown(reading.items(), lambda: reading.capture.position, show)
    if suffix == ".mcap":
        count = _write_mcap(items, output, reading.robot, recording.address)
    else:
        count = _write_csv(items, output, lambda: columns(reading.robot.properties))
    return count, reading.capture.cut


def _shown(items: Iterable[_T], position: Callable[[], int], show: Show) -> Iterator[_T]:
    for count, item in enumerate(items):
        if count % _SHOW_EVERY == 0:
            show(position() / 1e6, "converting")
        yield item


def _write_mcap(items: Iterable[Item], output: Path, robot: Robot | None, address: str) -> int:
    from ...ros.rosbag import RosBag

    with output.open("wb") as file:
        bag = RosBag(file, robot, address)
        for item in items:
            bag.add(item)
        bag.finish()
    return bag.messages


def _write_csv(items: Iterable[Item], output: Path, header: Callable[[], list[str]]) -> int:
    rows = _rows(items)
    first = next(rows, None)  # before it, the robot's properties are not known
    count = 0
    with output.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, header(), extrasaction="ignore")
        writer.writeheader()
        for row in chain([first] if first else [], rows):
            writer.writerow(row)
            count += 1
    return count


def _rows(items: Iterable[Item]) -> Iterator[dict[str, Cell]]:
    from ...recordings import Command, RecordedEvent

    rows = Rows()
    for item in items:
        if not isinstance(item, Command | RecordedEvent):
            yield from rows.add(item)
    yield from rows.rest()


def _columns_of_mcap() -> list[str]:
    return [name for name in columns() if name not in _NOT_IN_MCAP]


def _to_pcapng(recording: RecordedRobot, output: Path, show: Show) -> tuple[int, int]:
    from ...recordings.capture import Capture, RawWriter

    robot, capture = recording.head.robot, Capture(recording.path)
    with output.open("wb") as file:
        writer = RawWriter(file)
        for datagram in _shown(capture, lambda: capture.position, show):
            if robot in (datagram.source, datagram.destination):
                writer.add(datagram, inbound=datagram.source == robot)
    return writer.datagrams, capture.cut
