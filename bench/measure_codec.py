# SPDX-License-Identifier: MIT
"""Measure the codec beside its peers."""

import json

import figures

ABOUT = (
    "Nanoseconds of processor time a message, through a function pointer: median of the "
    "repetitions, and its 95 % interval. Decoding ends with every value in a plain "
    "struct. `memcpy` only moves the same bytes, and checks nothing. MAVLink also "
    "frames, computes a checksum, and parses byte by byte as from a serial line; LCM prefixes a "
    "type hash; nanopb writes tagged variable-length integers."
)


def versions(build):
    """Return the versions of compiler and peers."""
    found = [figures.compiler(build)]
    for package in ("liblcm-dev", "libbenchmark-dev"):
        found.append(figures.packaged(package))
    return found + figures.pinned("nanopb", "pymavlink")


MESSAGES = ("iocard", "differential")


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


def main():
    given = figures.arguments(__doc__)
    part = figures.Part("codec", "Codec", ABOUT, versions(given.build))
    add_all(part, "ns", measure_time(given.build, given.quick))
    part.write(given.out)


if __name__ == "__main__":
    main()
