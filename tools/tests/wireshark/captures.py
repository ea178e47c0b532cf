# SPDX-License-Identifier: MIT
"""Captures made for tests, and what tshark shows of them."""

import contextlib
import os
import shutil
import struct
import subprocess
import tempfile
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
DISSECTOR = ROOT / "tools" / "wireshark" / "roburoc4.lua"
RAW_IP, ETHERNET, UPPER_PDU = 101, 1, 252
CLIENT, ROBOT = (b"\xc0\xa8\x00\x0a", 40000), (b"\xc0\xa8\x00\x02", 60000)
IP_UDP = 17

CAPTURE = "capture.pcapng"
NOBODY = 65534
# Wireshark 4.4 runs no Lua scripts for root.
USER: dict[str, Any] = (
    {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.geteuid() == 0 else {}
)

Packet = dict[str, list[str]]
"""What tshark shows of a packet: values by the name of the field, and its experts' names."""


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % 4)


def _option(code: int, value: bytes) -> bytes:
    return struct.pack("<HH", code, len(value)) + _padded(value)


def _block(kind: int, body: bytes) -> bytes:
    body = _padded(body)
    length = len(body) + 12
    return struct.pack("<II", kind, length) + body + struct.pack("<I", length)


def pcapng(
    link_type: int, frames: list[tuple[float, bytes]], snap: int = 65535, name: str = ""
) -> bytes:
    """A capture of frames with their times in seconds; with a name, as roburoc4_record.h has it."""
    out = _block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))
    label = _option(2, name.encode()) + bytes(4) if name else b""
    out += _block(1, struct.pack("<HHI", link_type, 0, 0) + label)
    for seconds, frame in frames:
        stamp = 1_700_000_000_000_000 + round(seconds * 1e6)
        head = struct.pack(
            "<IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(frame[:snap]), len(frame)
        )
        sent = 2 if frame[12:16] == CLIENT[0] else 1
        flags = _option(2, struct.pack("<I", sent)) + bytes(4) if name else b""
        out += _block(6, head + _padded(frame[:snap]) + flags)
    return out


def udp(data: bytes, to_robot: bool, port: int = ROBOT[1]) -> bytes:
    """A UDP datagram, without a checksum."""
    ends = (CLIENT[1], port) if to_robot else (port, CLIENT[1])
    return struct.pack(">HHHH", *ends, 8 + len(data), 0) + data


def _sum(data: bytes) -> int:
    total = sum(struct.unpack(f">{len(data) // 2}H", data))
    while total > 0xFFFF:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


def ip(payload: bytes, to_robot: bool, fragment: int = 0, more: bool = False) -> bytes:
    """An IPv4 packet; `fragment` is its offset in bytes."""
    ends = (CLIENT[0], ROBOT[0]) if to_robot else (ROBOT[0], CLIENT[0])
    where = fragment // 8 | (0x2000 if more else 0)
    head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(payload), 7, where, 64, IP_UDP, 0)
    head += ends[0] + ends[1]
    return head[:10] + struct.pack(">H", _sum(head)) + head[12:] + payload


def ethernet(packet: bytes, vlan: int | None = None) -> bytes:
    """An Ethernet frame, with a VLAN tag if wanted."""
    tag = b"" if vlan is None else struct.pack(">HH", 0x8100, vlan)
    return bytes(6) + b"\x02" + bytes(5) + tag + b"\x08\x00" + packet


def upper_pdu(data: bytes) -> bytes:
    """A telegram without a network, as programs export it."""
    name = b"roburoc4"
    return struct.pack(">HH", 12, len(name)) + name + struct.pack(">HH", 0, 0) + data


@contextlib.contextmanager
def home(capture: bytes) -> Iterator[str]:
    """A folder with the dissector and a capture named CAPTURE, of the user who runs tshark."""
    with tempfile.TemporaryDirectory() as folder:
        plugins = Path(folder) / ".local" / "lib" / "wireshark" / "plugins"
        plugins.mkdir(parents=True)
        shutil.copy(DISSECTOR, plugins)
        Path(folder, CAPTURE).write_bytes(capture)
        if USER:
            for path in (Path(folder), *Path(folder).rglob("*")):
                os.chown(path, NOBODY, NOBODY)
        yield folder


def _environment(folder: str) -> dict[str, str]:
    return {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder, "LC_ALL": "C.UTF-8"}


def run(*arguments: str, capture: bytes = b"") -> str:
    """What tshark prints, of a capture named CAPTURE; fails if tshark or a Lua script does."""
    with home(capture) as folder:
        done = subprocess.run(
            ["tshark", *arguments],
            cwd=folder,
            env=_environment(folder),
            capture_output=True,
            check=False,
            text=True,
            errors="replace",
            **USER,
        )
    assert done.returncode == 0, done.stderr
    assert "Lua" not in done.stderr, done.stderr
    return done.stdout


def read(capture: bytes, *options: str) -> str:
    """What tshark prints of a capture."""
    text = run("-r", CAPTURE, *options, capture=capture)
    at = text.find("Lua Error")
    assert at < 0, text[at : at + 1000]
    return text


def show(capture: bytes, *options: str) -> list[Packet]:
    """What tshark shows of each packet."""
    packets = []
    for element in ElementTree.fromstring(read(capture, "-T", "pdml", *options)).iter("packet"):
        packet: Packet = defaultdict(list)
        for field in element.iter("field"):
            name = field.get("name", "")
            if name.startswith("roburoc4"):
                packet[name].append(field.get("show", ""))
        for proto in element.iter("proto"):
            packet["protocols"].append(proto.get("name", ""))
        packets.append(packet)
    return packets


def experts(packet: Packet) -> list[str]:
    """The names of a packet's expert infos."""
    return sorted(
        name.removeprefix("roburoc4.expert.")
        for name, values in packet.items()
        if name.startswith("roburoc4.expert.")
        for _ in values
    )


class Talk:
    """A client and a robot, datagram by datagram."""

    def __init__(self, port: int = ROBOT[1]) -> None:
        self.port = port
        self.frames: list[tuple[float, bytes]] = []

    def ask(self, seconds: float, data: bytes) -> None:
        """The client sends."""
        self.frames.append((seconds, ip(udp(data, True, self.port), True)))

    def say(self, seconds: float, data: bytes) -> None:
        """The robot sends."""
        self.frames.append((seconds, ip(udp(data, False, self.port), False)))

    def show(self, *options: str) -> list[Packet]:
        """What tshark shows of it."""
        return show(pcapng(RAW_IP, self.frames), *options)
