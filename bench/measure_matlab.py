# SPDX-License-Identifier: MIT
"""Measure what a call from Octave costs: keep the figures that bench/matlab prints."""

import re

import figures

ABOUT = (
    "Microseconds a call from GNU Octave, by `bench/matlab`: median of 300 rounds of "
    "20 calls, with a simulated robot on a port of this machine."
)
ROW = re.compile(r"^(\S.*?) {2,}(\d+\.\d) +(\d+\.\d)(?: +(\d+))? *$", re.MULTILINE)


def main():
    given = figures.arguments(__doc__)
    part = figures.Part(
        "matlab", "MATLAB and Octave", ABOUT, [figures.first_line("octave-cli", "--version")]
    )
    rows = ROW.findall(figures.run(figures.BENCH / "matlab", given.build))
    if not rows:
        raise SystemExit("measure_matlab: bench/matlab printed no figures")
    for name, fastest, median, aim in rows:
        part.add(
            name,
            "roburoc4",
            "us",
            float(median),
            aim=float(aim) if aim else None,
            note=f"fastest {fastest}",
        )
    part.write(given.out)


if __name__ == "__main__":
    main()
