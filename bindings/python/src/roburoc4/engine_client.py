# SPDX-License-Identifier: MIT
"""The engine around a bare client of roburoc4.h; its subclasses bring the network and the time."""

import os
import threading
import weakref
from abc import abstractmethod
from collections.abc import Callable
from typing import Any

from . import _native
from .constants import Event, Result, Service, State
from .engine import Engine, Reader
from .errors import error_of
from .log import Log
from .records import Status
from .settings import STATUS_SERVICES, Settings, buffer_of, config_of

_FUNCTIONS = {
    name.removeprefix("roburoc4_client_"): getattr(_native, name)
    for name in dir(_native)
    if name.startswith("roburoc4_client_")
}
_COMMANDS = frozenset(
    (
        "arm",
        "disarm",
        "drive",
        "stop",
        "set_digital_outputs",
        "set_analog_output",
        "relocalize",
        "subscribe",
        "unsubscribe",
        "set_role_index",
    )
)
_TIMED = _COMMANDS | {"facts", "link", "service_link"}
_READ_STATUS: dict[Service, Callable[["_native.Client"], Status]] = {
    Service.IOCARD: _native.roburoc4_client_inputs,
    Service.TELEMETER: _native.roburoc4_client_distances,
    Service.BATTERY: _native.roburoc4_client_battery,
    Service.LOCALIZATION: _native.roburoc4_client_localization,
    Service.DIFFERENTIAL: _native.roburoc4_client_differential,
}
_STATUS_EVENTS = (
    Event.IOCARD | Event.TELEMETER | Event.BATTERY | Event.LOCALIZATION | (Event.DIFFERENTIAL)
)


class LogReader(Reader):
    """A reader of a client engine's log."""

    def __init__(self, engine: "ClientEngine") -> None:
        self._engine = engine
        self._turn = engine.log.turn
        self._next = engine.log.next_sample
        self._lost = 0

    @property
    def lost(self) -> int:
        return self._lost

    def take_events(self) -> int:
        with self._engine.lock:
            log = self._engine.log
            events = log.events_after(self._turn)
            self._turn = log.turn
        if not events:
            self._engine.check_open()
        return events

    def statuses(self, mask: int) -> list[Status] | None:
        with self._engine.lock:
            log = self._engine.log
            if self._next == log.next_sample:
                self._engine.check_open()
                return None
            found, lost = log.statuses_from(self._next, mask)
            self._next = log.next_sample
            self._lost += lost
        return found

    def wait(self, mask: int, seconds: float) -> bool:
        with self._engine.lock:
            if self._engine.log.events_after(self._turn) & mask:
                return True
            self._engine.check_open()
            self._engine.sleep_until(
                seconds, lambda: self._engine.log.events_after(self._turn) & mask
            )
            return bool(self._engine.log.events_after(self._turn) & mask)


class ClientEngine(Engine):
    """A client, its log, and a lock: one thread at a time."""

    def __init__(self, settings: Settings) -> None:
        self.lock = threading.RLock()
        self.log = Log(buffer_of(settings))
        self._process = os.getpid()
        self._closed = True  # until the subclass has started the client
        self._left = True
        _engines.add(self)
        self._client = _native.new_client()
        self._client_owner = _native.own_memory(self._client)
        config, _owner = config_of(settings)
        _native.roburoc4_client_init(self._client, _native.roburoc4_client_size(), config)

    @abstractmethod
    def _now_us(self) -> int:
        """Return the time to tell the client."""

    @abstractmethod
    def _flush(self) -> None:
        """Send what the client has to send now."""

    @abstractmethod
    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        """Let time pass, at most until something is true."""

    def sleep(self, seconds: float) -> None:
        self.sleep_until(seconds, lambda: False)

    def now_s(self) -> float:
        return self._now_us() / 1e6

    def check_open(self) -> None:
        """Raise unless this can be used: not after close(), not in a forked child."""
        if self._closed or self._process != os.getpid():
            raise error_of(Result.CLOSED)

    def _check_process(self) -> None:
        if self._process != os.getpid():
            raise error_of(Result.CLOSED)

    def call(self, name: str, *arguments: Any) -> Any:
        with self.lock:
            self._check_process()
            if name in _COMMANDS:
                self.check_open()
            if name in _TIMED:
                arguments = (*arguments, self._now_us())
            try:
                return _FUNCTIONS[name](self._client, *arguments)
            finally:
                if name in _COMMANDS:
                    self._flush()
                    self.collect(b"")

    def collect(self, datagram: bytes) -> int:
        """Take the client's events, and what they tell of, into the log."""
        events = _native.roburoc4_client_take_events(self._client)
        if events:
            if events & _STATUS_EVENTS and not self._closed:
                for service in STATUS_SERVICES.values():
                    if events >> (service + 4) & 1:
                        self.log.note_status(service, _READ_STATUS[service](self._client))
            if events & Event.DESCRIPTION and datagram:
                described = _native.client_describe(self._client, datagram)
                if described is not None:
                    io_type, index, text = described
                    self.log.texts[io_type, index] = text
            self.log.note_events(events)
        return events

    def count(self, counter: int) -> int:
        with self.lock:
            self._check_process()
            return _native.roburoc4_client_count(self._client, counter)

    def description(self, io_type: int, index: int) -> bytes | None:
        return self.log.texts.get((io_type, index))

    def reader(self) -> LogReader:
        with self.lock:
            return LogReader(self)

    def _start(self) -> None:
        _native.roburoc4_client_start(self._client, self._now_us())
        self._closed = False
        self._left = False

    def _begin_to_leave(self) -> bool:
        """Disarm and send the first zero where one is due; False where that was done before."""
        if self._closed or self._process != os.getpid():
            return False
        self._closed = True
        _native.roburoc4_client_close(self._client, self._now_us())
        self._flush()
        return True

    def close(self) -> None:
        if self._process != os.getpid():
            return
        with self.lock:
            self._begin_to_leave()
            if not self._left:  # also where Ctrl-C cut short a close() before
                self._leave()
                self._left = True

    def unlock_in_child(self) -> None:
        """Make the lock anew: the thread that held it may not be in the child of a fork."""
        self.lock = threading.RLock()

    def _is_idle(self) -> bool:
        return _native.roburoc4_client_state(self._client) == State.IDLE

    @abstractmethod
    def _leave(self) -> None:
        """Let the zero commands out, then let go of the network."""

    @property
    def closed(self) -> bool:
        return self._closed or self._process != os.getpid()


_engines: weakref.WeakSet[ClientEngine] = weakref.WeakSet()


def _unlock_in_child() -> None:
    for engine in list(_engines):
        engine.unlock_in_child()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_unlock_in_child)
