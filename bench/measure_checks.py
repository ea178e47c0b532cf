# SPDX-License-Identifier: MIT
"""Measure what `explore` goes through in how long, and the firmware that drives over Ethernet."""

import re

import figures

ABOUT = (
    "*Histories*: every sequence of so many events, from several situations, of which no promise "
    "of SAFETY may be broken (`explore`, one core, gcc -O2). *Board*: the firmware of "
    "docs/firmware.md with lwIP, which drives in QEMU (`scripts/test-board`)."
)


def main():
    given = figures.arguments(__doc__)
    part = figures.Part("checks", "Histories and board", ABOUT, [figures.compiler(given.build)])
    short = ["--depth", "3"] if given.quick else []
    explored = figures.run(given.build / "tests/bin/explore", *short)
    total = re.search(r"^(\S+) histories, \S+ steps, (\d+) s: no promise", explored, re.MULTILINE)
    part.add("histories explored", "roburoc4", "million", float(total[1]) / 1e6)
    part.add("that takes", "roburoc4", "s", int(total[2]))
    board = figures.run(figures.TOP / "scripts/test-board", timeout=3600)
    for name, flash in re.findall(r"^(Cortex.*): (\d+) bytes of flash", board, re.MULTILINE):
        part.add(f"{name}: flash", "roburoc4", "bytes", int(flash))
    part.write(given.out)


if __name__ == "__main__":
    main()
