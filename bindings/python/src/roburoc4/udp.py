# SPDX-License-Identifier: MIT
"""A connection on a socket that its user spins: one thread, or somebody else's event loop.

Nothing moves datagrams while the program does other things, so a program that hangs is stopped by
the robot's own watchdog only.
"""

import atexit
import contextlib
import math
import select
import weakref
from collections.abc import Callable

from . import _native
from .errors import NetworkError, address_errors
from .manual import ManualConnection
from .settings import Settings, config_of

_SLICE_US = 50_000
_BURST = 64
_MARGIN_S = 0.5
_NOTHING = 0


def _wait_readable(fd: int, seconds: float) -> None:
    if hasattr(select, "poll"):
        watched = select.poll()
        watched.register(fd, select.POLLIN)
        watched.poll(math.ceil(seconds * 1e3))
    else:
        select.select([fd], [], [], seconds)


class SocketConnection(ManualConnection):
    """A client on a connected socket of roburoc4_udp.h."""

    def __init__(self, host: str, settings: Settings) -> None:
        with address_errors(host):
            handle = _native.connect_socket(host, config_of(settings))
        super().__init__(handle, settings)
        self.address = _native.connection_address(handle)
        self._watchdog_s = settings.get("robot_watchdog_ms", 1000) / 1000
        _living.add(self)

    def __del__(self) -> None:
        if not getattr(self, "_left", True):
            self.close()

    def flush(self) -> None:
        _native.roburoc4_udp_transmit_all(self.handle, self.handle)

    def _now_us(self) -> int:
        return _native.roburoc4_udp_now_us()

    def _receive(self) -> bool:
        """Take what is there; what is due to be sent goes first. Whether there was any."""
        for taken in range(_BURST):
            outcome, datagram = _native.roburoc4_udp_receive_one(self.handle, self.handle)
            if outcome == _NOTHING:
                return taken > 0
            self.collect(datagram)
            if _native.roburoc4_client_next_deadline(self.handle) <= self._now_us():
                break
        return True

    def _turn(self, timeout_us: int) -> None:
        self.flush()
        if not self._receive() and timeout_us > 0:
            deadline_us = _native.roburoc4_client_next_deadline(self.handle)
            wait_us = min(timeout_us, max(0, deadline_us - self._now_us()))
            _wait_readable(_native.roburoc4_udp_fd(self.handle), wait_us / 1e6)
            self._receive()
        self.flush()
        self.collect()

    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        del until  # one turn ends as soon as something came
        with self.lock:
            self.check_open()
            self._turn(min(_SLICE_US, max(0, int(seconds * 1e6))))

    def spin(self, seconds: float) -> None:
        """Receive and send for so long; 0 does what is due and returns."""
        end_s = self.now_s() + seconds
        while True:
            with self.lock:
                self.check_open()
                self._turn(max(0, min(_SLICE_US, int((end_s - self.now_s()) * 1e6))))
            if self.now_s() >= end_s:
                return

    def fileno(self) -> int:
        """Return the socket; only watch it."""
        self.check_open()
        return _native.roburoc4_udp_fd(self.handle)

    def next_deadline_s(self) -> float:
        """Return the seconds until spin(0) is due if nothing comes in."""
        deadline_us = _native.roburoc4_client_next_deadline(self.handle)
        return max(0.0, (deadline_us - self._now_us()) / 1e6)

    def _leave(self) -> None:
        end_s = self.now_s() + self._watchdog_s + _MARGIN_S
        while not self._is_idle() and self.now_s() < end_s:
            with contextlib.suppress(NetworkError):  # a network that is down may come back
                self._turn(_SLICE_US)
        _native.roburoc4_udp_close(self.handle)


_living: weakref.WeakSet[SocketConnection] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    for connection in list(_living):
        connection.close()
