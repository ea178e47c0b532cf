# SPDX-License-Identifier: MIT
"""The page: one file that loads nothing."""

from __future__ import annotations

from html import escape
from typing import Any

from .figures import Figures
from .plots import STYLE, Line, chart, clock, lamps, way


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
            f"<style>{STYLE}</style></head><body>",
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
