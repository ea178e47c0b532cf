# SPDX-License-Identifier: MIT
"""Measure a day of recording: its size, and what it costs to read it.

Runs in the virtual environment of scripts/bench, where the package is installed from its wheel.
"""

import math
import pathlib
import resource
import struct
import sys
import tempfile

import figures

from roburoc4_tools.recordings.capture import Datagram, RawWriter

ABOUT = (
    "A robot that sends 71 statuses a second, as the library subscribes by default, recorded for a "
    "day, written in virtual time. *Read* gives every status as a typed record, and runs a client "
    "on the recording for its events. *tcpdump* only copies the file. Seconds are processor time "
    "of a whole process."
)
ROBOT, CLIENT = (b"\xc0\xa8\x00\x02", 60000), (b"\xc0\xa8\x00\x05", 40001)
BEGIN_US = 1_700_000_000_000_000
READ = (
    "import sys; from roburoc4_tools.recordings import open_recording; "
    "sum(1 for _ in open_recording(sys.argv[1]).items())"
)


def statuses(cycles):
    """Statuses of one cycle of a robot that drives in a circle."""
    angle = cycles / 200
    if cycles % 5 == 0:
        volts = 25 - cycles / 1e7
        yield struct.pack("<BHQ9f3s", 0xFF, 2, cycles, 0, 0, volts, *(0,) * 6, bytes(3))
        place = math.sin(angle), math.cos(angle), angle
        yield struct.pack("<BHQ3dI", 0xFF, 5, cycles, *place, 4)
        yield struct.pack("<BHQ4f", 0xFF, 6, cycles, 0.5, 0.49 + angle % 0.02, 0.5, 0.5)
    if cycles % 10 == 0:
        yield struct.pack("<BHQ2f", 0xFF, 3, cycles, 2 + angle % 1, 3)
    if cycles % 100 == 0:
        yield struct.pack("<BHQBB", 0xFF, 4, cycles, 2, 100 - cycles * 90 // 8_640_000)


def write(path, hours):
    """Write a recording."""
    with path.open("wb") as file:
        writer = RawWriter(file)
        for cycles in range(0, round(hours * 360_000), 5):
            for data in statuses(cycles):
                time_us = BEGIN_US + cycles * 10_000
                writer.add(Datagram(time_us, ROBOT, CLIENT, data, None), inbound=True)


def child_s(*command):
    """Run a command; return its processor seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    figures.run(*command)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    given = figures.arguments(__doc__)
    hours = 0.2 if given.quick else 24
    name = f"{hours} h"
    versions = [f"Python {sys.version.split()[0]}", figures.packaged("tcpdump")]
    part = figures.Part("recording", "Recordings", ABOUT, versions)
    with tempfile.TemporaryDirectory(dir=given.build) as folder:
        path = pathlib.Path(folder) / "day.pcapng"
        write(path, hours)
        for subject, *command in (
            ("roburoc4", sys.executable, "-c", READ, path),
            ("tcpdump", "tcpdump", "-r", path, "-w", path.with_suffix(".pcap")),
        ):
            part.add(f"{name}: read", subject, "s", child_s(*command))
        part.add(f"{name}: size", "roburoc4", "MB", path.stat().st_size / 1e6)
    part.write(given.out)


if __name__ == "__main__":
    main()
