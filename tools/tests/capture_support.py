# SPDX-License-Identifier: MIT
"""Captures for tests, written without the package: bytes by the manual, files by their format."""

import math
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from roburoc4.protocol import usual_answer

ROBOT = (b"\xc0\xa8\x00\x02", 60000)
CLIENT = (b"\xc0\xa8\x00\x05", 40001)
OTHER = (b"\xc0\xa8\x00\x06", 40002)
BEGIN_US = 1_700_000_000_000_000

Endpoint = tuple[bytes, int]


class Packet(NamedTuple):
    time_us: int
    source: Endpoint
    destination: Endpoint
    payload: bytes


# ---- telegrams ----


def differential(
    cycles: int, target: float, speed: float, target_turn: float, turn: float
) -> bytes:
    return struct.pack("<BHQffff", 0xFF, 6, cycles, target, speed, target_turn, turn)


def localization(cycles: int, x_m: float, y_m: float, theta_rad: float) -> bytes:
    return struct.pack("<BHQdddI", 0xFF, 5, cycles, x_m, y_m, theta_rad, 4)


def battery(cycles: int, state: int, percent: int) -> bytes:
    return struct.pack("<BHQBB", 0xFF, 4, cycles, state, percent)


def telemeter(cycles: int, front_m: float, rear_m: float) -> bytes:
    return struct.pack("<BHQff", 0xFF, 3, cycles, front_m, rear_m)


def iocard(cycles: int, digital: int = 0, volts: float = 25.0) -> bytes:
    analog = (0.0, 0.0, volts, *(0.0,) * 6)
    return struct.pack("<BHQ9f", 0xFF, 2, cycles, *analog) + digital.to_bytes(3, "little")


def command(linear_m_s: float, angular_rad_s: float) -> bytes:
    return struct.pack("<BHff", 0xFF, 6, linear_m_s, angular_rad_s)


def requests() -> list[bytes]:
    """What a client requests first: properties, texts, subscriptions."""
    asked = [struct.pack("<BH", 0, service) for service in (0, 2, 3, 4, 5, 6)]
    asked += [struct.pack("<BHH", 1, 0, index) for index in range(7)]
    asked += [
        struct.pack("<BHBi", 1, 2, kind, index)
        for kind, count in ((0, 9), (2, 22), (3, 8))
        for index in range(count)
    ]
    periods = {2: 5, 3: 10, 4: 100, 5: 5, 6: 5}
    asked += [struct.pack("<BHHB", 4, 1, service, period) for service, period in periods.items()]
    return [bytes([1 + at]) + request for at, request in enumerate(asked)]


def discovery(begin_us: int = BEGIN_US, client: Endpoint = CLIENT) -> list[Packet]:
    packets = []
    for at, request in enumerate(requests()):
        time_us = begin_us + 1000 * at
        answer = usual_answer(request)
        assert answer
        packets.append(Packet(time_us, client, ROBOT, request))
        packets.append(Packet(time_us + 400, ROBOT, client, answer))
    return packets


def statuses(
    begin_us: int,
    seconds: float,
    first_cycles: int = 1000,
    client: Endpoint = CLIENT,
    digital: int = 0,
    speed: float = 0.5,
) -> list[Packet]:
    """Of a robot that drives in a circle of one metre with 0.5 m/s, or is at rest."""
    packets = []
    for cycle in range(0, round(seconds * 100), 5):
        time_us, cycles = begin_us + cycle * 10_000, first_cycles + cycle
        angle = speed * cycle / 100
        sent = [
            iocard(cycles, digital, 25.0 + cycle / 1000),
            localization(cycles, math.sin(angle), 1 - math.cos(angle), angle),
            differential(cycles, speed, 0.98 * speed, speed, 1.02 * speed),
        ]
        if cycle % 10 == 0:
            sent.append(telemeter(cycles, 2.0 + cycle / 1000, math.nan))
        if cycle % 100 == 0:
            sent.append(battery(cycles, 2, 90 - cycle // 100))
        packets += [Packet(time_us + 10 * at, ROBOT, client, data) for at, data in enumerate(sent)]
    return packets


def commands(begin_us: int, seconds: float, client: Endpoint = CLIENT) -> list[Packet]:
    return [
        Packet(begin_us + at * 50_000 + 7, client, ROBOT, command(0.5, 0.5))
        for at in range(round(seconds * 20))
    ]


def drive(seconds: float = 5.0) -> list[Packet]:
    """A client that asks, drives, and stops."""
    later_us = BEGIN_US + 100_000
    end_us = later_us + round(seconds * 1e6)
    packets = discovery() + statuses(later_us, seconds) + commands(later_us, seconds)
    packets += [Packet(end_us + at * 50_000, CLIENT, ROBOT, command(0, 0)) for at in range(3)]
    return sorted(packets, key=lambda packet: packet.time_us)


# ---- frames ----


def udp(packet: Packet) -> bytes:
    size = 8 + len(packet.payload)
    return struct.pack("!HHHH", packet.source[1], packet.destination[1], size, 0) + packet.payload


def ipv4(packet: Packet, *, body: bytes | None = None, number: int = 7, field: int = 0) -> bytes:
    body = udp(packet) if body is None else body
    head = struct.pack("!BBHHHBBH", 0x45, 0, 20 + len(body), number, field, 64, 17, 0)
    return head + packet.source[0] + packet.destination[0] + body


def ipv6(packet: Packet) -> bytes:
    body = udp(packet)
    hosts = b"".join(bytes(12) + end[0] for end in (packet.source, packet.destination))
    return struct.pack("!IHBB", 6 << 28, len(body), 17, 64) + hosts + body


def fragments(packet: Packet, size: int = 16) -> list[bytes]:
    body = udp(packet)
    parts = range(0, len(body), size)
    return [
        ipv4(packet, body=body[at : at + size], field=at // 8 | (at != parts[-1]) << 13)
        for at in parts
    ]


_ETHERNET = bytes(12)
LINKS = {
    "raw": (101, lambda data: data),
    "ethernet": (1, lambda data: _ETHERNET + b"\x08\x00" + data),
    # as Ethernet pads short frames
    "padded": (1, lambda data: (_ETHERNET + b"\x08\x00" + data).ljust(200, b"\xee")),
    "vlan": (1, lambda data: _ETHERNET + b"\x81\x00\x00\x05\x08\x00" + data),
    "two vlans": (1, lambda data: _ETHERNET + b"\x88\xa8\0\1\x81\x00\x00\x05\x08\x00" + data),
    "linux any": (113, lambda data: bytes(14) + b"\x08\x00" + data),
    "linux any 2": (276, lambda data: b"\x08\x00" + bytes(18) + data),
    "loopback": (0, lambda data: b"\x02\0\0\0" + data),
}


# ---- files ----


def _block(order: str, kind: int, body: bytes) -> bytes:
    size = struct.pack(order + "I", 12 + len(body))
    return struct.pack(order + "I", kind) + size + body + size


def _option(order: str, code: int, value: bytes) -> bytes:
    return struct.pack(order + "HH", code, len(value)) + value + bytes(-len(value) % 4)


def pcapng(
    packets: Iterable[Packet], *, link: str = "raw", order: str = "<", nanoseconds: bool = False
) -> bytes:
    number, frame = LINKS[link]
    section = struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1)
    interface = struct.pack(order + "HHI", number, 0, 0)
    if nanoseconds:
        interface += _option(order, 9, b"\x09") + _option(order, 14, struct.pack(order + "q", 1000))
        interface += bytes(4)
    data = _block(order, 0x0A0D0D0A, section) + _block(order, 1, interface)
    for packet in packets:
        data += enhanced(packet, frame(ipv4(packet)), order, nanoseconds=nanoseconds)
    return data


def enhanced(
    packet: Packet, frame: bytes, order: str = "<", *, nanoseconds: bool = False, dropped: int = 0
) -> bytes:
    stamp = packet.time_us
    if nanoseconds:
        stamp = (packet.time_us - 1_000_000_000) * 1000
    head = struct.pack(order + "IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(frame), len(frame))
    options = _option(order, 2, struct.pack(order + "I", 1 if packet.source == ROBOT else 2))
    if dropped:
        options += _option(order, 4, struct.pack(order + "Q", dropped))
    return _block(order, 6, head + frame + bytes(-len(frame) % 4) + options + bytes(4))


def pcap(
    packets: Iterable[Packet],
    *,
    link: str = "ethernet",
    order: str = "<",
    nanoseconds: bool = False,
) -> bytes:
    number, frame = LINKS[link]
    magic = 0xA1B23C4D if nanoseconds else 0xA1B2C3D4
    data = struct.pack(order + "IHHiIII", magic, 2, 4, 0, 0, 262144, number)
    for packet in packets:
        part = frame(ipv4(packet))
        seconds, fraction = divmod(packet.time_us, 1_000_000)
        fraction *= 1000 if nanoseconds else 1
        data += struct.pack(order + "IIII", seconds, fraction, len(part), len(part)) + part
    return data


def write(path: Path, packets: Iterable[Packet]) -> Path:
    """Write a recording as our recorder does."""
    path.write_bytes(pcapng(packets))
    return path
