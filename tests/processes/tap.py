# SPDX-License-Identifier: MIT
"""A tap on the wire between bridge and robot: it passes everything on and writes it down."""

import math
import select
import socket
import struct
import threading
from typing import NamedTuple

import roburoc4

_SO_TIMESTAMPNS = 35  # Linux; not in the socket module
_NO_PEER = ("", 0)


class Telegram(NamedTuple):
    time_us: int
    """Arrival by the kernel's clock, in epoch microseconds: busy test processes falsify nothing."""
    data: bytes


class Command(NamedTuple):
    time_us: int
    linear_m_s: float
    angular_rad_s: float

    @property
    def moves(self) -> bool:
        return self.linear_m_s != 0 or self.angular_rad_s != 0


def _socket() -> socket.socket:
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    end.bind(("127.0.0.1", 0))
    end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    end.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
    end.setblocking(False)
    return end


def _receive(end: socket.socket) -> tuple[Telegram, tuple[str, int]] | None:
    try:
        data, ancillary, _, sender = end.recvmsg(65536, 64)
    except (BlockingIOError, ConnectionRefusedError):
        return None
    time_us = 0
    for level, kind, value in ancillary:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS:
            seconds, nanoseconds = struct.unpack("qq", value[:16])
            time_us = seconds * 1_000_000 + nanoseconds // 1000
    assert time_us, "the kernel gives no time stamps"
    return Telegram(time_us, data), sender


class Tap:
    """For the bridge the robot is at ``address``."""

    def __init__(self, robot: str) -> None:
        host, port = robot.rsplit(":", 1)
        self._front = _socket()
        self._back = _socket()
        self._robot = (host, int(port))
        self._bridge = _NO_PEER
        self._wake, self._woken = socket.socketpair()
        self.address = f"127.0.0.1:{self._front.getsockname()[1]}"
        self.cut = False
        """Nothing gets through, as when somebody pulls the cable."""
        self.to_robot: list[Telegram] = []
        self.from_robot: list[Telegram] = []
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._wake.send(b"x")
        self._thread.join()
        for end in (self._front, self._back, self._wake, self._woken):
            end.close()

    def _run(self) -> None:
        while True:
            ready, _, _ = select.select([self._front, self._back, self._woken], [], [])
            if self._woken in ready:
                return
            while (got := _receive(self._front)) is not None:
                self._bridge = got[1]
                self.to_robot.append(got[0])
                self._pass(self._back, got[0].data, self._robot)
            while (got := _receive(self._back)) is not None:
                self._hand_on(got[0])

    def _pass(self, end: socket.socket, data: bytes, receiver: tuple[str, int]) -> None:
        if not self.cut and receiver != _NO_PEER:
            end.sendto(data, receiver)

    def _hand_on(self, telegram: Telegram) -> None:
        if not self.cut:
            self.from_robot.append(telegram)
            self._pass(self._front, telegram.data, self._bridge)

    def commands(self, since_us: int = 0) -> list[Command]:
        """All speed commands that reached the robot, in their order."""
        found = []
        for time_us, data in list(self.to_robot):
            if time_us >= since_us and data[:1] == b"\xff":
                said = roburoc4.protocol.decode(data, sender="client")
                if isinstance(said, roburoc4.protocol.DifferentialCommand):
                    assert math.isfinite(said.linear_m_s), said
                    assert math.isfinite(said.angular_rad_s), said
                    found.append(Command(time_us, *said))
        return found

    def moves(self, since_us: int = 0) -> list[Command]:
        """Those of them that move it."""
        return [command for command in self.commands(since_us) if command.moves]

    def statuses(self) -> list[tuple[int, roburoc4.Status]]:
        """All statuses that were handed to the bridge, with their arrival at the tap."""
        found = []
        for time_us, data in list(self.from_robot):
            if data[:1] == b"\xff":
                said = roburoc4.protocol.decode(data)
                assert isinstance(said, roburoc4.Status), said
                found.append((time_us, said))
        return found
