# SPDX-License-Identifier: MIT
"""What connections without a native thread share: waiting calls move the datagrams."""

import contextlib
from abc import abstractmethod
from collections.abc import Callable

from . import _native
from .connection import Connection, EventReader
from .constants import Result, State
from .errors import ClosedError, error_of
from .log import Log
from .settings import Settings


class ManualReader(EventReader):
    """A reader that moves datagrams while it waits."""

    def __init__(self, connection: "ManualConnection") -> None:
        super().__init__(connection.handle)
        self._connection = connection

    def _is_waiting(self, mask: int) -> bool:
        return super().wait(mask, 0.0)

    def wait(self, mask: int, seconds: float) -> bool:
        if not self._is_waiting(mask):
            self._connection.move(seconds, lambda: self._is_waiting(mask))
            self._connection.log.step()
        return self._is_waiting(mask)


class ManualConnection(Connection):
    """A client whose datagrams Python moves."""

    def __init__(self, handle: "_native.Connection", address: str, settings: Settings) -> None:
        super().__init__(handle, address)
        self.watchdog_s = settings.get("robot_watchdog_ms", 1000) / 1000
        self._left = False
        self.log = Log(self)

    @abstractmethod
    def move(self, seconds: float, until: Callable[[], object]) -> None:
        """Let time pass, at most until something is true; it may return early."""

    def check_open(self) -> None:
        """Raise an error if this cannot be used: after close(), or in a forked child."""
        if self.closed:
            raise error_of(Result.CLOSED)

    def reader(self) -> ManualReader:
        return ManualReader(self)

    def sleep(self, seconds: float) -> None:
        self.check_open()
        self.move(seconds, lambda: False)
        self.log.step()

    def is_idle(self) -> bool:
        """Whether all zero commands have been sent."""
        return _native.roburoc4_client_state(self.handle) == State.IDLE

    @abstractmethod
    def leave(self) -> None:
        """Send the zero commands, then close the socket."""

    def close(self) -> None:
        if self._left or not self._belongs_here():
            return
        self.log.end()
        self.disarm_for_good()
        self.leave()
        self._left = True  # not if Ctrl-C interrupted it: then the next close() continues

    def disarm_for_good(self) -> None:
        """Disarm, and send the first zero command if a speed was sent; then refuse commands.

        The other zeros are sent as time passes, until the client is idle.
        """
        for close in (_native.roburoc4_client_close, _native.roburoc4_pump_close):
            with contextlib.suppress(ClosedError):
                close(self.handle)

    def _belongs_here(self) -> bool:
        """Whether this is not the child of a fork."""
        try:
            _native.roburoc4_client_state(self.handle)
        except ClosedError:
            return False
        return True
