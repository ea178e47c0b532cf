# SPDX-License-Identifier: MIT
"""What is kept: a recording with no address of anybody's network, the page, and the archive."""

import math
import struct
import time
import zipfile
from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from ..report.plots import STYLE, Line, chart
from ..report.series import Series
from .answers import meaning, shown
from .contact import STEPS, Contact
from .session import Session
from .wire import SERVICES

if TYPE_CHECKING:  # it needs the library, which the measuring does without
    from ..recordings.capture import Datagram

_ROBOT, _CLIENT = bytes([192, 0, 2, 2]), bytes([192, 0, 2, 1])  # of RFC 5737: nobody's
_ROBOT_PORT, _FIRST_PORT = 60000, 50000
_LIBRARY = 9  # our port while the library drives
_SECTION = struct.pack("<IIIHHqI", 0x0A0D0D0A, 28, 0x1A2B3C4D, 1, 0, -1, 28)
_INTERFACE = struct.pack("<IIHHII", 1, 20, 101, 0, 0, 20)  # raw IP, microseconds


def recording(log: list[tuple[float, int, bool, bytes]]) -> bytes:
    """Return the datagrams as a pcapng file, whose time counts from the first one."""
    blocks = [_SECTION, _INTERFACE]
    begun_s = log[0][0]
    for at_s, port, sent, data in log:
        ends = [(_CLIENT, _FIRST_PORT + port), (_ROBOT, _ROBOT_PORT)]
        (source, from_port), (target, to_port) = ends if sent else ends[::-1]
        udp = struct.pack(">HHHH", from_port, to_port, 8 + len(data), 0) + data
        head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0) + source + target
        total = sum(struct.unpack(">10H", head))
        total = (total & 0xFFFF) + (total >> 16)
        packet = head[:10] + struct.pack(">H", ~(total + (total >> 16)) & 0xFFFF) + head[12:] + udp
        size = 32 + (len(packet) + 3 & ~3)
        us = round((at_s - begun_s) * 1e6)
        fields = (6, size, 0, us >> 32, us & 0xFFFFFFFF, len(packet), len(packet))
        blocks.append(struct.pack("<7I", *fields) + packet.ljust(size - 32, b"\0"))
        blocks.append(struct.pack("<I", size))
    return b"".join(blocks)


def add_drive(session: Session, recorded: "Iterable[Datagram]") -> None:
    """Add what the library recorded, by the time of day, while it drove."""
    later_s = session.world.now_s - time.time()
    session.log += [
        (datagram.time_us / 1e6 + later_s, _LIBRARY, not datagram.inbound, datagram.payload)
        for datagram in recorded
    ]


_SWITCHES = """hidden_services only_id_fixed answer_id_fixed error_header error_code surplus_bytes
delete_refused replace_mode query_mode texts refused_inserts subscription_lists keep_subscriptions
other_status_port tripped_target_shown pad_keeps_target ignored_commands_feed pad_target_hidden
commands_need_motors over_limit_refused dead_time_cycles late_targets odometry_mirrored
front_bumper_index"""
USUAL: dict[str, float] = {
    **dict.fromkeys(_SWITCHES.split(), 0.0),
    **{f"{name}_id": 2 + k for k, name in enumerate(SERVICES)},
    "analog_inputs": 9,
    "digital_inputs": 22,
    "digital_outputs": 8,
    "telemeters": 2,
    "override_index": 8,
    "rear_bumper_index": 1,
    "battery_voltage_index": 2,
    "robot_watchdog_ms": 1000,
    "start_safe": 1,
    "min_period_cycles": 1,
    "odometry_scale": 1,
}
"""The manual's answers, where it has any."""

_STYLE = (
    STYLE + "td.text{white-space:normal;width:45%}td.proof{white-space:normal}"
    "pre{white-space:pre-wrap}.other{font-weight:600}"
    ".refused{border-left:4px solid var(--bad);padding:8px 12px;color:var(--ink)}"
)
_PLOTS = {
    "linear": ("Step of the forward speed", "m/s"),
    "angular": ("Step of the turn rate", "rad/s"),
    "watchdog": ("After the last command", "m/s"),
    "clock": ("The two clocks", "ms"),
}
_OF_COLUMNS = ("override_index", "robot_watchdog_ms")
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)

Robots = Mapping[str, Mapping[str, float]]
"""What is known about each known robot, by the names in robot files."""


def differing(known: Mapping[str, float], other: Mapping[str, float]) -> list[str]:
    """Name what two robots do differently, as far as both are known."""
    return [
        name
        for name in sorted(known.keys() & other.keys())
        if not math.isclose(known[name], other[name], rel_tol=0.1, abs_tol=_alike(name))
    ]


def _alike(name: str) -> float:
    """How far two measurements of the same robot may be apart."""
    if name == "robot_watchdog_ms" or name.startswith("queue_"):
        return 50.0
    return 20.0 if name == "clock_ppm" else 0.01


def row(known: Mapping[str, float], name: str) -> str:
    """Write this robot's row for the table of known robots."""

    def shown(*names: str, digits: int = 5) -> str:
        return ", ".join(f"{known[n]:.{digits}g}" for n in names if n in known)

    others = [f"{n} {known[n]:g}" for n in differing(known, USUAL) if n not in _OF_COLUMNS]
    cells = (
        name,
        shown("override_index"),
        shown("robot_watchdog_ms"),
        shown("linear_omega_rad_s", "angular_omega_rad_s", digits=2),
        shown("linear_damping", "angular_damping", digits=2),
        shown("max_linear_m_s", "max_angular_rad_s", digits=3),
        "; ".join(others) or "nothing",
    )
    return "| " + " | ".join(cells) + " |"


def _picture(name: str, curves: dict[str, list[list[float]]]) -> str:
    title, unit = _PLOTS[name]
    lines = []
    for k, (label, points) in enumerate(curves.items()):
        series = Series(points[0][0] if points else 0.0, width_s=0.01)
        for at_s, value in points:
            series.add(at_s, value)
        lines.append(Line(label, f"s{k + 1}", series))
    seconds = max((points[-1][0] - points[0][0] for points in curves.values() if points), default=0)
    return chart(title, unit, seconds, lines)


def _answers(s: Session) -> str:
    rows = []
    for name, value in s.known.items():
        differs = name in USUAL and not math.isclose(value, USUAL[name], abs_tol=1e-4)
        first, end = s.proof.get(name, (0, 0))
        proof = f"{first + 1} to {end}" if end else s.earlier.get(name, "tape measure")
        rows.append(
            f'<tr class="{"other" if differs else ""}"><td>{escape(name)}</td>'
            f'<td class="text">{escape(meaning(name).phrase)}</td>'
            f"<td>{escape(shown(name, value))}</td>"
            f"<td>{escape(shown(name, USUAL[name])) if differs else ''}</td>"
            f'<td class="proof">{proof}</td></tr>'
        )
    return (
        "<p>Answers in bold differ from those that the manual suggests. The last column counts "
        "the datagrams of this session's recording, or of the one that it names.</p>"
        "<table><tr><th>question</th><th>what it is</th><th>answer</th>"
        f"<th>manual</th><th>datagrams</th></tr>{''.join(rows)}</table>"
    )


def _compared(known: Mapping[str, float], robots: Robots) -> str:
    items = []
    for name, other in robots.items():
        others = [f"{n} ({known[n]:g}, not {other[n]:g})" for n in differing(known, other)]
        items.append(f"<li>{escape(name)}: {escape(', '.join(others) or 'no difference')}</li>")
    return f"<h2>Compared with known robots</h2><ul>{''.join(items)}</ul>" if items else ""


def page(contact: Contact, robots: Robots) -> str:
    """Write the page: answers, what differs from the manual, and which datagrams prove it."""
    s, refused = contact.session, contact.refused
    steps = "".join(
        f"<li>{escape(step.name)}{'' if step.name in contact.done else ': not done'}</li>"
        for step in STEPS
    )
    notes = "".join(f"<li>{escape(k)}: {v:g}</li>" for k, v in s.notes.items())
    watched = "".join(
        f'<tr><td class="text">{escape(did)}</td><td class="text">{escape(saw)}</td></tr>'
        for did, saw in s.watched
    )
    return "".join(
        [
            '<!doctype html><html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width,initial-scale=1">',
            '<meta http-equiv="Content-Security-Policy" '
            "content=\"default-src 'none'; style-src 'unsafe-inline'\">",
            f"<title>First contact</title><style>{_STYLE}</style></head><body>",
            "<h1>First contact</h1>",
            f'<p class="refused">Ended: {escape(str(refused))}</p>' if refused else "",
            _answers(s),
            *(_picture(name, s.traces[name]) for name in _PLOTS if name in s.traces),
            "<h2>What was done, and what the robot reported</h2><table>" + watched + "</table>"
            if watched
            else "",
            f"<h2>Measured beside it</h2><ul>{notes}</ul>",
            _compared(s.known, robots),
            "<h2>For the table of known robots</h2>",
            f"<pre>{escape(row(s.known, 'YOUR ROBOT'))}</pre>",
            f"<h2>Steps</h2><ol>{steps}</ol></body></html>\n",
        ]
    )


def free_name(folder: Path) -> str:
    """Return a name for this session's recording, beside those of earlier ones."""
    names = ["contact.pcapng", *(f"contact.{k}.pcapng" for k in range(2, 1000))]
    return next(name for name in names if not (folder / name).exists())


def write(contact: Contact, folder: Path, name: str, robots: Robots) -> None:
    """Write the page, the recording under this name, and the archive with all that is to be sent.

    In the archive is nobody's address, name or date.
    """
    (folder / "contact.html").write_text(page(contact, robots), encoding="utf-8")
    if contact.session.log:
        (folder / name).write_bytes(recording(contact.session.log))
    kept = [folder / "robot.txt", folder / "contact.html", *sorted(folder.glob("contact*.pcapng"))]
    with zipfile.ZipFile(folder / "contact.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for path in kept:
            if path.exists():
                archive.writestr(zipfile.ZipInfo(path.name, _ZIP_DATE), path.read_bytes())
        if contact.session.known:
            known = row(contact.session.known, "YOUR ROBOT")
            archive.writestr(zipfile.ZipInfo("row.md", _ZIP_DATE), known + "\n")
