# SPDX-License-Identifier: MIT
"""Measure how well moves end, on robots of the family and on the simulator, in virtual time."""

import figures

ABOUT = (
    "*Family*: a metre or a quarter turn on each of 7,488 robots that the manual allows "
    "(`tests/support/family.c`). A move is *fine* if it ends as reached within 2 cm and 2°, turns "
    "back at most twice, overshoots by at most 5 cm and 5°, takes at most twice the time of the "
    "profile and that robot's response, and never accelerates faster than asked. The others are "
    "the nominal robot, the worst of 20, and squares on the simulator. *With slip*: the assumed"
    " 12 % of each turn. *Really* is where the robot was, not what its odometry reported."
)
FINE = "moves that are fine"
AIMS = {
    ("straight metre", "error"): 10,
    ("quarter turn", "error"): 1,
    ("straight metre", "overshoot"): 2,
    ("quarter turn", "overshoot"): 2,
    ("straight metre", "time by that of the profile and the robot's response"): 1.1,
    ("quarter turn", "time by that of the profile and the robot's response"): 1.1,
}


def aim_of(name, figure):
    if figure == FINE:
        return 100
    if name.startswith("square of 2 m, closes"):
        return 50
    return AIMS.get((name.split(" at ")[0], figure))


def main():
    given = figures.arguments(__doc__)
    versions = [figures.compiler(given.build)]
    part = figures.Part("moves", "Moves", ABOUT, versions)
    for line in figures.run(given.build / "bin/moves").splitlines():
        name, figure, unit, value = line.split("\t")
        better = "higher" if figure == FINE else "lower"
        part.add(
            f"{name}: {figure}",
            "roburoc4",
            unit,
            float(value),
            aim=aim_of(name, figure),
            better=better,
        )
    part.write(given.out)


if __name__ == "__main__":
    main()
