# SPDX-License-Identifier: MIT
"""Write bench/RESULTS.md and docs/images/bench-*.svg from the figures in bench/results/*.json."""

import argparse
import dataclasses
import json
import os
import pathlib
import re

import aims
import figures

MOST_LINES = 200  # of RESULTS.md
PEERS = (
    "roburoc4",
    "memcpy",
    "LCM",
    "nanopb",
    "MAVLink",
    "lwIP MQTT",
    "bare loop",
    "bare ppoll loop",
    "bare recv",
    "bare recvmmsg",
    "tcpdump",
    "Cortex-M0",
    "Cortex-M3",
    "Cortex-M4F",
    "RV32",
)
HEAD = """# Figures

Written by `scripts/bench` on an idle machine. Other machines give other figures: run it on yours.
[README.md](README.md) says how each part is measured. The tables show what decides; every figure is
in `bench/results/PART.json`. The × beside a peer's figure is that figure divided by roburoc4's.

"""


@dataclasses.dataclass(frozen=True)
class Section:
    """A section of the report: a picture, and a table with the rows that it shows of some parts."""

    title: str
    picture: str
    shown: dict[str, str]  # part -> regular expression that matches the names of its rows


SECTIONS = (
    Section(
        "Codec",
        "bench-codec.svg",
        {
            "codec": "(de|en)code (iocard|differential)",
            "instructions": "(de|en)code (iocard|differential)",
        },
    ),
    Section(
        "Client on a PC",
        "bench-loopback.svg",
        {
            "client_cost": ".*",
            "client": "status, Differential|4096 clients, ratio.*",
            "loopback": ".*p50|statuses a second.*",
        },
    ),
    Section(
        "Microcontrollers",
        "bench-footprint.svg",
        {"footprint": "codec of six.*|firmware.*|moves.*|a client's.*|stack"},
    ),
    Section("Microcontrollers, other libraries", "", {"footprint_peers": ".*"}),
    Section(
        "Python, MATLAB and Octave",
        "bench-python.svg",
        {
            "python": "decode to an object|batch decode.*|drive.*|import|installed",
            "matlab": r"r\.drive.*|p = .*|s = r\.status.*",
        },
    ),
    Section(
        "LCM, ROS 2 and the dashboard",
        "lcm-latency.svg",
        {
            "lcm": "status.*p50|lost of.*|1000 robots.*(processor|memory|p50|p99|bridge)",
            "ros2": "71.*(processor|odom, p..)|355.*processor",
            "dashboard": ".*",
        },
    ),
    Section("Growth", "bench-growth.svg", {"growth": "100+ robots|5 services, 10 ms"}),
    Section(
        "Moves on the simulator",
        "",
        {"moves": "[a-z ]+ at 1.0 [a-z/]+: (error|time by .*response)|square.* by .*without.*"},
    ),
    Section("Recordings", "", {"recording": "(24|0.2) h: (size|read|report)(, memory)?"}),
)


def number(value):
    """Three significant digits, and a comma between thousands."""
    if value is None:
        return "-"
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def table(rows):
    """A Markdown table without the columns that are empty."""
    kept = [i for i, _ in enumerate(rows[0]) if any(row[i] for row in rows[1:])]
    rows = [[row[i] for i in kept] for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(kept))]
    lines = [
        "| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |"
        for row in rows
    ]
    lines.insert(1, "| " + " | ".join("-" * w for w in widths) + " |")
    return "\n".join(lines) + "\n"


def by_name(part):
    names = {}
    for result in part["results"]:
        names.setdefault(result["name"], {})[result.get("subject", "roburoc4")] = result
    return names


def compared(result, own):
    """A peer's figure: first as a multiple of ours, then itself."""
    if result is None:
        return ""
    if own is None or own is result or not own["value"] or result["value"] is None:
        return number(result["value"])
    return f"×{result['value'] / own['value']:.3g} ({number(result['value'])})"


def section_table(parts, shown):
    """The rows that a section shows of its parts, with the peers that these rows have."""
    chosen = []  # part, row, subject -> figure
    for part in parts:
        names = by_name(part)
        matching = [n for n in names if re.fullmatch(shown[part["part"]], n)]
        if not matching:
            print(f"report: {part['part']} has no row {shown[part['part']]}")
        chosen += [(part, name, names[name]) for name in matching]
    subjects = list(dict.fromkeys(s for _, _, of_name in chosen for s in of_name))
    subjects.sort(key=lambda s: PEERS.index(s) if s in PEERS else len(PEERS))
    rows = [["part", "what", "unit", *subjects, "interval", "aim", "result"]]
    last = parts[0] if len(parts) == 1 else None
    for part, name, of_name in chosen:
        # Sizes on several processors have no figure of "roburoc4": the first one has the aim.
        main = of_name.get("roburoc4") or next(iter(of_name.values()))
        interval = f"{number(main['low'])} to {number(main['high'])}" if "low" in main else ""
        rows.append(
            [
                "" if part is last else part["title"],
                name,
                main["unit"],
                *(compared(of_name.get(s), of_name.get("roburoc4")) for s in subjects),
                interval,
                number(main["aim"]) if "aim" in main else "",
                "" if part.get("quick") else aims.verdict(main),
            ]
        )
        last = part
    return table(rows)


def older(part):
    """Whether src/ or include/ changed since these figures were measured."""
    return part.get("source") != figures.source()


def aims_text(parts):
    """What was reached; each other aim with its reason."""
    judged = list(aims.judge([p for p in parts if not p.get("quick")], number))
    if not judged:
        return "## Aims\n\nA quick run (`--quick`) judges nothing.\n"
    met = [aim for aim in judged if aim.verdict == aims.MET]
    others = [aim for aim in judged if aim.verdict != aims.MET]
    lines = ["## Aims\n", f"Of {len(judged)} aims, {len(met)} are met.\n"]
    unexplained = [aim.aim for aim in others if aim.reason == aims.NO_REASON]
    if unexplained:
        warning = f"Missed without a reason in bench/aims.py: {'; '.join(unexplained)}."
        print(f"report: {warning}")
        lines.append(f"**{warning}**\n")
    if others:
        rows = [[a.part, a.aim, a.figure, a.verdict, a.reason] for a in others]
        lines.append(table([["part", "aim", "figure", "result", "reason"], *rows]))
    lines.append("<details><summary>The aims that are met</summary>\n")
    for title in dict.fromkeys(aim.part for aim in met):
        of_part = [f"{aim.aim} ({aim.figure})" for aim in met if aim.part == title]
        lines.append(f"- {title}: {'; '.join(of_part)}")
    return "\n".join([*lines, "\n</details>\n"])


def header(parts, failed):
    """What the figures were measured on and with."""
    machines = dict.fromkeys(p["machine"] for p in parts if "machine" in p)
    versions = dict.fromkeys(v for p in parts for v in p.get("versions", []))
    code = dict.fromkeys(p.get("code", "unknown") for p in parts)
    dates = sorted({p["measured"] for p in parts})
    lines = [
        HEAD + f"- Machine: {'; '.join(machines)}",
        f"- Tools and peers: {'; '.join(versions)}",
        f"- Measured: {', '.join(dates)}; code: {', '.join(code)}\n",
    ]
    if failed:
        lines.append(
            f"**Not measured this time because of an error: {', '.join(failed)}.** Their figures, "
            "if there are any, are from an earlier run.\n"
        )
    titles = [part["title"] for part in parts if older(part)]
    if titles:
        lines.append(
            f"**Older than `src/`: {', '.join(titles)}.** Measure them again before you rely on "
            "them.\n"
        )
    return "\n".join(lines)


def load(folder):
    parts = {}
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        part = json.loads(path.read_text(encoding="utf-8"))
        missing = {"part", "title", "about", "measured", "results"} - set(part)
        if missing:
            raise SystemExit(
                f"report: {path} has no {', '.join(sorted(missing))}: see "
                "bench/README.md for the format"
            )
        parts[part["part"]] = part
    return parts


def ordered(parts):
    """The parts as the report shows them; those that it does not show come last."""
    known = [name for section in SECTIONS for name in section.shown if name in parts]
    return [parts[name] for name in dict.fromkeys([*known, *sorted(parts)])]


def section_text(section, parts, folder, images):
    shown = [parts[name] for name in section.shown if name in parts]
    if not shown:
        return ""
    lines = [f"## {section.title}\n"]
    if section.picture and (folder / section.picture).exists():
        lines.append(f"![{section.title}]({images}/{section.picture})\n")
    if len(shown) == 1:
        lines.append(shown[0]["about"])
    else:
        lines += [f"- *{part['title']}.* {part['about']}" for part in shown]
    return "\n".join([*lines, "", section_table(shown, section.shown)])


# ------------------------------------------------------------------------------------ pictures

COLOURS = {
    "roburoc4": "#c0392b",
    "memcpy": "#7f8c8d",
    "LCM": "#2980b9",
    "nanopb": "#27ae60",
    "MAVLink": "#8e44ad",
    "lwIP MQTT": "#e67e22",
    # Processors are not peers: shades of one colour.
    "Cortex-M0": "#0b3c5d",
    "Cortex-M3": "#1f6f8b",
    "Cortex-M4F": "#3aa6b9",
    "RV32": "#8fc9c2",
}


def errors(results):
    """Lengths of the error bars below and above; None if nothing varies."""
    if not any("low" in r for r in results):
        return None
    return [
        [r["value"] - r.get("low", r["value"]) for r in results],
        [r.get("high", r["value"]) - r["value"] for r in results],
    ]


def plain_numbers(axis):
    """Label an axis with 100 and 0.2, not powers of ten; with 2 and 5 too if it is short."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    plain = FuncFormatter(lambda value, _: f"{value:g}")
    low, high = sorted(axis.get_view_interval())
    few = high / low < 1000
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,)))
    axis.set_major_formatter(plain)
    axis.set_minor_formatter(NullFormatter())


def legend_above(figure, axes, columns):
    """A legend that hides no bar."""
    figure.legend(
        *axes.get_legend_handles_labels(), loc="upper center", ncol=columns, frameon=False
    )
    figure.tight_layout(rect=(0, 0, 1, 0.94))


def grouped_bars(axes, names, subjects, log):
    width = 0.8 / len(subjects)
    for i, subject in enumerate(subjects):
        found = [
            (x, of_name[subject])
            for x, of_name in enumerate(names.values())
            if subject in of_name and of_name[subject]["value"]
        ]
        axes.bar(
            [x + i * width - 0.4 + width / 2 for x, _ in found],
            [r["value"] for _, r in found],
            width,
            label=subject,
            color=COLOURS.get(subject),
            yerr=errors([r for _, r in found]),
            capsize=1.5,
            error_kw={"linewidth": 0.7},
        )
    axes.set_xticks(range(len(names)), list(names), rotation=20, ha="right")
    if log:
        axes.set_yscale("log")
        plain_numbers(axes.yaxis)
    axes.grid(axis="y", alpha=0.3)


def draw_codec(plt, parts):
    if "codec" not in parts:
        return None
    names = by_name(parts["codec"])
    figure, both = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
    for axes, direction in zip(both, ("decode", "encode"), strict=True):
        chosen = {n.split(" ", 1)[1]: v for n, v in names.items() if n.startswith(direction)}
        subjects = [s for s in PEERS if any(s in v for v in chosen.values())]
        grouped_bars(axes, chosen, subjects, log=True)
        axes.set_title(f"{direction} a message")
    both[0].set_ylabel("ns, log")
    legend_above(figure, both[0], len(subjects))
    return figure


def draw_python(plt, parts):
    if "python" not in parts:
        return None
    decode = by_name(parts["python"])["decode to an object"]
    figure, axes = plt.subplots(figsize=(7, 3.2))
    found = list(decode.values())
    axes.barh(
        [r["subject"] for r in found],
        [r["value"] for r in found],
        xerr=errors(found),
        capsize=2,
        color=[COLOURS.get(r["subject"], "#7f8c8d") for r in found],
    )
    axes.invert_yaxis()
    axes.set_xscale("log")
    plain_numbers(axes.xaxis)
    axes.set_xlabel("us to decode a differential status to an object, log")
    axes.grid(axis="x", alpha=0.3)
    figure.tight_layout()
    return figure


def draw_footprint(plt, parts):
    if not {"footprint", "footprint_peers"} <= set(parts):
        return None
    names = by_name(parts["footprint"])
    chosen = [
        n
        for n in (
            "codec, all of it",
            "codec of six messages, linked",
            "firmware that drives, linked",
            "moves, all of it",
        )
        if n in names
    ]
    figure, (axes, peers) = plt.subplots(1, 2, figsize=(10, 4.2), width_ratios=(3, 2))
    targets = [t for t in PEERS if any(t in names[n] for n in chosen)]
    grouped_bars(axes, {n: names[n] for n in chosen}, targets, log=False)
    axes.set_ylabel("bytes of text at -Os")
    axes.legend(fontsize=8)
    beside = {
        n.removesuffix(", flash").replace(", ", ",\n"): found
        for n, found in by_name(parts["footprint_peers"]).items()
        if n.endswith(", flash")
    }
    subjects = [s for s in PEERS if any(s in found for found in beside.values())]
    if subjects:
        grouped_bars(peers, beside, subjects, log=False)
        peers.legend(fontsize=8)
    peers.set_title("flash on Cortex-M0")
    figure.tight_layout()
    return figure


def draw_loopback(plt, parts):
    if "loopback" not in parts:
        return None
    names = {
        n: v
        for n, v in by_name(parts["loopback"]).items()
        if "ratio" not in n and "second" not in n
    }
    figure, axes = plt.subplots(figsize=(8, 3.6))
    grouped_bars(axes, names, ["bare loop", "bare ppoll loop", "roburoc4"], log=True)
    axes.set_ylabel("us, log; 95 % intervals")
    legend_above(figure, axes, 3)
    return figure


def line(axes, points, label=None):
    points = sorted(points)
    axes.errorbar(
        [p[0] for p in points],
        [p[1]["value"] for p in points],
        yerr=errors([p[1] for p in points]),
        marker="o",
        markersize=3,
        linewidth=1,
        capsize=2,
        label=label,
    )
    axes.set_xscale("log")
    plain_numbers(axes.xaxis)
    axes.grid(alpha=0.3)


def leading_number(name):
    return int(name.split(" ", 1)[0])


def draw_growth(plt, parts):
    if not {"client", "growth", "payload"} <= set(parts):
        return None
    figure, ((clients, robots), (services, payload)) = plt.subplots(2, 2, figsize=(9, 6.4))
    line(
        clients,
        [
            (leading_number(r["name"]), r)
            for r in parts["client"]["results"]
            if re.fullmatch(r"\d+ clients?", r["name"])
        ],
    )
    clients.set_ylim(bottom=0)
    clients.set(xlabel="clients in one process", ylabel="ns a status")
    line(
        robots,
        [
            (leading_number(r["name"]), r)
            for r in parts["growth"]["results"]
            if re.fullmatch(r"\d+ robots?", r["name"])
        ],
    )
    robots.set(xlabel="robots in one roburoc4-sim", ylabel="ms of processor a second", yscale="log")
    of_count = {}
    for r in parts["growth"]["results"]:
        if found := re.fullmatch(r"((\d+) services?), (\d+) ms", r["name"]):
            rate = int(found[2]) * 1000 / int(found[3])
            of_count.setdefault(found[1], []).append((rate, r))
    for count, points in of_count.items():
        line(services, points, count)
    services.set(xlabel="statuses a second", ylabel="ms of processor a second", yscale="log")
    services.legend(fontsize=8)
    line(payload, [(leading_number(r["name"]), r) for r in parts["payload"]["results"]])
    payload.set(xlabel="bytes of an IO card's status", ylabel="ns to decode", yscale="log")
    for axes in (robots, services, payload):
        plain_numbers(axes.yaxis)
    figure.tight_layout()
    return figure


def draw(parts, folder):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "roburoc4", "font.size": 9})
    import matplotlib.pyplot as plt

    drawn = []
    for name, drawing in (
        ("codec", draw_codec),
        ("loopback", draw_loopback),
        ("footprint", draw_footprint),
        ("python", draw_python),
        ("growth", draw_growth),
    ):
        figure = drawing(plt, parts)
        if figure is not None:
            figure.savefig(folder / f"bench-{name}.svg", metadata={"Date": None})
            plt.close(figure)
            drawn.append(name)
    return drawn


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=pathlib.Path, default=figures.BENCH / "results")
    parser.add_argument("--out", type=pathlib.Path, default=figures.BENCH / "RESULTS.md")
    parser.add_argument("--images", type=pathlib.Path, default=figures.TOP / "docs/images")
    parser.add_argument("--failed", nargs="*", default=[], help="parts that were not measured")
    given = parser.parse_args()
    parts = load(given.results)
    given.images.mkdir(parents=True, exist_ok=True)
    drawn = draw(parts, given.images)
    images = os.path.relpath(given.images, given.out.parent)
    texts = [header(ordered(parts), given.failed), aims_text(ordered(parts))]
    texts += [section_text(section, parts, given.images, images) for section in SECTIONS]
    report = "\n".join(text for text in texts if text)
    given.out.write_text(report, encoding="utf-8")
    count = len(report.splitlines())
    print(f"{given.out}: {count} lines, {len(parts)} parts, {len(drawn)} pictures")
    if count > MOST_LINES:
        raise SystemExit(f"report: more than {MOST_LINES} lines: show fewer rows in SECTIONS")


if __name__ == "__main__":
    main()
