# SPDX-License-Identifier: MIT
"""Measure what roburoc4 adds to a bare recv/send loop over loopback, in interleaved pairs."""

import random

import figures

ABOUT = (
    "Each datagram goes through a bare, blocking `recv`/`send` loop and through the UDP "
    "adapter and client, one right after the other, in changing order; a status also through a "
    "bare loop with `ppoll` before its `recv`, which can wake in time to send a command. "
    "Microseconds from sending to the value (or the datagram) on the other side, which sleeps "
    "until it comes. Intervals: 95 %, by bootstrap over the "
    "rounds. Statuses a second: by processor time of one core for reading 64 that wait; quartiles."
)
BARE, WAITING = "bare loop", "bare ppoll loop"
RESAMPLINGS = 400
QUANTILES = (("p50", 0.5, 1.03), ("p99", 0.99, 1.10), ("p99.9", 0.999, None))


def quantile(ordered, share):
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def quantile_interval(samples, share, chance):
    """Return a quantile and its 95 % interval, by order statistics of resampled data."""
    ordered = sorted(samples)
    n = len(ordered)
    # The rank of a quantile in a resample is binomial, so it is enough to draw ranks.
    spread = (n * share * (1 - share)) ** 0.5
    ranks = sorted(int(chance.gauss(share * n, spread)) for _ in range(RESAMPLINGS))
    low, high = ranks[RESAMPLINGS // 40], ranks[-RESAMPLINGS // 40]
    at = [ordered[min(n - 1, max(0, r))] for r in (low, high)]
    return quantile(ordered, share), at[0], at[1]


def pairs_of(program, *arguments):
    rows = [line.split() for line in figures.run(program, *arguments).splitlines()]
    return [list(map(float, column)) for column in zip(*rows, strict=True)]


def ratio_interval(bare, own, share, chance):
    """Return our quantile divided by the bare one, and its interval by resampling pairs."""
    n = len(bare)
    ratios = []
    for _ in range(min(RESAMPLINGS, 200)):
        drawn = chance.choices(range(n), k=n)
        ratios.append(
            quantile(sorted(own[i] for i in drawn), share)
            / quantile(sorted(bare[i] for i in drawn), share)
        )
    ratios.sort()
    return (
        quantile(sorted(own), share) / quantile(sorted(bare), share),
        ratios[len(ratios) // 40],
        ratios[-1 - len(ratios) // 40],
    )


def add_latency(part, program, which, name, count):
    chance = random.Random(1)
    columns = pairs_of(program, which, count)
    bare, own = columns[0], columns[-1]
    subjects = (BARE, "roburoc4") if len(columns) == 2 else (BARE, WAITING, "roburoc4")
    if len(own) < count / 2:
        raise SystemExit(
            f"measure_loopback: only {len(own)} of {count} rounds came to an end: the "
            "machine is too busy"
        )
    for label, share, aim in QUANTILES:
        for subject, samples in zip(subjects, columns, strict=True):
            value, low, high = quantile_interval(samples, share, chance)
            part.add(
                f"{name}, {label}",
                subject,
                "us",
                round(value / 1000, 2),
                low=round(low / 1000, 2),
                high=round(high / 1000, 2),
                note=f"{len(own)} rounds" if label == "p50" else None,
            )
        if aim is None:
            continue
        peers = [("bare", bare, aim)]
        if len(columns) == 3:
            peers.append(("bare with ppoll", columns[1], None))
        for peer, samples, peer_aim in peers:
            value, low, high = ratio_interval(samples, own, share, chance)
            part.add(
                f"{name}, {label}, ratio to {peer}",
                "roburoc4",
                "×",
                round(value, 3),
                low=round(low, 3),
                high=round(high, 3),
                aim=peer_aim,
            )


def add_rate(part, program, rounds):
    columns = pairs_of(program, "rate", rounds)
    for subject, samples in zip(("bare recv", "roburoc4", "bare recvmmsg"), columns, strict=True):
        ordered = sorted(samples)
        value, low, high = (
            ordered[len(ordered) // 2],
            quantile(ordered, 0.25),
            quantile(ordered, 0.75),
        )
        part.add(
            "statuses a second on one core",
            subject,
            "1/s",
            round(1e9 / value),
            low=round(1e9 / high),
            high=round(1e9 / low),
            better="higher",
        )


def main():
    given = figures.arguments(__doc__)
    program = given.build / "bin/loopback"
    versions = [figures.compiler(given.build)]
    part = figures.Part("loopback", "End to end on loopback", ABOUT, versions)
    add_latency(part, program, "status", "status to value", 100 if given.quick else 20000)
    add_latency(part, program, "drive", "drive() to datagram", 20 if given.quick else 2000)
    add_rate(part, program, 20 if given.quick else 2000)
    part.write(given.out)


if __name__ == "__main__":
    main()
