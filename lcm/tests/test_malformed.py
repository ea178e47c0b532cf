# SPDX-License-Identifier: MIT
"""Whatever arrives on the LCM port, the bridge keeps running and the robot does not move."""

import random
import struct
import time
from collections.abc import Callable

from rig import Bridge, Bus, Robot, until
from rig.bus import drive_command, now_us

MAGIC_SHORT = 0x4C433032
MAGIC_LONG = 0x4C433033

StartBridge = Callable[..., Bridge]


def still_works(robot: Robot, bus: Bus, bridge: Bridge) -> None:
    assert bridge.running, bridge.output
    assert robot.tap.moves() == []
    before = len(bus.of("ROBUROC4_LOCALIZATION"))
    until(lambda: len(bus.of("ROBUROC4_LOCALIZATION")) > before + 3, "poses go on")
    bus.publish("ROBUROC4_DRIVE_CMD", drive_command(0.3, sender="honest").encode())
    until(robot.tap.moves, f"it can be driven; the bridge said:\n{bridge.output}")


def short_packet(channel: bytes, payload: bytes) -> bytes:
    return struct.pack(">II", MAGIC_SHORT, 1) + channel + b"\0" + payload


def test_packets_that_are_not_lcm_are_survived(robot: Robot, bus: Bus, willing: Bridge) -> None:
    channel = b"ROBUROC4_DRIVE_CMD"
    good = drive_command(0.5, utime=now_us() + 3_600_000_000).encode()
    packets = [
        b"",
        b"L",
        b"\0" * 3,
        struct.pack(">I", MAGIC_SHORT),
        struct.pack(">II", MAGIC_SHORT, 0),
        short_packet(b"", good),
        short_packet(b"x" * 300, good),
        struct.pack(">II", MAGIC_SHORT, 7) + b"no end of the channel" * 20,
        short_packet(channel, b""),
        # Fragments: a size of nothing, of too much, offsets beyond the end, and a last one only.
        struct.pack(">IIIIHH", MAGIC_LONG, 1, 0, 0, 0, 1) + channel + b"\0" + good,
        struct.pack(">IIIIHH", MAGIC_LONG, 2, 0xFFFFFFFF, 0, 0, 2) + channel + b"\0" + good,
        struct.pack(">IIIIHH", MAGIC_LONG, 3, 100, 0xFFFFFFF0, 1, 2) + good,
        struct.pack(">IIIIHH", MAGIC_LONG, 4, 100, 50, 7, 2) + good,
        struct.pack(">IIIIHH", MAGIC_LONG, 5, 100, 0, 0, 0) + channel + b"\0" + good,
        struct.pack(">IIII", MAGIC_LONG, 6, 100, 0),
    ]
    luck = random.Random(5)
    for _ in range(2000):
        packets.append(luck.randbytes(luck.randrange(200)))
        magic = luck.choice([MAGIC_SHORT, MAGIC_LONG])
        packets.append(struct.pack(">I", magic) + luck.randbytes(luck.randrange(200)))
    with bus.deaf():
        for packet in packets:
            bus.raw(packet)
        time.sleep(0.3)
    still_works(robot, bus, willing)


def test_a_fragment_whose_offset_wraps_is_survived(robot: Robot, bus: Bus, willing: Bridge) -> None:
    """These 59 bytes crash LCM 1.3.1, in its own code, unless the bridge has them dropped."""
    head = struct.pack(">IIIIHH", MAGIC_LONG, 77, 64, 0, 0, 2)
    wraps = struct.pack(">IIIIHH", MAGIC_LONG, 77, 64, 0xFFFFFFFF, 1, 2)
    with bus.deaf():
        for _ in range(20):
            bus.raw(head + b"ROBUROC4_DRIVE_CMD\0")
            bus.raw(wraps + b"x" * 39)
            bus.raw(wraps + b"x" * 1000)
        time.sleep(0.3)
    still_works(robot, bus, willing)
