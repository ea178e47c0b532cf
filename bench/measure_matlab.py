#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Octave costs: the figures that bench/matlab prints, kept."""

import argparse
import pathlib
import re

import figures

ABOUT = (
    "Microseconds a call from GNU Octave, by `bench/matlab`: median, and fastest, of 300 rounds of "
    "20 calls, with a simulated robot on a port of this machine.")
ROW = re.compile(r"^(\S.*?) {2,}(\d+\.\d) +(\d+\.\d)(?: +(\d+))? *$", re.M)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="has the MEX file")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true", help="says so in the figures, no more")
    given = parser.parse_args()
    part = figures.Part("matlab", "MATLAB and Octave", ABOUT,
                        [figures.first_line("octave-cli", "--version")])
    rows = ROW.findall(figures.run(figures.BENCH / "matlab", given.build))
    if not rows:
        raise SystemExit("measure_matlab: bench/matlab printed no figures")
    for name, fastest, median, aim in rows:
        part.add(name, "roburoc4", "us", float(median), low=float(fastest), high=float(median),
                 aim=float(aim) if aim else None)
    part.write(given.out)


if __name__ == "__main__":
    main()
