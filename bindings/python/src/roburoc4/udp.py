# SPDX-License-Identifier: MIT
"""A connection on a socket that its user spins: one thread, or another event loop.

Nothing moves datagrams while the program does other things. If the program hangs, only the robot's
own watchdog stops the robot.
"""

import contextlib
import math
import select
from collections.abc import Callable

from . import _native
from .connection import SLICE_S, open_host
from .errors import ClosedError, NetworkError
from .manual import ManualConnection
from .settings import Settings

_MARGIN_S = 0.5


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
        super().__init__(*open_host(host, False, settings), settings)
        self._moved_s, self._longest_pause_s = self.now_s(), 0.0
        self.close_at_exit()

    def __del__(self) -> None:
        if not getattr(self, "_left", True):
            self.close()

    def move(self, seconds: float, until: Callable[[], object]) -> None:
        del until  # return as soon as something arrived
        self._longest_pause_s, self._moved_s = self.longest_pause_s, self.now_s()
        if _native.connection_exchange(self.handle) == 0 and seconds > 0:
            wait_s = min(seconds, SLICE_S, self.next_deadline_s())
            _wait_readable(_native.roburoc4_udp_fd(self.handle), wait_s)
            _native.connection_exchange(self.handle)

    @property
    def longest_pause_s(self) -> float:
        """How long the program let all datagrams wait, since the pauses were forgotten."""
        return max(self._longest_pause_s, self.now_s() - self._moved_s)

    def forget_pauses(self) -> None:
        """Start over."""
        self._longest_pause_s = 0.0

    def spin(self, seconds: float) -> None:
        """Receive and send for this time; 0 does what is due and returns."""
        end_s = self.now_s() + seconds
        while True:
            self.sleep(end_s - self.now_s())
            if self.now_s() >= end_s:
                return

    def fileno(self) -> int:
        """Return the socket; only wait until it is readable."""
        self.check_open()
        return _native.roburoc4_udp_fd(self.handle)

    def next_deadline_s(self) -> float:
        """Return the seconds until spin(0) is due if nothing arrives."""
        deadline_us = _native.roburoc4_client_next_deadline(self.handle)
        return max(0.0, deadline_us / 1e6 - self.now_s())

    def leave(self) -> None:
        end_s = self.now_s() + self.watchdog_s + _MARGIN_S
        while not self.is_idle() and self.now_s() < end_s:
            with contextlib.suppress(NetworkError):  # a network that is down may come back
                self.move(SLICE_S, self.is_idle)
        with contextlib.suppress(ClosedError):
            _native.roburoc4_udp_close(self.handle)
        self.end_recording()
