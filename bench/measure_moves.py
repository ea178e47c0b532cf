# SPDX-License-Identifier: MIT
"""Measure how well moves end, on the simulated robot in virtual time."""

import figures

ABOUT = (
    "The worst of 20 drives each, on the simulated robot in virtual time. The *profile* is "
    "constant acceleration (0.5 m/s², 1 rad/s²), speed and braking; the *robot's response* adds "
    "the 0.64 s by which its speed lags behind the target. *With slip*: the "
    "measured 12 % of each turn. *Really* is where the robot was, not what its odometry reported."
)
AIMS = {
    ("straight metre", "error"): 10,
    ("quarter turn", "error"): 1,
    ("straight metre", "overshoot"): 2,
    ("quarter turn", "overshoot"): 2,
    ("straight metre", "time by that of the profile and the robot's response"): 1.1,
    ("quarter turn", "time by that of the profile and the robot's response"): 1.1,
}
AIMS_LOST = {("straight metre", "error"): 30, ("quarter turn", "error"): 2}


def aim_of(name, figure):
    kind = name.split(" at ")[0]
    if name.startswith("square of 2 m, closes"):
        return 50
    if "lost" in name:
        return AIMS_LOST.get((kind, figure))
    return AIMS.get((kind, figure))


def main():
    given = figures.arguments(__doc__)
    versions = [figures.compiler(given.build)]
    part = figures.Part("moves", "Moves on the simulator", ABOUT, versions)
    for line in figures.run(given.build / "bin/moves").splitlines():
        name, figure, unit, value = line.split("\t")
        part.add(f"{name}: {figure}", "roburoc4", unit, float(value), aim=aim_of(name, figure))
    part.write(given.out)


if __name__ == "__main__":
    main()
