# SPDX-License-Identifier: MIT
"""Measure the codec beside its peers: time by Google Benchmark, instructions by callgrind."""

import json
import pathlib
import re
import tempfile

import figures

CALLS_COUNTED = 1000
ABOUT_TIME = (
    "Nanoseconds of processor time a message, through a function pointer: median of the "
    "repetitions, and its 95 % interval. Decoding ends with every value in a plain "
    "struct. `memcpy` only moves the same bytes, and checks nothing. MAVLink also "
    "frames, computes a checksum, and parses byte by byte as from a serial line; LCM prefixes a "
    "type hash; nanopb writes tagged variable-length integers."
)
ABOUT_COUNT = (
    "The same calls in machine instructions, counted by callgrind (less those of a call that does "
    "nothing), which do not depend on what else the machine does."
)


def versions(build):
    """Return the versions of compiler and peers."""
    found = [figures.compiler(build)]
    for package in ("liblcm-dev", "libbenchmark-dev", "valgrind"):
        found.append(figures.packaged(package))
    return found + figures.pinned("nanopb", "pymavlink")


MESSAGES = ("iocard", "telemeter", "battery", "localization", "differential", "drive")


def place(name):
    """Sort key of rows: decoding first, messages in the manual's order."""
    direction, message, peer = name
    return direction != "decode", MESSAGES.index(message), peer


def add_all(part, unit, values):
    """Add values: (direction, message, peer) -> value, low, high."""
    for direction, message, peer in sorted(values, key=place):
        value, low, high = values[direction, message, peer]
        more = {"low": low, "high": high} if low != high else {}
        part.add(f"{direction} {message}", peer, unit, value, **more)


def measure_time(build, quick):
    options = ["--benchmark_format=json", "--benchmark_enable_random_interleaving=true"]
    options += (
        ["--benchmark_min_time=0.001"]
        if quick
        else ["--benchmark_min_time=0.02", "--benchmark_repetitions=21"]
    )
    runs = json.loads(figures.run(build / "bin/codec_bench", *options))["benchmarks"]
    samples = {}
    for one in runs:
        if one["run_type"] == "iteration":
            samples.setdefault(tuple(one["name"].split("/")), []).append(one["cpu_time"])
    values = {}
    for name, times in samples.items():
        values[name] = [round(t, 2) for t in figures.median_interval(times)]
    return values


def measure_instructions(build):
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "count"
        figures.run(
            "valgrind",
            "-q",
            "--tool=callgrind",
            f"--callgrind-out-file={out}",
            build / "bin/codec_count",
        )
        for profile in pathlib.Path(folder).iterdir():
            text = profile.read_text(encoding="utf-8")
            trigger = re.search(r"^desc: Trigger: Client Request: (.*)$", text, re.MULTILINE)
            if trigger:
                total = int(re.search(r"^(?:summary|totals): (\d+)", text, re.MULTILINE).group(1))
                counts[tuple(trigger.group(1).split("/"))] = total / CALLS_COUNTED
    calls = {d: counts.pop((d, "nothing", "call")) for d in ("encode", "decode")}
    return {name: [round(n - calls[name[0]], 1)] * 3 for name, n in counts.items()}


def main():
    given = figures.arguments(__doc__)
    tools = versions(given.build)
    time = figures.Part("codec", "Codec: time", ABOUT_TIME, tools)
    add_all(time, "ns", measure_time(given.build, given.quick))
    time.write(given.out)
    count = figures.Part("instructions", "Codec: instructions", ABOUT_COUNT, tools)
    add_all(count, "instructions", measure_instructions(given.build))
    count.write(given.out)


if __name__ == "__main__":
    main()
