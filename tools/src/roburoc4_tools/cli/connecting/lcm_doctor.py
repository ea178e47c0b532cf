# SPDX-License-Identifier: MIT
"""`roburoc4 doctor --lcm`: checks the way between an LCM program here and the bridges, both ways.

It speaks LCM's packets itself, so that what LCM hides can be named. The only command that it sends
is one that every bridge rejects: a speed of zero without a time.
"""

from __future__ import annotations

import errno
import os
import select
import socket
import struct
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self
from urllib.parse import parse_qsl, urlsplit

from ..errors import ExitCode, usage
from ..output import print_json
from .verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
_LISTEN_S = 1.0  # as long as five states of a bridge take
_ASK_EVERY_S = 0.2
_STATE, _COMMAND = "_BRIDGE_STATE", "_DRIVE_CMD"
_SMALL, _FRAGMENT = 0x4C433032, 0x4C433033
_MULTICAST_FLAG = 0x1000
_BUFFER = 2 << 20  # what LCM's own pages ask for
_CLOCK_S = 0.1  # a bridge rejects commands by 0.2 s
_LOSS_SHARE = 0.01


@dataclass
class Network:
    """What an LCM URL says."""

    url: str
    group: str = ""
    port: int = 0
    ttl: int = 0

    @classmethod
    def read(cls, url: str) -> Self:
        """Read a URL as LCM does."""
        parts = urlsplit(url)
        keys = dict(parse_qsl(parts.query))
        try:
            group = parts.hostname or "239.255.76.67"
            found = cls(url, group, parts.port or 7667, int(keys.get("ttl", "0")))
            multicast = 224 <= socket.inet_aton(group)[0] < 240 and group.count(".") == 3
        except (ValueError, OSError):
            multicast = False
        if parts.scheme != "udpm" or not multicast or not 0 <= found.ttl <= 255:
            raise usage(f"--lcm: '{url}' cannot be used: give udpm://239.255.76.67:7667?ttl=1")
        return found


@dataclass
class Bridge:
    """A bridge that was heard."""

    channel: str
    robot: str
    host: str
    clock_s: float  # its clock minus this one's
    drive_enabled: bool
    hears_us: bool = False


@dataclass
class LcmFindings:
    """What was measured. `fault`: "" or why there is no multicast here."""

    network: Network
    interface: str = ""
    fault: str = ""
    fault_detail: str = ""
    receive_bytes: int = 0  # the largest receive buffer that the system allows, 0: unknown
    heard_self: bool = False
    received: int = 0
    lost: int = 0
    bridges: list[Bridge] = field(default_factory=list)
    ttl_needed: int | None = None  # with which the bridges hear us

    @property
    def loss(self) -> float:
        """Share of the packets of all senders that did not arrive."""
        return self.lost / max(1, self.received + self.lost)

    @property
    def mute(self) -> list[Bridge]:
        """Bridges that do not hear this computer."""
        return [bridge for bridge in self.bridges if not bridge.hears_us]


class _Member:
    """A member of the multicast group, with a socket to listen and one to send, as LCM has them."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._numbers: dict[tuple[str, int], set[int]] = {}
        self._sequence = 0

    def join(self) -> None:
        """Join the group on the interface that the system chooses, as LCM does."""
        self._ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if sys.platform == "darwin":
            self._ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self._ear.bind(("", self._network.port))
        member = socket.inet_aton(self._network.group) + socket.inet_aton("0.0.0.0")
        self._ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)

    def close(self) -> None:
        self._end.close()
        self._ear.close()

    def send(self, channel: str, data: bytes, ttl: int) -> None:
        """Publish a message."""
        head = struct.pack(">II", _SMALL, self._sequence)
        self._sequence += 1
        self._end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        to = (self._network.group, self._network.port)
        self._end.sendto(head + channel.encode() + b"\0" + data, to)

    def listen(self, seconds: float, hear: Callable[[str, bytes, str], object]) -> None:
        """Call `hear` with the channel, data and host of each message, until it returns True."""
        until_s = time.monotonic() + seconds
        while (left_s := until_s - time.monotonic()) > 0.0:
            if not select.select([self._ear], [], [], left_s)[0]:
                return
            packet, source = self._ear.recvfrom(65535)
            if len(packet) < 8:
                continue
            magic, number = struct.unpack_from(">II", packet)
            if magic in {_SMALL, _FRAGMENT}:
                self._numbers.setdefault(source, set()).add(number)
            channel, ends, data = packet[8:].partition(b"\0")
            if (
                magic == _SMALL
                and ends
                and hear(channel.decode("ascii", "replace"), data, source[0])
            ):
                return

    def count(self) -> tuple[int, int]:
        """Return how many packets arrived, and how many are missing between them."""
        got = sum(len(numbers) for numbers in self._numbers.values())
        # A sender's number begins anew when it is started again, or after 2**32 packets.
        spans = (max(numbers) - min(numbers) + 1 for numbers in self._numbers.values())
        gaps = [
            span - len(numbers) for span, numbers in zip(spans, self._numbers.values(), strict=True)
        ]
        return got, sum(gap for gap in gaps if gap < 1 << 16)


# ----------------------------------------------------------------------------------- the checks


def run(url: str, *, as_json: bool) -> int:
    """Check, and report."""
    say = _silent if as_json else _say
    network = Network.read(url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL)
    found = LcmFindings(network)
    member = _Member(network)
    try:
        if _check_way(found, member, say):
            _check_bridges(found, member, say)
    finally:
        member.close()
    verdict = judge(found)
    if as_json:
        print_json({**asdict(found), "loss": found.loss, "verdict": asdict(verdict)})
    else:
        print(f"\nverdict {verdict.number}, {verdict.name}: {verdict.sentence}")
        print(f"next: {verdict.remedy}")
    return verdict.code


def _say(good: bool, check: str, text: str) -> None:
    print(f"{'ok  ' if good else 'BAD '}  {check:<10} {text}", flush=True)


def _silent(good: bool, check: str, text: str) -> None:
    del good, check, text


def _check_way(found: LcmFindings, member: _Member, say: Callable[[bool, str, str], None]) -> bool:
    """Route, interface, buffers, and whether we hear ourselves."""
    network = found.network
    channel = f"ROBUROC4_DOCTOR_{os.getpid()}"
    try:
        member.join()
        member.send(channel, b"", network.ttl)
    except OSError as error:
        no_route = error.errno in {errno.ENETUNREACH, errno.ENODEV, errno.EHOSTUNREACH}
        found.fault = "route" if no_route else "denied"
        found.fault_detail = (error.strerror or str(error)).lower()
        say(False, "route", f"none for {network.group}: {found.fault_detail}")
        return False
    found.interface = _interface_to(network.group)
    if found.interface and not _flags(found.interface) & _MULTICAST_FLAG:
        found.fault = "interface"
    say(not found.fault, "route", f"{network.group} through {found.interface or 'an interface'}")
    found.receive_bytes = _allowed_buffer()
    if found.receive_bytes:
        text = f"{found.receive_bytes >> 10} KiB at most (net.core.rmem_max)"
        say(found.receive_bytes >= _BUFFER, "buffers", text)

    def is_ours(name: str, data: bytes, host: str) -> bool:
        del data, host
        found.heard_self = found.heard_self or name == channel
        return found.heard_self

    member.listen(0.5, is_ours)
    say(
        found.heard_self, "multicast", "heard" if found.heard_self else "not heard on this computer"
    )
    return found.heard_self and not found.fault


def _check_bridges(
    found: LcmFindings, member: _Member, say: Callable[[bool, str, str], None]
) -> None:
    from roburoc4_lcm import bridge_state_t, drive_command_t

    heard: dict[str, Bridge] = {}
    command = drive_command_t()
    command.sender = f"roburoc4 doctor {os.getpid()}"  # and a utime of 0

    def hear(name: str, data: bytes, host: str) -> bool:
        if name.endswith(_STATE):
            try:
                state = bridge_state_t.decode(data)
            except (ValueError, struct.error):
                return False
            clock_s = state.utime / 1e6 - time.time()
            bridge = Bridge(name, state.robot, host, clock_s, state.drive_enabled)
            bridge = heard.setdefault(name, bridge)
            bridge.hears_us = bridge.hears_us or state.rejected_sender == command.sender
        return False

    def ask(ttl: int) -> None:
        """Send what every bridge rejects, and hear who says so."""
        found.bridges = sorted(heard.values(), key=lambda bridge: bridge.channel)
        for bridge in found.mute:
            channel = bridge.channel.removesuffix(_STATE) + _COMMAND
            member.send(channel, command.encode(), ttl)
        member.listen(_ASK_EVERY_S, hear)

    end_s = time.monotonic() + _LISTEN_S
    while time.monotonic() < end_s:
        ask(found.network.ttl)
    if found.network.ttl < 1:
        before = len(found.mute)
        while found.mute and time.monotonic() < end_s + _LISTEN_S:
            ask(1)
        found.ttl_needed = 1 if len(found.mute) < before else None
    found.received, found.lost = member.count()
    say(bool(found.bridges), "bridges", ", ".join(b.channel for b in found.bridges) or "none")
    if found.bridges:
        text = "every bridge hears this computer"
        if found.mute:
            text = f"{', '.join(bridge.channel for bridge in found.mute)} hears nothing"
        elif found.ttl_needed is not None:
            text = f"only with ttl={found.ttl_needed}, not with {found.network.ttl}"
        say(not found.mute and found.ttl_needed is None, "both ways", text)
        say(found.loss <= _LOSS_SHARE, "loss", f"{found.lost} of {found.received + found.lost}")


def _interface_to(group: str) -> str:
    """Return the interface of the route to a group, "" where the system does not tell."""
    best = (-1, 0, "")
    (to,) = struct.unpack("=I", socket.inet_aton(group))  # in the order of /proc/net/route
    try:
        lines = Path("/proc/net/route").read_text("ascii").splitlines()[1:]
    except OSError:
        return ""
    for line in lines:
        name, destination, _, _, _, _, metric, mask = line.split()[:8]
        bits = int(mask, 16)
        if to & bits == int(destination, 16):
            best = max(best, (bits.bit_count(), -int(metric), name))
    return best[2]


def _flags(interface: str) -> int:
    """Return the IFF_* flags of an interface of Linux."""
    import fcntl

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("256s", interface.encode()[:15])
        answer = fcntl.ioctl(any_socket.fileno(), 0x8913, request)  # SIOCGIFFLAGS
    (flags,) = struct.unpack_from("=H", answer, 16)
    return int(flags)


def _allowed_buffer() -> int:
    try:
        return int(Path("/proc/sys/net/core/rmem_max").read_text("ascii"))
    except (OSError, ValueError):
        return 0


# ---------------------------------------------------------------------------------- the results


def judge(found: LcmFindings) -> Verdict:
    """Return the first problem, in the order in which one would fix them."""
    return _no_multicast(found) or _bridges(found) or _quality(found) or _healthy(found)


def _no_multicast(found: LcmFindings) -> Verdict | None:
    group, gone = found.network.group, ExitCode.UNREACHABLE
    if found.fault == "route":
        return Verdict(
            20,
            "lcm route",
            gone,
            f"this computer has no route for multicast to {group} ({found.fault_detail})",
            "alone: ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo; in a lab: "
            "ip route add 224.0.0.0/4 dev eth0",
        )
    if found.fault == "interface":
        return Verdict(
            21,
            "lcm interface",
            gone,
            f"{found.interface}, which has the route to {group}, does not take part in multicast",
            f"ip link set {found.interface} multicast on, or a route through another interface",
        )
    if found.fault or not found.heard_self:
        return Verdict(
            22,
            "lcm multicast",
            gone,
            "this computer does not hear its own multicast"
            + (f" ({found.fault_detail})" if found.fault_detail else ""),
            f"allow UDP to {group}:{found.network.port} in this computer's firewall",
        )
    return None


def _bridges(found: LcmFindings) -> Verdict | None:
    url = found.network.url
    if not found.bridges:
        alone = found.interface == "lo"
        return Verdict(
            23,
            "no bridge",
            ExitCode.UNREACHABLE,
            f"no bridge is heard at {url}"
            + (" (multicast stays on this computer: its route goes through lo)" if alone else ""),
            "start roburoc4-lcm; on another computer: the same URL, ttl=1 in it, a route through "
            "the network's interface on both, and an IGMP querier if a switch snoops",
        )
    if found.ttl_needed is not None:
        return Verdict(
            24,
            "one way",
            ExitCode.REFUSED,
            f"the bridge at {found.bridges[0].host} is heard, but hears this computer only with a "
            f"ttl of {found.ttl_needed}: the URL here has {found.network.ttl}",
            f"export LCM_DEFAULT_URL='udpm://{found.network.group}:{found.network.port}"
            f"?ttl={found.ttl_needed}'",
        )
    if found.mute:
        names = ", ".join(bridge.channel for bridge in found.mute)
        return Verdict(
            24,
            "one way",
            ExitCode.REFUSED,
            f"{names} is heard, but its bridge hears nothing of this computer",
            "on the bridge's computer: its firewall, and its route for 224.0.0.0/4; between them: "
            "switches and access points that filter multicast; or its command channel is renamed",
        )
    return None


def _quality(found: LcmFindings) -> Verdict | None:
    if found.loss > _LOSS_SHARE:
        small = 0 < found.receive_bytes < _BUFFER
        return Verdict(
            25,
            "lcm loss",
            ExitCode.REFUSED,
            f"{found.loss:.0%} of the LCM packets do not arrive",
            "sysctl -w net.core.rmem_max=8388608, and recv_buf_size=4194304 in the URL"
            if small
            else "use the cable: Wi-Fi does not repeat multicast; or lessen what is published",
        )
    late = max(found.bridges, key=lambda bridge: abs(bridge.clock_s))
    if abs(late.clock_s) > _CLOCK_S:
        return Verdict(
            26,
            "clock",
            ExitCode.REFUSED,
            f"the clock of {late.host} is {abs(late.clock_s):.1f} s "
            f"{'ahead' if late.clock_s > 0 else 'behind'}: its bridge rejects old commands",
            "synchronize the clocks of both computers with NTP",
        )
    return None


def _healthy(found: LcmFindings) -> Verdict:
    watching = [bridge.channel for bridge in found.bridges if not bridge.drive_enabled]
    return Verdict(
        0,
        "healthy",
        ExitCode.FINE,
        "every bridge that is heard hears this computer, too",
        f"driving is not enabled (--enable-drive) for {', '.join(watching)}"
        if watching
        else "nothing to fix",
    )
