# SPDX-License-Identifier: MIT
"""Our own requests to a robot's port: who is there, and how fast it answers."""

from __future__ import annotations

import errno
import select
import socket
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import Self

_MANUALS_ID, _FIRST_ID, _LAST_ID = 1, 2, 254
_DENIED = {errno.EACCES, errno.EPERM}
_STATUS = b"\xff"
_PERIOD_CYCLES = 10
_FULL = {errno.EAGAIN, errno.ENOBUFS}


def other_source(robot: tuple[str, int], service_id: int, wait_s: float) -> str | None:
    """Subscribe to a service; return the address of its statuses if it is not the robot's.

    A connected socket, as that of the client, gets datagrams of the robot's own port only.
    """
    family = socket.AF_INET6 if ":" in robot[0] else socket.AF_INET
    with socket.socket(family, socket.SOCK_DGRAM) as unconnected:
        unconnected.sendto(_subscribe(service_id), robot)
        until_s = time.monotonic() + wait_s
        while (left_s := until_s - time.monotonic()) > 0.0:
            if select.select([unconnected], [], [], left_s)[0]:
                data, source = unconnected.recvfrom(2048)
                if data[:1] == _STATUS and source[:2] != robot:
                    host = f"[{source[0]}]" if ":" in source[0] else source[0]
                    return f"{host}:{source[1]}"
    return None


def _subscribe(service_id: int) -> bytes:
    insert, notification = 4, 1
    head = bytes((_FIRST_ID, insert, notification, 0))
    return head + service_id.to_bytes(2, "little") + bytes((_PERIOD_CYCLES,))


def _get_directory(request_id: int) -> bytes:
    return bytes((request_id, 0, 0, 0))


@dataclass
class Probe:
    """Requests the directory, which changes nothing, and counts the answers."""

    address: tuple[str, int]
    asked: int = 0
    answered: int = 0
    malformed: int = 0
    refused: int = 0
    fault: str = ""
    fault_detail: str = ""
    round_trips_s: list[float] = field(default_factory=list)
    contents: Counter[bytes] = field(default_factory=Counter)  # of the answers

    def __enter__(self) -> Self:
        family = socket.AF_INET6 if ":" in self.address[0] else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._sent_s: dict[int, float] = {}
        self._echoes: bool | None = None  # the ids of requests, as robots of the family do
        try:
            self._socket.connect(self.address)
        except OSError as error:
            self._note(error)
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    @property
    def round_trip_ms(self) -> float:
        """The mean time of an answer."""
        return 1e3 * sum(self.round_trips_s) / max(1, len(self.round_trips_s))

    @property
    def altered(self) -> int:
        """Answers unlike most others, although all are answers to the same request."""
        return self.contents.total() - max(self.contents.values(), default=0)

    def _next_id(self) -> int:
        """Return an id of its own, or the manual's; both by turns until one was answered."""
        if self._echoes is False or (self._echoes is None and self.asked % 2):
            return _MANUALS_ID
        return _FIRST_ID + self.asked % (_LAST_ID - _FIRST_ID + 1)

    def ask(self) -> None:
        """Send one request."""
        self._last_id = request_id = self._next_id()
        self.asked += 1
        self._sent_s[request_id] = time.monotonic()
        try:
            self._socket.send(_get_directory(request_id))
        except OSError as error:
            self._note(error)

    def listen(self, wait_s: float, *, until_answered: bool = False) -> None:
        """Receive for this long, or until the last request was answered.

        Listening on matters: what waits in the socket would be taken for slow.
        """
        until_s = time.monotonic() + wait_s
        while (left_s := until_s - time.monotonic()) > 0.0:
            if until_answered and (self.fault or self._last_id not in self._sent_s):
                return
            if select.select([self._socket], [], [], left_s)[0]:
                self._take()

    def _take(self) -> None:
        try:
            data = self._socket.recv(2048)
        except OSError as error:
            self._note(error)
            return
        if len(data) < 5 or data[1:4] != b"\0\0\0":
            self.answered += 1
            self.malformed += 1
        elif (sent_s := self._sent_s.pop(self._request_of(data[0]), None)) is not None:
            self.answered += 1
            self.contents[data[4:]] += 1
            self.round_trips_s.append(time.monotonic() - sent_s)

    def _request_of(self, answer_id: int) -> int:
        """Return the id that was sent; a robot like the manual answers each with the manual's."""
        if answer_id != _MANUALS_ID:
            self._echoes = True
            return answer_id
        if self._echoes is None and self.asked > 2:
            self._echoes = False
        return self._last_id

    def _note(self, error: OSError) -> None:
        if error.errno == errno.ECONNREFUSED:
            self.refused += 1
        elif error.errno not in _FULL and not self.fault:
            self.fault = "denied" if error.errno in _DENIED else "route"
            self.fault_detail = (error.strerror or str(error)).lower()
