# SPDX-License-Identifier: MIT
"""Write bench/RESULTS.md and docs/images/bench-*.svg from the figures in bench/results/*.json."""

import argparse
import json
import os
import pathlib
import re

import aims
import figures

# What is shown first, in this order; other parts follow by name.
ORDER = (
    "codec",
    "instructions",
    "client",
    "loopback",
    "footprint",
    "footprint_peers",
    "python",
    "matlab",
    "lcm",
    "ros2",
    "dashboard",
    "growth",
    "moves",
    "recording",
    "payload",
)
PEERS = (
    "roburoc4",
    "memcpy",
    "LCM",
    "nanopb",
    "MAVLink",
    "bare loop",
    "bare ppoll loop",
    "bare recv",
    "bare recvmmsg",
    "tcpdump",
    "Cortex-M0",
    "Cortex-M3",
    "Cortex-M4F",
    "RV32",
    "AVR",
)
HEAD = """# Figures

Written by `scripts/bench` from `bench/results/*.json`; [README.md](README.md) says what each part
is. Not a promise for other machines: run it on yours.

"""
RATIOS = "`×` in a peer's column is how many times roburoc4's figure the peer's is.\n"


def number(value):
    """Three significant digits, and thousands apart."""
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def table(rows):
    """Columns as wide as their widest cell; what is empty throughout is left out."""
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
    """A peer's figure: how many times ours first, then the figure itself."""
    if result is None:
        return ""
    if own is None or own is result or not own["value"] or result["value"] is None:
        return number(result["value"])
    return f"×{result['value'] / own['value']:.3g} ({number(result['value'])})"


def section_table(part):
    names = by_name(part)
    subjects = list(dict.fromkeys(s for of_name in names.values() for s in of_name))
    subjects.sort(key=lambda s: PEERS.index(s) if s in PEERS else len(PEERS))
    rows = [["what", "unit", *subjects, "interval", "aim", "result", "note"]]
    for name, of_name in names.items():
        # The row's own figure: ours, or the first (sizes on several processors).
        main = of_name.get("roburoc4") or next(iter(of_name.values()))
        interval = f"{number(main['low'])} to {number(main['high'])}" if "low" in main else ""
        rows.append(
            [
                name,
                main["unit"],
                *(compared(of_name.get(s), of_name.get("roburoc4")) for s in subjects),
                interval,
                number(main["aim"]) if "aim" in main else "",
                "" if part.get("quick") else aims.verdict(main),
                main.get("note", ""),
            ]
        )
    return table(rows)


def details(summary, text):
    return f"\n<details><summary>{summary}</summary>\n\n{text}\n</details>\n"


def footprint_details(part, most=40):
    """Where the bytes are."""
    functions = [[str(size), file, f"`{name}`"] for size, file, name in part["functions"][:most]]
    linked = [[str(size), name] for size, name in part["linked"]]
    return (
        details(
            f"The {most} largest functions and tables on Cortex-M0",
            table([["bytes", "file", "function"], *functions]),
        )
        + details(
            "The bare loop that drives on Cortex-M0: what is linked, by where it is from",
            table([["bytes", "from"], *linked]),
        )
        + details("The deepest stack on Cortex-M0", f"```\n{part['stack_path'].rstrip()}\n```\n")
    )


def older(part):
    """Whether the library is no longer what these figures are of."""
    return part.get("source") != figures.source()


def section(part):
    lines = [f"## {part['title']}\n"]
    if part.get("about"):
        lines.append(part["about"] + "\n")
    lines.append(section_table(part))
    if "functions" in part:
        lines.append(footprint_details(part))
    measured = f"Measured {part['measured']}"
    if part.get("quick"):
        measured = f"A quick look (`--quick`), which judges nothing, {part['measured']}"
    if part.get("machine"):
        measured += f" on {part['machine']}"
    measured += f"; code: {part.get('code', 'not noted')}"
    if older(part):
        measured += ", **older than `src/`**"
    if part.get("versions"):
        measured += "; " + "; ".join(part["versions"])
    lines.append(f"\n<sub>{measured}.</sub>\n")
    return "\n".join(lines)


def header(parts, failed):
    """What it was measured on and with, and the aims."""
    machines = dict.fromkeys(p["machine"] for p in parts if "machine" in p)
    versions = dict.fromkeys(v for p in parts for v in p.get("versions", []))
    lines = [
        HEAD + f"- Machine: {'; '.join(machines)}",
        f"- Compilers, and what is compared with: {'; '.join(versions)}",
        f"- Measured: {', '.join(sorted({p['measured'] for p in parts}))}\n",
    ]
    if failed:
        lines.append(
            f"**Not measured this time, for an error: {', '.join(failed)}.** Their "
            "figures, where there are any, are of an earlier run.\n"
        )
    titles = [part["title"] for part in parts if older(part)]
    if titles:
        lines.append(
            f"**Of other code than `src/` is now, or not noted of which: {', '.join(titles)}.** "
            "Measure them again before you rely on them.\n"
        )
    judged = list(aims.rows([p for p in parts if not p.get("quick")], number))
    lines.append("## The aims\n")
    if judged:
        counts = {word: sum(row[-1] == word for row in judged) for word in aims.WORDS}
        lines.append(
            f"Of {len(judged)}, {counts[aims.MET]} are met; {counts[aims.MISSED]} are missed, why "
            f"is at the end; {counts[aims.UNDECIDED]} are undecided: the aim is in the interval.\n"
        )
        lines.append(table([["part", "aim", "figure", "verdict"], *judged]))
    else:
        lines.append("A quick look judges nothing.\n")
    lines.append(RATIOS)
    return "\n".join(lines)


def load(folder):
    parts = {}
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        part = json.loads(path.read_text(encoding="utf-8"))
        missing = {"part", "title", "measured", "results"} - set(part)
        if missing:
            raise SystemExit(
                f"report: {path} has no {', '.join(sorted(missing))}: see "
                "bench/README.md for the format"
            )
        parts[part["part"]] = part
    return parts


def ordered(parts):
    known = [parts[name] for name in ORDER if name in parts]
    return known + [parts[name] for name in sorted(set(parts) - set(ORDER))]


def filled(text, parts):
    """Put the figure into each {PART/NAME/SUBJECT}."""

    def figure(place):
        part, name, subject = place.groups()
        result = by_name(parts[part])[name][subject] if part in parts else {"value": None}
        return number(result["value"])

    return re.sub(r"\{(\w+)/([^{}/]+)/([^{}/]+)\}", figure, text)


# ------------------------------------------------------------------------------------ pictures

COLOURS = {
    "roburoc4": "#c0392b",
    "memcpy": "#7f8c8d",
    "LCM": "#2980b9",
    "nanopb": "#27ae60",
    "MAVLink": "#8e44ad",
    # Processors are no peers: shades of one colour.
    "Cortex-M0": "#0b3c5d",
    "Cortex-M3": "#1f6f8b",
    "Cortex-M4F": "#3aa6b9",
    "RV32": "#8fc9c2",
    "AVR": "#cfe3d4",
}


def errors(results):
    """Distances below and above, for error bars; None where nothing varies."""
    if not any("low" in r for r in results):
        return None
    return [
        [r["value"] - r.get("low", r["value"]) for r in results],
        [r.get("high", r["value"]) - r["value"] for r in results],
    ]


def plain_numbers(axis):
    """100 and 0.2 instead of powers of ten; 2 and 5 between them where decades are few."""
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
            "bare loop that drives, linked",
            "codec + client, all of it",
        )
        if n in names
    ]
    figure, (axes, peers) = plt.subplots(1, 2, figsize=(10, 4.2), width_ratios=(3, 2))
    targets = [t for t in PEERS if any(t in names[n] for n in chosen)]
    grouped_bars(axes, {n: names[n] for n in chosen}, targets, log=False)
    axes.set_ylabel("bytes of text at -Os")
    axes.legend(fontsize=8)
    start = "codec of six messages, "
    beside = {
        n[len(start) :]: v
        for n, v in by_name(parts["footprint_peers"]).items()
        if n.startswith(start)
    }
    grouped_bars(peers, beside, ["roburoc4", "nanopb", "MAVLink"], log=False)
    peers.set_title(f"{start}linked")
    peers.legend(fontsize=8)
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
    pictures = {name: f"bench-{name}.svg" for name in drawn} | {"lcm": "lcm-latency.svg"}
    images = os.path.relpath(given.images, given.out.parent)
    sections = []
    for part in ordered(parts):
        text = section(part)
        picture = pictures.get(part["part"], "")
        if picture and (given.images / picture).exists():
            title, rest = text.split("\n", 1)
            text = f"{title}\n\n![{part['title']}]({images}/{picture})\n{rest}"
        sections.append(text)
    changes = filled((figures.BENCH / "changes.md").read_text(encoding="utf-8"), parts)
    head = header(ordered(parts), given.failed)
    given.out.write_text("\n".join([head, *sections, changes]), encoding="utf-8")
    print(f"{given.out}: {len(parts)} parts, {len(drawn)} pictures")


if __name__ == "__main__":
    main()
