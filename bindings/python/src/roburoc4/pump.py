# SPDX-License-Identifier: MIT
"""A connection with a native thread, which needs no Python to keep the link alive.

It never renews a drive command: a program that hangs stops the robot. The thread knows nothing of
the objects here, so dropping the last reference ends it, with zero commands where they are due.
"""

import atexit
import contextlib
import weakref

from . import _native
from .connection import Connection, EventReader
from .errors import ArgumentError, ClosedError, NotKnownError, address_errors
from .records import Status
from .settings import Settings, buffer_of, config_of

_SLICE_S = 0.05
"""Waits are cut into slices, between which Python notices Ctrl-C."""


class PumpReader(EventReader):
    """A reader of a pump's events and statuses."""

    def __init__(self, handle: "_native.Connection") -> None:
        self._handle = handle
        self._reader = _native.new_reader()
        _native.roburoc4_pump_reader_init(handle, self._reader)

    @property
    def lost(self) -> int:
        return _native.reader_lost(self._reader)

    def take_events(self) -> int:
        return _native.roburoc4_pump_take_events(self._handle, self._reader)

    def statuses(self, mask: int) -> list[Status] | None:
        return _native.read_samples(self._handle, self._reader, mask)

    def wait(self, mask: int, seconds: float) -> bool:
        slice_us = int(max(0.0, min(seconds, _SLICE_S)) * 1e6)
        return _native.roburoc4_pump_wait_events(self._handle, self._reader, mask, slice_us) != 0


class PumpConnection(Connection):
    """A pump of roburoc4_pump.h."""

    def __init__(self, host: str, settings: Settings) -> None:
        with address_errors(host):
            self.handle = _native.connect_pump(host, config_of(settings), buffer_of(settings))
        self.address = _native.connection_address(self.handle)
        _living.add(self)

    def now_s(self) -> float:
        return _native.roburoc4_udp_now_us() / 1e6

    def description(self, io_type: int, index: int) -> bytes | None:
        try:
            return _native.roburoc4_pump_description(self.handle, io_type, index)
        except (NotKnownError, ArgumentError):
            return None

    def reader(self) -> PumpReader:
        return PumpReader(self.handle)

    def sleep(self, seconds: float) -> None:
        self.reader().wait(0, seconds)

    def close(self) -> None:
        with contextlib.suppress(ClosedError):  # a forked child has nothing to end
            _native.roburoc4_pump_close(self.handle)


_living: weakref.WeakSet[PumpConnection] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    for connection in list(_living):
        connection.close()
