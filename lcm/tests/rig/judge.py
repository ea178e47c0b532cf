# SPDX-License-Identifier: MIT
"""Who may drive: a judge of the speeds sent to robots, written from docs/SAFETY.md and lcm.md.

It knows nothing of the bridge's code. It reads what was delivered on the wire, commands on LCM and
speeds to robots, and what was done to hosts, bridges and robots meanwhile, and it says which speeds
nobody was allowed to ask for.
"""

import math
import struct
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import roburoc4_lcm

LATE_US = 200_000
"""What a busy machine and lost statuses may add to the times that are promised."""
PAUSE_US = 500_000
TOLERANCE_US = 30_000
MAX_AGE_US = 200_000
SEEN_US = 350_000
"""Within this time a client sees what happened to its robot, or finds its statuses too old."""


class Ask(NamedTuple):
    """A drive command that a bridge's host was given."""

    time_us: int
    utime: int
    sender: str
    linear_m_s: float
    angular_rad_s: float
    lease_us: int

    @property
    def moves(self) -> bool:
        return self.linear_m_s != 0 or self.angular_rad_s != 0


class Speed(NamedTuple):
    """A speed that a robot was given."""

    time_us: int
    host: int
    linear_m_s: float
    angular_rad_s: float

    @property
    def moves(self) -> bool:
        return self.linear_m_s != 0 or self.angular_rad_s != 0


@dataclass
class Robot:
    """What there is to know of one robot; times in epoch microseconds."""

    may_drive: frozenset[int] = frozenset()
    """The hosts whose bridges were started to obey drive commands for it."""
    timeout_us: int = 300_000
    speeds: list[Speed] = field(default_factory=list)
    asks: dict[int, list[Ask]] = field(default_factory=lambda: defaultdict(list))
    stops: dict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    overrides: list[tuple[int, int]] = field(default_factory=list)
    """When somebody held [A], from and until."""
    blackouts: list[tuple[int, int]] = field(default_factory=list)
    """When it was off."""


@dataclass
class Host:
    starts: list[int] = field(default_factory=list)
    hangs: list[tuple[int, int]] = field(default_factory=list)
    """When its bridge was stopped, from and until."""


class Judge:
    def __init__(self, robots: dict[str, Robot], hosts: dict[int, Host]) -> None:
        self.robots = robots
        self.hosts = hosts
        self.judged = 0

    def complaints(self) -> Iterator[str]:
        for name, robot in self.robots.items():
            before: tuple[Speed, str] | None = None
            for speed in robot.speeds:
                if speed.moves:
                    self.judged += 1
                    wrong, sender = self._judge(robot, speed, before)
                    if wrong:
                        yield f"{name}: {speed}: {wrong}"
                    before = (speed, sender)
                else:
                    before = None  # a zero: its lease has ended, or it asked for that

    def _judge(
        self, robot: Robot, speed: Speed, before: tuple[Speed, str] | None
    ) -> tuple[str, str]:
        now_us = speed.time_us
        if speed.host not in robot.may_drive:
            return "from a bridge that only watches", ""
        asks = robot.asks[speed.host]
        started_us = self._started(speed.host, now_us)
        causes = [ask for ask in self._allowed(robot, speed.host, now_us) if self._is(ask, speed)]
        if not causes:
            return "no command that holds asked for it", ""
        sender = causes[-1].sender
        if any(begun + SEEN_US + LATE_US < now_us < ended for begun, ended in robot.overrides):
            return "somebody holds [A]", sender
        for held_us, why in self._holds(robot, speed.host, now_us, started_us):
            if not self._paused(asks, held_us, now_us):
                return f"no pause since {why} at {held_us}", sender
        if before is not None and before[1] not in ("", sender) and before[0].host == speed.host:
            owner = [ask for ask in self._valid(asks, started_us) if ask.sender == before[1]]
            if all(self._in_control(robot, owner, before[0], ask) for ask in causes):
                return f"{before[1]} is in control", sender
        return "", sender

    @staticmethod
    def _is(ask: Ask, speed: Speed) -> bool:
        """Every sender asks for speeds that only it asks for."""
        return (
            abs(ask.linear_m_s - speed.linear_m_s) < 1e-4
            and abs(ask.angular_rad_s - speed.angular_rad_s) < 1e-4
        )

    def _started(self, host: int, now_us: int) -> int:
        starts = self.hosts[host].starts
        return starts[bisect_right(starts, now_us) - 1]

    @staticmethod
    def _valid(asks: list[Ask], started_us: int) -> Iterator[Ask]:
        """Commands that are no replays, and not from before the bridge's start."""
        latest: dict[str, int] = {}
        for ask in asks:
            fresh = abs(ask.time_us - ask.utime) <= MAX_AGE_US + TOLERANCE_US
            good = (
                0 < len(ask.sender.encode()) <= 63
                and math.isfinite(ask.linear_m_s)
                and math.isfinite(ask.angular_rad_s)
                and fresh
                and ask.utime > max(latest.get(ask.sender, 0), started_us)
            )
            if good:
                latest[ask.sender] = ask.utime
                yield ask

    def _allowed(self, robot: Robot, host: int, now_us: int) -> list[Ask]:
        """Commands whose lease covers now."""
        asks = robot.asks[host]
        end = bisect_right(asks, now_us, key=lambda ask: ask.time_us)
        begin = bisect_right(asks, now_us - 5_000_000, key=lambda ask: ask.time_us)
        return [
            ask
            for ask in self._valid(asks[begin:end], self._started(host, now_us))
            if now_us - self._arrived(host, ask) <= self._lease(robot, ask) + LATE_US
        ]

    @staticmethod
    def _lease(robot: Robot, ask: Ask) -> int:
        return min(ask.lease_us if ask.lease_us > 0 else robot.timeout_us, robot.timeout_us)

    def _arrived(self, host: int, ask: Ask) -> int:
        """What came while the bridge hung counts from when that began."""
        for begun, ended in self.hosts[host].hangs:
            if begun <= ask.time_us <= ended:
                return begun
        return ask.time_us

    @staticmethod
    def _holds(robot: Robot, host: int, now_us: int, started_us: int) -> Iterator[tuple[int, str]]:
        """The last of each event after which all senders must pause."""
        yield started_us, "the start"
        events = {
            "a stop command": [(at, at) for at in robot.stops[host]],
            "[A]": [(begun, begun + SEEN_US + LATE_US) for begun, _ in robot.overrides],
            "its silence": [(begun, begun + 1_000_000 + LATE_US) for begun, _ in robot.blackouts],
        }
        for why, times in events.items():
            past = [at for at, seen in times if max(seen, at + LATE_US) < now_us]
            if past:
                yield past[-1], why

    @staticmethod
    def _paused(asks: list[Ask], held_us: int, now_us: int) -> bool:
        """Whether nobody asked for a speed for PAUSE_US, from held_us on."""
        begin = bisect_right(asks, held_us, key=lambda ask: ask.time_us)
        last_us = held_us
        for ask in asks[begin:]:
            if ask.time_us > now_us:
                break
            if ask.time_us - last_us >= PAUSE_US - TOLERANCE_US:
                return True
            if ask.moves:
                last_us = ask.time_us
        return now_us - last_us >= PAUSE_US - TOLERANCE_US

    def _in_control(self, robot: Robot, owner: list[Ask], last: Speed, ask: Ask) -> bool:
        """Whether the sender of the last speed still had control when this command came.

        Its commands follow one another without a gap that is as long as a lease, and without a
        zero, from its last speed until then.
        """
        at = bisect_right(owner, last.time_us, key=lambda each: each.time_us) - 1
        if at < 0:
            return False
        until_us = 0
        for each in owner[at:]:
            if each.time_us > ask.time_us or not each.moves:
                break
            if until_us and each.time_us > until_us - TOLERANCE_US:
                break
            until_us = each.time_us + self._lease(robot, each)
        else:
            each = owner[-1]
        ended_by_zero = each.time_us <= ask.time_us and not each.moves
        return not ended_by_zero and ask.time_us < until_us - TOLERANCE_US


# ------------------------------------------------------------------------------- the record


def read_record(path: Path, robots: dict[str, Robot], hosts: tuple[int, ...]) -> None:
    """What `wire` wrote down, into the robots: the Nth robot listens on port 60000 + N."""
    names = list(robots)
    data = path.read_bytes()
    at = 0
    while at < len(data):
        time_us, left_by, size = struct.unpack_from("=QII", data, at)
        source, (port,) = data[at + 16 : at + 20], struct.unpack_from(">H", data, at + 26)
        payload = data[at + 28 : at + 28 + size]
        at += 28 + size
        if port == 7667:
            if left_by in hosts:
                _hear(robots, left_by, time_us, payload)
        elif source[3] - 1 in hosts and len(payload) >= 11 and port - 60000 < len(names):
            speed = Speed(time_us, source[3] - 1, *struct.unpack_from("<ff", payload, 3))
            robots[names[port - 60000]].speeds.append(speed)
    for robot in robots.values():
        robot.speeds.sort()


def _hear(robots: dict[str, Robot], host: int, time_us: int, packet: bytes) -> None:
    """A short message of LCM: magic, number, channel, data."""
    channel, _, data = packet[8:].partition(b"\0")
    name, _, kind = channel.decode().partition("_")
    if name not in robots:
        return
    if kind == "STOP_CMD":
        robots[name].stops[host].append(time_us)
    elif kind == "DRIVE_CMD":
        said = roburoc4_lcm.drive_command_t.decode(data)
        robots[name].asks[host].append(
            Ask(
                time_us, said.utime, said.sender, said.linear_m_s, said.angular_rad_s, said.lease_us
            )
        )
