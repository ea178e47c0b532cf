# SPDX-License-Identifier: MIT
"""What is kept: a recording with no address of anybody's network, and the page."""

import math
import struct
from html import escape
from pathlib import Path

from .contact import STEPS, Contact
from .wire import SERVICES

_ROBOT, _CLIENT = bytes([192, 0, 2, 2]), bytes([192, 0, 2, 1])  # of RFC 5737: nobody's
_ROBOT_PORT, _FIRST_PORT = 60000, 50000
_SECTION = struct.pack("<IIIHHqI", 0x0A0D0D0A, 28, 0x1A2B3C4D, 1, 0, -1, 28)
_INTERFACE = struct.pack("<IIHHII", 1, 20, 101, 0, 0, 20)  # raw IP, microseconds


def recording(log: list[tuple[float, int, bool, bytes]]) -> bytes:
    """Return the datagrams as a pcapng file."""
    blocks = [_SECTION, _INTERFACE]
    for at_s, port, sent, data in log:
        ends = [(_CLIENT, _FIRST_PORT + port), (_ROBOT, _ROBOT_PORT)]
        (source, from_port), (target, to_port) = ends if sent else ends[::-1]
        udp = struct.pack(">HHHH", from_port, to_port, 8 + len(data), 0) + data
        head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0) + source + target
        total = sum(struct.unpack(">10H", head))
        total = (total & 0xFFFF) + (total >> 16)
        packet = head[:10] + struct.pack(">H", ~(total + (total >> 16)) & 0xFFFF) + head[12:] + udp
        size = 32 + (len(packet) + 3 & ~3)
        us = round(at_s * 1e6)
        fields = (6, size, 0, us >> 32, us & 0xFFFFFFFF, len(packet), len(packet))
        blocks.append(struct.pack("<7I", *fields) + packet.ljust(size - 32, b"\0"))
        blocks.append(struct.pack("<I", size))
    return b"".join(blocks)


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

_STYLE = """:root{color-scheme:light dark}body{margin:0 auto;max-width:60rem;padding:1.5rem;
font:15px/1.5 system-ui,sans-serif}table{border-collapse:collapse}td,th{text-align:left;
padding:.2rem 1rem .2rem 0;border-bottom:1px solid #8884}.other{font-weight:600}
.refused{border-left:4px solid #b3261e;padding:.5rem 1rem}"""


def page(contact: Contact) -> str:
    """Write the page: answers, what differs from the manual, and which datagrams prove it."""
    usual = USUAL
    s = contact.session
    rows = []
    for name, value in s.known.items():
        differs = name in usual and not math.isclose(value, usual[name], abs_tol=1e-4)
        first, end = s.proof.get(name, (0, 0))
        proof = f"{first + 1} to {end}" if end else "an earlier session"
        rows.append(
            f'<tr class="{"other" if differs else ""}"><td>{escape(name)}</td><td>{value:g}</td>'
            f"<td>{format(usual[name], 'g') if differs else ''}</td><td>{proof}</td></tr>"
        )
    refused = contact.refused
    steps = "".join(
        f"<li>{escape(step.name)}{'' if step.name in contact.done else ': not done'}</li>"
        for step in STEPS
    )
    notes = "".join(f"<li>{escape(k)}: {v:g}</li>" for k, v in s.notes.items())
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
        "style-src 'unsafe-inline'\">"
        f"<title>First contact</title><style>{_STYLE}</style></head><body><h1>First contact</h1>"
        + (
            f'<p class="refused">Ended by: {escape(refused.reason)}. {escape(str(refused))}</p>'
            if refused
            else "<p>All steps were passed.</p>"
        )
        + "<p>Answers in bold differ from those that the manual suggests. The last column counts "
        "the datagrams of this session's recording.</p><table><tr><th>question</th><th>answer</th>"
        f"<th>manual</th><th>datagrams</th></tr>{''.join(rows)}</table>"
        f"<h2>Beside it</h2><ul>{notes}</ul><h2>Steps</h2><ol>{steps}</ol></body></html>\n"
    )


def free_name(folder: Path) -> str:
    """Return a name for this session's recording, beside those of earlier ones."""
    names = ["contact.pcapng", *(f"contact.{k}.pcapng" for k in range(2, 1000))]
    return next(name for name in names if not (folder / name).exists())


def write(contact: Contact, folder: Path, name: str) -> None:
    """Write the page, and the recording under this name, into the folder."""
    (folder / "contact.html").write_text(page(contact), encoding="utf-8")
    if contact.session.log:
        (folder / name).write_bytes(recording(contact.session.log))
