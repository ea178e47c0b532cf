# SPDX-License-Identifier: MIT
"""The engine with a native thread, which needs no Python to keep the link alive.

It never renews a drive command: a program that hangs stops the robot. The thread knows nothing of
the objects here, so dropping the last reference ends it, with zero commands where they are due.
"""

import atexit
import contextlib
import os
import weakref
from typing import Any

from . import _native
from .constants import Result
from .engine import Engine, Reader
from .errors import ArgumentError, ClosedError, NetworkError, NotKnownError, error_of
from .records import Status
from .settings import Settings, buffer_of, config_of

_SLICE_S = 0.05
"""Waits are cut into slices, between which Python hears of Ctrl-C."""

_FUNCTIONS = {
    name.removeprefix("roburoc4_pump_"): getattr(_native, name)
    for name in dir(_native)
    if name.startswith("roburoc4_pump_")
}
_FUNCTIONS["stop"] = _FUNCTIONS.pop("stop_robot")


def resolve(host: str) -> tuple["_native.Address", object, str]:
    """Turn "HOST", "HOST:PORT" or "[IPV6]:PORT" into numbers, their owner, and a text."""
    address = _native.new_address()
    owner = _native.own_memory(address)
    try:
        _native.roburoc4_udp_resolve(host, 0, address)
    except ArgumentError:
        raise ArgumentError(
            f"{host!r} is no address: give HOST or HOST:PORT, such as 192.168.0.2:60000",
            Result.ARGUMENT,
        ) from None
    except NetworkError as error:
        raise NetworkError(f"{host!r}: {error}", error.code) from None
    return address, owner, _native.roburoc4_udp_address_text(address).decode("ascii")


class PumpReader(Reader):
    """A reader of a pump's samples."""

    def __init__(self, pump: "_native.Pump", pump_owner: object) -> None:
        self._pump = pump
        self._pump_owner = pump_owner
        self._reader = _native.new_reader()
        self._reader_owner = _native.own_memory(self._reader)
        _native.roburoc4_pump_reader_init(pump, self._reader)

    @property
    def lost(self) -> int:
        return _native.reader_lost(self._reader)

    def take_events(self) -> int:
        return _native.roburoc4_pump_take_events(self._pump, self._reader)

    def statuses(self, mask: int) -> list[Status] | None:
        return _native.samples_read(self._pump, self._reader, mask)

    def wait(self, mask: int, seconds: float) -> bool:
        slice_us = int(max(0.0, min(seconds, _SLICE_S)) * 1e6)
        return _native.roburoc4_pump_wait_events(self._pump, self._reader, mask, slice_us) != 0


class PumpEngine(Engine):
    """A pump of roburoc4_pump.h."""

    def __init__(self, host: str, settings: Settings) -> None:
        config, _config_owner = config_of(settings)
        address, _address_owner, self.address = resolve(host)
        self._pump = _native.roburoc4_pump_create(address, config, buffer_of(settings))
        self._pump_owner = _native.own_pump(self._pump)
        self._orphaned = False
        _living.add(self)

    def now_s(self) -> float:
        return _native.roburoc4_udp_now_us() / 1e6

    def orphan(self) -> None:
        """Be of no use from now on: the thread stayed in the process that forked."""
        self._orphaned = True

    def _check_process(self) -> None:
        if self._orphaned:
            raise error_of(Result.CLOSED)

    def call(self, name: str, *arguments: Any) -> Any:
        self._check_process()
        return _FUNCTIONS[name](self._pump, *arguments)

    def count(self, counter: int) -> int:
        self._check_process()
        return _native.roburoc4_pump_count(self._pump, counter)

    def description(self, io_type: int, index: int) -> bytes | None:
        try:
            return _native.roburoc4_pump_description(self._pump, io_type, index)
        except (NotKnownError, ArgumentError):
            return None

    def reader(self) -> PumpReader:
        return PumpReader(self._pump, self._pump_owner)

    def sleep(self, seconds: float) -> None:
        self.reader().wait(0, seconds)

    def close(self) -> None:
        with contextlib.suppress(ClosedError):  # a forked child has nothing to end
            _native.roburoc4_pump_close(self._pump)

    @property
    def closed(self) -> bool:
        return not _native.roburoc4_pump_running(self._pump)

    @property
    def fault(self) -> int:
        self._check_process()
        return _native.roburoc4_pump_fault(self._pump)


_living: weakref.WeakSet[PumpEngine] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    for engine in list(_living):
        engine.close()


def _orphan_all() -> None:
    for engine in list(_living):
        engine.orphan()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_orphan_all)
