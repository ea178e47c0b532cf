# SPDX-License-Identifier: MIT
"""Measure a day of recording: its size, and what it costs to read, report and convert it.

Runs in the virtual environment of scripts/bench, where the package is installed from its wheel.
"""

import math
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import time

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


def child(*command):
    """Run a command; return its processor seconds and its peak memory in MB."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun_s = time.monotonic()
    process = subprocess.Popen(
        [str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    most_kb = 0
    status = pathlib.Path(f"/proc/{process.pid}/status")
    while process.poll() is None:
        time.sleep(0.05)
        try:
            text = status.read_text(encoding="utf-8")
        except OSError:
            continue
        peak = [line.split()[1] for line in text.splitlines() if line.startswith("VmHWM")]
        most_kb = max([most_kb, *map(int, peak)])
    if process.returncode:
        raise RuntimeError(f"{command} ended with {process.returncode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return min(seconds, time.monotonic() - begun_s), most_kb / 1e3


def main():
    given = figures.arguments(__doc__)
    hours = 0.2 if given.quick else 24
    name = f"{hours} h"
    roburoc4 = pathlib.Path(sys.executable).with_name("roburoc4")
    versions = [f"Python {sys.version.split()[0]}", figures.packaged("tcpdump")]
    part = figures.Part("recording", "Recordings", ABOUT, versions)
    with tempfile.TemporaryDirectory(dir=given.build) as folder:
        path, out = pathlib.Path(folder) / "day.pcapng", pathlib.Path(folder) / "out"
        write(path, hours)
        for subject, what, *command in (
            ("roburoc4", "read", sys.executable, "-c", READ, path),
            ("tcpdump", "read", "tcpdump", "-r", path, "-w", f"{out}.pcap"),
            ("roburoc4", "report", roburoc4, "report", path, "--force", "-o", f"{out}.html"),
        ):
            seconds, memory = child(*command)
            part.add(f"{name}: {what}", subject, "s", seconds)
            part.add(f"{name}: {what}, memory", subject, "MB", memory)
        part.add(f"{name}: size", "roburoc4", "MB", path.stat().st_size / 1e6)
    part.write(given.out)


if __name__ == "__main__":
    main()
