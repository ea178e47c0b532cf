# SPDX-License-Identifier: MIT
"""Measure the Python package beside other Python libraries.

Runs in the virtual environment of scripts/bench, where the package is installed from its wheel.
"""

import argparse
import collections
import importlib.metadata
import pathlib
import struct
import subprocess
import sys
import time
import timeit

import figures

ABOUT = (
    "Microseconds: median of the repetitions, and its 95 % interval, of one interpreter thread. "
    "All decode the same differential status to an object with typed fields, except `struct`, "
    "which gives a plain tuple. `lcm`, `construct` (compiled) and "
    "`pymavlink` decode their own form of the same fields. *Batch*: roburoc4 checks each status, "
    "and reports the bad ones; NumPy (`frombuffer`, which needs one buffer: a list is joined "
    "first) copies the bytes and checks nothing; `struct` makes a tuple of each. drive() is "
    "of a robot that is connected to a simulator over UDP, with the pump "
    "running. *Installed* is every file of the distribution but bytecode."
)
LAYOUT = struct.Struct("<BHQ4f")
Tuple = collections.namedtuple(
    "Tuple",
    "header service robot_cycles target_linear_m_s current_linear_m_s "
    "target_angular_rad_s current_angular_rad_s",
)
WIRE = LAYOUT.pack(0xFF, 6, 123456, 1.0, 0.75, -0.5, -0.25)
AIM_US = 0.6
BATCH = 100_000


class Timer:
    def __init__(self, quick):
        self.repetitions = 3 if quick else 15
        self.seconds = 0.005 if quick else 0.05

    def us(self, work):
        """Return the median microseconds of a call, and its interval."""
        timer = timeit.Timer(work)
        number = 1
        while timer.timeit(number) < self.seconds:
            number *= 2
        times = [t / number * 1e6 for t in timer.repeat(self.repetitions, number)]
        return [round(t, 4) for t in figures.median_interval(times)]


def add(part, name, subject, unit, found, **more):
    part.add(name, subject, unit, found[0], low=found[1], high=found[2], **more)


def peers(generated):
    """Return name -> function that decodes its own form of the same status."""
    import construct

    sys.path.insert(0, str(generated / "python"))
    import mavlink_peer
    from peer import differential_t

    form = construct.Struct(
        "header" / construct.Int8ul,
        "service" / construct.Int16ul,
        "robot_cycles" / construct.Int64ul,
        "target_linear_m_s" / construct.Float32l,
        "current_linear_m_s" / construct.Float32l,
        "target_angular_rad_s" / construct.Float32l,
        "current_angular_rad_s" / construct.Float32l,
    ).compile()

    message = differential_t()
    message.service, message.robot_cycles = 6, 123456
    message.target_linear_m_s, message.current_linear_m_s = 1.0, 0.75
    message.target_angular_rad_s, message.current_angular_rad_s = -0.5, -0.25
    lcm_wire = message.encode()

    mav = mavlink_peer.MAVLink(None)
    mav_wire = mav.differential_encode(6, 123456, 1.0, 0.75, -0.5, -0.25).pack(mav)

    return {
        "struct": lambda: LAYOUT.unpack(WIRE),
        "struct + namedtuple": lambda: Tuple._make(LAYOUT.unpack(WIRE)),
        "lcm": lambda: differential_t.decode(lcm_wire),
        "construct, compiled": lambda: form.parse(WIRE),
        "pymavlink": lambda: mav.decode(bytearray(mav_wire)),
    }


def check(name, decoded):
    cycles = decoded[2] if type(decoded) is tuple else decoded.robot_cycles
    if cycles != 123456:
        raise SystemExit(f"measure_python: {name} does not decode what went in")


def measure_decode(part, timer, generated):
    from roburoc4 import protocol

    ways = {"roburoc4": lambda: protocol.decode(WIRE), **peers(generated)}
    for name, work in ways.items():
        check(name, work())
        add(
            part,
            "decode to an object",
            name,
            "us",
            timer.us(work),
            **({"aim": AIM_US} if name == "roburoc4" else {}),
        )


def measure_batch(part, timer):
    import numpy

    from roburoc4 import protocol

    buffer = WIRE * BATCH
    datagrams = [bytes(bytearray(WIRE)) for _ in range(BATCH)]  # each an object of its own
    form = numpy.dtype(
        [("header", "u1"), ("service", "<u2"), ("robot_cycles", "<u8"), ("speeds", "<f4", (4,))]
    )
    copied = "NumPy frombuffer + copy"
    ways = {
        "batch decode, one buffer": {
            "roburoc4": lambda: protocol.decode_batch("differential", buffer),
            copied: lambda: numpy.frombuffer(buffer, form).copy(),
            "struct": lambda: list(LAYOUT.iter_unpack(buffer)),
        },
        "batch decode, a list of datagrams": {
            "roburoc4": lambda: protocol.decode_batch("differential", datagrams),
            copied: lambda: numpy.frombuffer(b"".join(datagrams), form).copy(),
            "struct": lambda: [LAYOUT.unpack(datagram) for datagram in datagrams],
        },
    }
    for name, subjects in ways.items():
        for subject, work in subjects.items():
            us, low, high = timer.us(work)
            rate = [round(BATCH / t, 1) for t in (us, high, low)]
            aim = {"aim": 20, "note": "each one checked"} if subject == "roburoc4" else {}
            add(part, name, subject, "million/s", rate, better="higher", **aim)


def measure_robot(part, timer):
    import roburoc4

    with roburoc4.Simulator(port=0) as simulator, simulator.connect() as robot:
        robot.arm()
        add(part, "drive()", "roburoc4", "us", timer.us(lambda: robot.drive(0.0, 0.0)))


def import_ms(module, path, repetitions):
    times = []
    for _ in range(repetitions):
        both = []
        for code in ("pass", f"import {module}"):
            begun = time.perf_counter()
            subprocess.run([sys.executable, "-c", code], check=True, cwd=path)
            both.append(time.perf_counter() - begun)
        times.append((both[1] - both[0]) * 1e3)
    return [round(t, 2) for t in figures.median_interval(times)]


def measure_imports(part, generated, quick):
    for module, name in (
        ("roburoc4", "roburoc4"),
        ("struct, collections", "struct + namedtuple"),
        ("lcm", "lcm"),
        ("construct", "construct, compiled"),
        ("mavlink_peer", "pymavlink"),
        ("numpy", "NumPy frombuffer + copy"),
    ):
        add(part, "import", name, "ms", import_ms(module, generated / "python", 2 if quick else 15))


def installed_kb(name):
    """Return the size of a distribution's files without the bytecode that pip makes."""
    files = importlib.metadata.files(name)
    if not files:
        raise SystemExit(f"measure_python: {name} has no list of its files")
    kept = [f.locate() for f in files if "__pycache__" not in f.parts]
    return round(sum(path.stat().st_size for path in kept if path.is_file()) / 1000)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--peers", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    versions = [
        f"Python {sys.version.split()[0]}",
        figures.first_line("cc", "--version"),
        *figures.pinned("construct", "lcm", "numpy", "pymavlink"),
    ]
    part = figures.Part("python", "Python", ABOUT, versions)
    timer = Timer(given.quick)
    measure_decode(part, timer, given.peers)
    measure_batch(part, timer)
    measure_robot(part, timer)
    measure_imports(part, given.peers, given.quick)
    for distribution, name in (
        ("roburoc4", "roburoc4"),
        ("lcm", "lcm"),
        ("construct", "construct, compiled"),
        ("pymavlink", "pymavlink"),
    ):
        part.add("installed", name, "kB", installed_kb(distribution))
    part.write(given.out)


if __name__ == "__main__":
    main()
