# SPDX-License-Identifier: MIT
"""The logger ``roburoc4``: connections, losses, arming, and why connections ended."""

import contextlib
import functools
import threading
import weakref
from typing import TYPE_CHECKING

from . import _native
from .constants import Event, Result
from .errors import ClosedError
from .notices import FACTS, change_text

if TYPE_CHECKING:
    import logging

    from .connection import Connection

_INFO_LEVEL, _WARNING_LEVEL = 20, 30  # logging, imported with the first robot
_INFO = Event.READY | Event.ARMED | Event.OVERRIDE | Event.STOP_CONFIRMED | Event.RELOCALIZED
_WARNING = (
    Event.STOP_UNCONFIRMED
    | Event.LOST
    | Event.REBOOT
    | Event.DISARMED
    | Event.LAPSED
    | Event.OTHER_COMMANDER
    | Event.INHIBITED
    | Event.BATTERY_LOW
    | Event.BATTERY_CRITICAL
    | Event.RELOCALIZE_FAILED
    | Event.SUBSCRIPTION_REFUSED
    | Event.FIXED_ID
    | Event.CLOCK
    | Event.CAPACITY
)
_LOGGED = int(_INFO | _WARNING)


@functools.cache
def _logger() -> "logging.Logger":
    import logging

    logger = logging.getLogger("roburoc4")
    logger.addHandler(logging.NullHandler())
    return logger


class Log:
    """Logs the events of one connection."""

    def __init__(self, connection: "Connection") -> None:
        self._handle = connection.handle
        self._address = connection.address
        self._reader = _native.new_reader()  # from the beginning
        _logger().info("%s: connecting", self._address)

    @property
    def is_running(self) -> bool:
        """Whether there can be more to log."""
        return bool(_native.roburoc4_pump_running(self._handle))

    def step(self) -> None:
        """Log what happened since the last call."""
        with contextlib.suppress(ClosedError):
            events = _native.roburoc4_pump_take_events(self._handle, self._reader)
            if found := events & _LOGGED:
                for event in Event(found):
                    self._log(event)

    def end(self) -> None:
        """Log the remaining events, and the end."""
        self.step()
        _logger().info("%s: closing", self._address)

    def _log(self, event: Event) -> None:
        level = _WARNING_LEVEL if event in _WARNING else _INFO_LEVEL
        text = event.text
        facts = _native.roburoc4_client_facts(self._handle)
        if event is Event.DISARMED:
            cause = facts.disarm_cause
            by_program = cause in (Result.STOP_CALLED, Result.DISARMED)  # stop(), close()
            level = _INFO_LEVEL if by_program else level
            text = "stopped by this program" if by_program else f"disarmed: {cause.text}"
        elif event in FACTS:
            text = change_text(event, getattr(facts, FACTS[event]))
        _logger().log(level, "%s: %s", self._address, text)


_PERIOD_S, _LONGEST_STEP_S = 0.1, 2.0
_watched: weakref.WeakSet[Log] = weakref.WeakSet()
_lock = threading.Lock()
_closing = threading.Event()
_thread: threading.Thread | None = None


def watch(log: Log) -> None:
    """Log the events of a pump as they occur, from one thread for all of them."""
    global _thread
    with _lock:
        _watched.add(log)
        _closing.clear()
        if _thread is None or not _thread.is_alive():  # not in the child of a fork
            _thread = threading.Thread(target=_watch, name="roburoc4-log", daemon=True)
            with contextlib.suppress(RuntimeError):  # no threads here: logged at the end
                _thread.start()


def unwatch() -> None:
    """End the thread with the last pump: a subinterpreter cannot end before its threads."""
    with _lock:
        thread = None if _running() else _thread
        if thread is not None:
            _closing.set()
    if thread is not None and thread.is_alive() and thread is not threading.current_thread():
        thread.join(_LONGEST_STEP_S)  # not for ever: it may wait for a handler that closes a robot


def _running() -> list[Log]:
    return [log for log in _watched if log.is_running]


def _step_all() -> bool:
    """Log what happened; false if there is nothing left to watch."""
    global _thread
    with _lock:
        logs = _running()
        if not logs:
            _thread = None
    for log in logs:
        log.step()
    return bool(logs)


def _watch() -> None:
    _closing.wait(_PERIOD_S)
    while _step_all():  # which keeps no robot alive while this thread waits
        _closing.wait(_PERIOD_S)
