# SPDX-License-Identifier: MIT
"""The page: one file that loads nothing."""

from __future__ import annotations

from html import escape
from typing import Any

from .figures import Figures
from .plots import Line, chart, clock, lamps, way

_STYLE = """
:root{color-scheme:light dark;--ink:#1b2330;--soft:#5b6675;--grid:#dde3ea;--paper:#fff;
--card:#f5f7fa;--s1:#1d5fd1;--s2:#c2410c;--s3:#0f7b52;--s4:#8a3ab9;--bad:#b3261e;--weak:#8a5a00;--good:#0f6b45}
@media (prefers-color-scheme:dark){:root{--ink:#e6ebf2;--soft:#9aa7b8;--grid:#2b3543;
--paper:#10161f;--card:#18212d;--s1:#7cb0ff;--s2:#ffab70;--s3:#5fd6a4;--s4:#d4a3f5;--bad:#ff9a91;--weak:#f2c268;
--good:#6fdba8}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1060px;padding:24px 20px 60px;background:var(--paper);color:var(--ink);
font:15px/1.5 system-ui,sans-serif}
h1{font-size:24px;margin:0 0 2px}h2{font-size:18px;margin:34px 0 8px}
p{margin:4px 0;color:var(--soft)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(170px,1fr));gap:10px;margin:18px 0}
.tiles div{background:var(--card);border-radius:8px;padding:10px 14px}
.tiles b{display:block;font-size:20px;font-weight:600}.tiles span{color:var(--soft);font-size:13px}
figure{margin:14px 0;background:var(--card);border-radius:8px;padding:10px 12px}
figure.square{max-width:560px}
figcaption{font-weight:600;display:flex;flex-wrap:wrap;gap:4px 18px;align-items:baseline}
.keys{font-weight:400;font-size:13px;color:var(--soft);display:flex;flex-wrap:wrap;gap:0 14px}
.keys i{display:inline-block;width:18px;height:0;border-top:2.5px solid;margin:0 5px 4px 0}
.keys i.s1{border-color:var(--s1)}.keys i.s2{border-color:var(--s2);border-top-style:dashed}
.keys i.s3{border-color:var(--s3)}.keys i.s4{border-color:var(--s4)}
.keys i.begin,.keys i.finish{width:11px;height:11px;border:2.5px solid var(--s3);border-radius:50%;
margin:0 5px -1px 0}.keys i.finish{border-color:var(--s2);background:var(--s2)}
svg{width:100%;height:auto;display:block}
svg text{fill:var(--soft);font:12px system-ui,sans-serif}
.mid{text-anchor:middle}.end{text-anchor:end}
svg path{fill:none;stroke-width:1.6;stroke-linejoin:round}
svg .grid{stroke:var(--grid);stroke-width:1}svg .zero{stroke:var(--soft);stroke-width:1}
svg .s1{stroke:var(--s1)}svg .s2{stroke:var(--s2);stroke-dasharray:6 4}
svg .s3{stroke:var(--s3)}svg .s4{stroke:var(--s4)}
svg .on{fill:var(--s1)}svg .begin{fill:none;stroke:var(--s3);stroke-width:3}
svg .finish{fill:var(--s2)}
.table{overflow-x:auto}
table{border-collapse:collapse;min-width:60%;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid var(--grid);white-space:nowrap}
th{color:var(--soft);font-weight:500;font-size:13px}td.number,th.number{text-align:right}
td.text{white-space:normal;width:100%}
.bad{color:var(--bad)}.weak{color:var(--weak)}.good{color:var(--good)}
.note{background:var(--card);border-left:4px solid var(--weak);padding:8px 12px;
color:var(--ink);margin:8px 0}
@media print{body{max-width:none}figure{break-inside:avoid}}
"""


def page(figures: Figures) -> str:
    """Write the page."""
    document = figures.document()
    title = f"RobuROC4 at {document['robot']}"
    return "".join(
        [
            '<!doctype html><html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width,initial-scale=1">',
            # nothing in a recording can make the page load anything
            '<meta http-equiv="Content-Security-Policy" '
            "content=\"default-src 'none'; style-src 'unsafe-inline'\">",
            f"<title>{escape(title)}, {document['begun']}</title>",
            f"<style>{_STYLE}</style></head><body>",
            f"<h1>{escape(title)}</h1>",
            f"<p>Recorded from {document['begun']} (UTC) for {clock(document['seconds'])}, "
            f"in {escape(figures.name)}. Times below count from the beginning.</p>",
            *_notes(document),
            _tiles(document),
            _events(document),
            "<h2>Path</h2>" if len(figures.path.points) > 1 else "",
            way(figures.path),
            chart(
                "Heading, left is positive",
                "°",
                document["seconds"],
                [Line("by odometry", "s1", figures.heading_deg)],
            ),
            "<h2>Speeds</h2>",
            *_speeds(figures, document),
            "<h2>Battery</h2>",
            *_battery(figures, document),
            "<h2>Distances</h2>",
            _distances(figures, document),
            "<h2>Inputs</h2>",
            *_inputs(figures, document),
            "<h2>Link</h2>",
            _link(document),
            "</body></html>\n",
        ]
    )


def _notes(document: dict[str, Any]) -> list[str]:
    notes = []
    if document["cut_bytes"]:
        notes.append(
            f"The file is truncated: its last {document['cut_bytes']} bytes are incomplete."
        )
    if document["not_recorded"]:
        notes.append(
            f"The recorder lost {document['not_recorded']} datagrams: the disk was full or slow."
        )
    if document["assumed"]:
        notes.append(
            "The recording begins after the robot was asked for its services: those of the manual "
            "are assumed."
        )
    return [f'<p class="note">{text}</p>' for text in notes]


def _tiles(document: dict[str, Any]) -> str:
    speed = document["speeds"]["current_linear_m_s"]
    battery = document["battery"]["percent"]
    services = document["link"]["services"]
    lost = sum(service["lost"] for service in services)
    received = sum(service["received"] for service in services)
    fastest = max(abs(speed["low"]), abs(speed["high"])) if speed else None
    events = len(document["events"]) + document["more_events"]
    tiles = [
        (f"{document['path']['driven_m']:.2f} m", "driven, by odometry"),
        ("-" if fastest is None else f"{fastest:.2f} m/s", "highest speed"),
        (
            "-" if battery is None else f"{battery['first']:.0f} → {battery['last']:.0f} %",
            "battery",
        ),
        (f"{received:,}", f"statuses, {lost:,} lost"),
        (f"{events:,}", f"events, {document['bad_events']:,} of them bad"),
    ]
    cells = "".join(
        f"<div><b>{escape(value)}</b><span>{name}</span></div>" for value, name in tiles
    )
    return f'<div class="tiles">{cells}</div>'


def _table(head: list[str], rows: list[list[Any]], texts: int) -> str:
    """Make a table whose first columns are texts, the others numbers."""
    kind = ["" if at < texts else ' class="number"' for at in range(len(head))]
    header = "".join(f"<th{kind[at]}>{escape(text)}</th>" for at, text in enumerate(head))
    body = "".join(
        "<tr>"
        + "".join(
            f"<td{kind[at]}>{'-' if cell is None else escape(str(cell))}</td>"
            for at, cell in enumerate(row)
        )
        + "</tr>"
        for row in rows
    )
    return f'<div class="table"><table><tr>{header}</tr>{body}</table></div>'


def _events(document: dict[str, Any]) -> str:
    rows = "".join(
        f'<tr><td class="number">{clock(event["seconds"], exact=True)}</td>'
        f"<td>{event['time'][11:]}</td>"
        f'<td class="text {event["level"]}">{escape(event["text"])}</td></tr>'
        for event in document["events"]
    )
    more = document["more_events"]
    note = f"<p>{more} more are left out.</p>" if more else ""
    if not rows:
        return "<h2>Events</h2><p>None.</p>"
    return (
        '<h2>Events</h2><div class="table"><table><tr><th class="number">after</th><th>UTC</th>'
        f"<th>what happened</th></tr>{rows}</table></div>{note}"
    )


def _or_none(picture: str, what: str) -> str:
    return picture or f"<p>The recording has no {what}.</p>"


def _speeds(figures: Figures, document: dict[str, Any]) -> list[str]:
    target, current, target_turn, turn = figures.speeds
    seconds = document["seconds"]
    linear = [Line("measured", "s1", current), Line("target", "s2", target)]
    angular = [Line("measured", "s1", turn), Line("target", "s2", target_turn)]
    return [
        _or_none(chart("Speed", "m/s", seconds, linear), "speeds"),
        chart("Turn rate, left is positive", "rad/s", seconds, angular),
    ]


def _battery(figures: Figures, document: dict[str, Any]) -> list[str]:
    seconds = document["seconds"]
    percent = [Line("remaining", "s3", figures.battery_percent)]
    return [
        _or_none(chart("Charge", "%", seconds, percent, (0, 100)), "battery statuses"),
        chart("Voltage", "V", seconds, [Line("at the input", "s1", figures.battery_v)]),
    ]


def _distances(figures: Figures, document: dict[str, Any]) -> str:
    names = ("front", "rear") if len(figures.distances) == 2 else ()
    styles = ("s1", "s3", "s4", "s2")
    lines = [
        Line(names[at] if names else f"telemeter {at}", styles[at % 4], series)
        for at, series in enumerate(figures.distances)
    ]
    picture = chart("Telemeters", "m", document["seconds"], lines)
    return _or_none(picture, "distances")


def _inputs(figures: Figures, document: dict[str, Any]) -> list[str]:
    digital = document["digital_inputs"]
    rows = [
        (f"{at} {digital[at]['name']}".strip(), switch.spans)
        for at, switch in enumerate(figures.switches)
        if switch.times
    ]
    table = _table(
        ["digital input", "times on", "seconds on"],
        [
            [f"{one['index']} {one['name']}", one["times_on"], one["seconds_on"]]
            for one in digital
            if one["times_on"]
        ],
        1,
    )
    analog = _table(
        ["analog input", "lowest", "highest"],
        [
            [f"{one['index']} {one['name']}", one["low"], one["high"]]
            for one in document["analog_inputs"]
        ],
        1,
    )
    if not digital:
        return ["<p>The recording has no inputs.</p>"]
    parts = (
        [lamps(document["seconds"], rows), table] if rows else ["<p>No digital input was on.</p>"]
    )
    return [*parts, analog]


def _link(document: dict[str, Any]) -> str:
    link = document["link"]
    services = _table(
        ["statuses of", "received", "per second", "lost", "loss", "jitter", "longest gap"],
        [
            [
                one["service"],
                one["received"],
                one["rate_hz"],
                one["lost"],
                None if one["loss"] is None else f"{one['loss']:.2%}",
                None if one["jitter_ms"] is None else f"{one['jitter_ms']} ms",
                None if one["longest_gap_s"] is None else f"{one['longest_gap_s']} s",
            ]
            for one in link["services"]
        ],
        1,
    )
    trip = link["round_trip_ms"]
    answers = f"{link['requests']} requests, {link['answered']} of them answered"
    if trip:
        answers += (
            f" within {trip['low']:.2f} to {trip['high']:.2f} ms, {trip['mean']:.2f} on average"
        )
    clients = _table(
        ["sender", "commands", "of them speeds"],
        [[one["address"], one["commands"], one["speeds"]] for one in document["clients"]],
        1,
    )
    commanded = clients if document["clients"] else "<p>Nobody sent commands.</p>"
    return f"{services}<p>{answers}.</p>{commanded}"
