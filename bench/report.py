# SPDX-License-Identifier: MIT
"""Write the sections of bench/RESULTS.md whose parts were measured, and leave the others."""

import argparse
import json
import pathlib
import re

import figures

MOST_LINES = 120
HEAD = """# Figures

Written by `scripts/bench` on an idle machine. Other machines give other figures: run it on yours.
[README.md](README.md) says how each part is measured. The × beside a peer's figure is that
figure divided by roburoc4's.
"""
# Part -> regular expression that matches the names of the rows that decide.
SHOWN = {
    "codec": "(de|en)code differential",
    "client_cost": ".*",
    "footprint": "firmware.*|the same.*|and without.*|a metre.*|a client's.*",
    "footprint_peers": ".*",
    "checks": "histories.*|that takes|.*lwIP.*",
    "python": "decode to an object|batch decode, one.*|import|installed",
    "matlab": ".*",
    "lcm": ".*",
    "ros2": ".*",
    "dashboard": ".*",
    "moves": ".*: moves that are fine|square.* by .*without.*",
    "recording": ".*",
}

# Row -> why an aim that was missed more than once is not pursued.
REASONS = {
    "receive a differential status": "a lapse is noticed before what it shows",
    "receive an IO card's status": "it decides about driving, and 20 a second are nothing",
    "receive a battery status": "each status proves ages and shows restarts",
    "all calls for each status, watching": "each status proves ages",
    "all calls for each status, driving": "ages, uplink and wheels are watched",
    "firmware that drives, linked": "it copes with robots that nobody has seen",
    "the same, without texts and statistics": "as above",
    "a metre, in a firmware that drives": "it learns the robot's response, in emulated floats",
    "a client's memory": "ages, restarts and stops of every robot",
    "processor, one robot as by default": "under 1 % is not worth more code",
    "processor, 1,000 robots as by default": "nobody has a thousand",
    "processor, watching": "a few percent are not worth more code",
    "cmd_vel to robot, p50": "a command holds for 250 ms",
    **dict.fromkeys(
        (
            "family of 7488: moves that are fine",
            "family of 7488, 20 % lost: moves that are fine",
            "robots drawn between the members of the family: moves that are fine",
        ),
        "noise hides how a slow robot swings",
    ),
}


def number(value):
    """Three significant digits, and a comma between thousands."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def compared(result, own):
    """A peer's figure: first as a multiple of ours, then itself."""
    if result is None:
        return ""
    if own is None or own is result or not own["value"] or result["value"] is None:
        return number(result["value"])
    return f"×{result['value'] / own['value']:.3g} ({number(result['value'])})"


def verdict(result):
    """Judge the whole interval of a figure that has an aim."""
    if "aim" not in result or result["value"] is None:
        return ""
    sign = -1 if result.get("better") == "higher" else 1
    ends = [result.get(end, result["value"]) for end in ("low", "high")]
    met = [sign * end <= sign * result["aim"] for end in ends]
    reason = f": {REASONS[result['name']]}" if result["name"] in REASONS else ""
    word = "" if all(met) else ": undecided" if any(met) else f": **missed**{reason}"
    return number(result["aim"]) + word


def table(part):
    """The rows that decide, with a column for each peer that they have."""
    names = {}
    for result in part["results"]:
        if re.fullmatch(SHOWN.get(part["part"], ".*"), result["name"]):
            names.setdefault(result["name"], {})[result.get("subject", "roburoc4")] = result
    subjects = list(dict.fromkeys(s for of_name in names.values() for s in of_name))
    subjects.sort(key=lambda subject: subject != "roburoc4")
    rows = [["what", "unit", *subjects, "aim"]]
    for name, of_name in names.items():
        own = of_name.get("roburoc4")
        # Sizes on several processors have no figure of "roburoc4": the first one has the aim.
        main = own or next(iter(of_name.values()))
        figures_of = [compared(of_name.get(subject), own) for subject in subjects]
        rows.append([name, main["unit"], *figures_of, verdict(main)])
    if not any(row[-1] for row in rows[1:]):
        rows = [row[:-1] for row in rows]
    rows.insert(1, ["---"] * len(rows[0]))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def section(part):
    """One part, as it was measured."""
    tools = ", ".join(part.get("versions", []))
    measured = f"Measured {part['measured']} at {part.get('code', 'no commit')}"
    measured += f" on {part.get('machine', 'an unknown machine')}"
    if part.get("quick"):
        measured += " (**a quick run, which judges nothing**)"
    return f"{part['about']} {measured}{' with ' + tools if tools else ''}.\n\n{table(part)}\n"


def sections_of(text):
    """The sections that a report has: title -> text."""
    parts = re.split(r"^## (.*)\n+", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, default=figures.BENCH / "RESULTS.md")
    given = parser.parse_args()
    sections = sections_of(given.out.read_text("utf-8")) if given.out.exists() else {}
    for name in SHOWN:
        path = given.results / f"{name}.json"
        if path.exists():
            part = json.loads(path.read_text("utf-8"))
            sections[part["title"]] = section(part)
    text = HEAD
    for title, body in sections.items():
        text += f"\n## {title}\n{body.strip()}\n"
    given.out.write_text(text, "utf-8")
    count = len(text.splitlines())
    print(f"{given.out}: {count} lines, {len(sections)} parts")
    if count > MOST_LINES:
        raise SystemExit(f"report: more than {MOST_LINES} lines: show fewer rows in SHOWN")


if __name__ == "__main__":
    main()
