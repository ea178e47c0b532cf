# SPDX-License-Identifier: MIT
"""The engine on a socket that its user spins: one thread, or somebody else's event loop.

Nobody keeps the link alive while the program does other things, so a program that hangs is
stopped by the robot's own watchdog only.
"""

import atexit
import contextlib
import math
import select
import weakref
from collections.abc import Callable

from . import _native
from .engine_client import ClientEngine
from .engine_pump import resolve
from .errors import NetworkError
from .settings import Settings

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


class UdpEngine(ClientEngine):
    """A client on a connected socket of roburoc4_udp.h."""

    def __init__(self, host: str, settings: Settings) -> None:
        super().__init__(settings)
        self._watchdog_s = settings.get("robot_watchdog_ms", 1000) / 1000
        address, _owner, self.address = resolve(host)
        self._udp = _native.new_udp()
        self._udp_owner = _native.own_memory(self._udp)
        _native.roburoc4_udp_open(self._udp, _native.roburoc4_udp_size(), address)
        self._start()
        _living.add(self)

    def __del__(self) -> None:
        if not getattr(self, "_left", True):
            self.close()

    def _now_us(self) -> int:
        return _native.roburoc4_udp_now_us()

    def _flush(self) -> None:
        _native.roburoc4_udp_transmit_all(self._udp, self._client)

    def _receive(self) -> bool:
        """Take what is there; what is due to be sent goes first. Whether there was any."""
        for taken in range(_BURST):
            outcome, datagram = _native.udp_receive(self._udp, self._client)
            if outcome == _NOTHING:
                return taken > 0
            self.collect(datagram)
            if _native.roburoc4_client_next_deadline(self._client) <= self._now_us():
                break
        return True

    def _turn(self, timeout_us: int) -> None:
        self._flush()
        if not self._receive() and timeout_us > 0:
            deadline_us = _native.roburoc4_client_next_deadline(self._client)
            wait_us = min(timeout_us, max(0, deadline_us - self._now_us()))
            _wait_readable(_native.roburoc4_udp_fd(self._udp), wait_us / 1e6)
            self._receive()
        self._flush()
        self.collect(b"")

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
        with self.lock:
            self.check_open()
            return _native.roburoc4_udp_fd(self._udp)

    def next_deadline_s(self) -> float:
        """Return the seconds until spin(0) is due if nothing comes in."""
        with self.lock:
            deadline_us = _native.roburoc4_client_next_deadline(self._client)
            return max(0.0, (deadline_us - self._now_us()) / 1e6)

    def _leave(self) -> None:
        end_s = self.now_s() + self._watchdog_s + _MARGIN_S
        while not self._is_idle() and self.now_s() < end_s:
            with contextlib.suppress(NetworkError):  # a network that is down may come back
                self._turn(_SLICE_US)
        _native.roburoc4_udp_close(self._udp)

    @property
    def fault(self) -> int:
        with self.lock:
            self._check_process()
            return _native.roburoc4_udp_fault(self._udp)


_living: weakref.WeakSet[UdpEngine] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    for engine in list(_living):
        engine.close()
