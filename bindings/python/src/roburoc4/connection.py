# SPDX-License-Identifier: MIT
"""A client and the code that moves its datagrams: the base of the robot classes.

In ``pump.py`` a native thread moves them, in ``udp.py`` the user's calls, and in ``virtual.py`` a
simulator in virtual time. All other code works with any of them.
"""

import atexit
import contextlib
import errno
import os
import threading
import warnings
import weakref
from abc import ABC, abstractmethod
from collections.abc import Iterator

from . import _native
from .constants import Result
from .errors import (
    ArgumentError,
    NetworkError,
    NotKnownError,
    RecordingError,
    RobotError,
    is_within,
    unusable,
)
from .records import RecorderState, Status
from .settings import STATUS_MASK, Settings, buffer_of, config_of

SLICE_S = 0.05
"""Waits are cut into slices, between which Python notices Ctrl-C."""
ALL_EVENTS = 0x3FFFFFFF
STATUS_EVENTS = STATUS_MASK << 4
"""Events that announce statuses."""


def events_of_services(mask: int) -> int:
    """Return the events that announce statuses of the services in ``mask``."""
    return (mask & STATUS_MASK) << 4


_NO_PORT = "this simulator is in virtual time: give it a port, Simulator(port=0)"


def resolve(host: str) -> str:
    """Resolve "HOST", "HOST:PORT" or "[IPV6]:PORT" to a numeric address; may ask a name server."""
    try:
        return _native.roburoc4_udp_resolve(host, 0)
    except (TypeError, ValueError):
        raise ArgumentError(
            f"{host!r} is not an address: give HOST or HOST:PORT, such as 192.168.0.2:60000",
            Result.ADDRESS,
        ) from None
    except NetworkError as error:
        why = _NO_PORT if host == "virtual" else error
        raise NetworkError(f"{host!r}: {why}", error.code) from None


def open_alone(settings: Settings) -> "_native.Connection":
    """Make a client without a socket."""
    return _native.new_connection(None, config_of(settings), buffer_of(settings), None, None, 0, 0)


def open_host(host: str, threaded: bool, settings: Settings) -> "tuple[_native.Connection, str]":
    """Connect to a robot, and record it if the settings ask for that; with its address."""
    config = config_of(settings)
    record = settings.get("record")
    max_bytes = _limit(settings.get("record_max_bytes"), "record_max_bytes")
    max_s = _limit(settings.get("record_max_s"), "record_max_s")
    robot = resolve(host)
    pumped = robot if threaded else None
    _check_record(record)
    try:
        path = None if record is None else os.fspath(record)
        handle = _native.new_connection(
            pumped, config, buffer_of(settings), robot, path, max_bytes, max_s
        )
    except OSError as error:
        if record is None or error.filename is None:
            raise
        why = error.strerror
        if error.errno == errno.ENXIO:
            why = "nobody reads this pipe: start Wireshark first"
        raise RecordingError(
            f"record: {error.filename} cannot be written ({why})", Result.SYSTEM
        ) from None
    if not threaded:
        _native.connection_open_socket(handle, robot)
    return handle, robot


def _check_record(record: object) -> None:
    """Reject what is no path, and files that are called something else than captures are."""
    if record is None:
        return
    path = record
    with contextlib.suppress(TypeError):
        path = os.fspath(record)  # type: ignore[call-overload]
    if not isinstance(path, str) or "\0" in path or not 1 <= len(os.fsencode(path)) <= 1000:
        raise unusable("record", path, "a path of 1 to 1000 bytes, as str or Path", Result.CONFIG)
    is_new_or_file = os.path.isfile(path) or not os.path.exists(path)
    if is_new_or_file and not path.endswith(".pcapng"):
        raise unusable(
            "record", path, "a name that ends in .pcapng, or a folder that exists", Result.CONFIG
        )


_HIGHEST_LIMIT = (1 << 48) - 1


def _limit(value: float | None, name: str) -> int:
    if value is None:
        return 0
    if not is_within(1, value, _HIGHEST_LIMIT):
        raise unusable(name, value, f"1 to {_HIGHEST_LIMIT}, or None", Result.CONFIG)
    return int(value)


class EventReader:
    """A position in the events and statuses; used by one thread at a time."""

    def __init__(self, handle: "_native.Connection") -> None:
        self._handle = handle
        self._reader = _native.new_reader()
        _native.roburoc4_pump_reader_init(handle, self._reader)

    def now_s(self) -> float:
        """Return the time on the connection's clock."""
        return _native.connection_now_us(self._handle) / 1e6

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before this reader read them."""
        return _native.roburoc4_pump_reader_lost_get(self._reader)

    def take_events(self) -> int:
        """Take what happened since the last call; raises ClosedError after the end."""
        return _native.roburoc4_pump_take_events(self._handle, self._reader)

    def statuses(self, mask: int) -> list[Status] | None:
        """Take some more statuses of the services in ``mask``, without waiting.

        None if all were read; raises ClosedError if no more can come.
        """
        return _native.read_samples(self._handle, self._reader, mask)

    def wait(self, mask: int, seconds: float) -> bool:
        """Wait for an event in ``mask`` that was not taken; False when the time is over.

        It may return early, so that Ctrl-C is noticed. Raises ClosedError after the end.
        """
        wait_us = int(max(0.0, min(seconds, SLICE_S)) * 1e6)
        return _native.roburoc4_pump_wait_events(self._handle, self._reader, mask, wait_us) != 0


class Connection(ABC):
    """A client, called by its ``handle``: ``_native.roburoc4_client_facts(handle)``."""

    own_thread = False
    """Whether a native thread moves it, rather than calls of the user."""

    def __init__(self, handle: "_native.Connection", address: str) -> None:
        self.handle = handle
        self.address = address
        """The robot's address, for messages."""
        self._moving = threading.Lock()

    @contextlib.contextmanager
    def only_move(self) -> Iterator[None]:
        """Refuse a second move: each would end the other."""
        if not self._moving.acquire(blocking=False):
            raise RobotError("a move is under way: wait for its end, or call stop()", Result.STATE)
        try:
            yield
        finally:
            self._moving.release()

    def now_s(self) -> float:
        """Return the time on the clock of leases and timeouts."""
        return _native.connection_now_us(self.handle) / 1e6

    def description(self, io_type: int, index: int) -> bytes | None:
        """Return the robot's text for a channel, or (io_type -1) for a directory entry."""
        try:
            return _native.roburoc4_pump_description(self.handle, io_type, index)
        except (NotKnownError, ArgumentError):
            return None

    @property
    def recorder(self) -> RecorderState | None:
        """What was recorded so far; None if nothing is recorded."""
        return _native.connection_recorder_state(self.handle)

    def end_recording(self) -> None:
        """Complete the file, and warn if something is missing in it."""
        _native.connection_end_recording(self.handle)
        if (state := self.recorder) is not None and (state.dropped or state.system_error):
            cause = f" ({os.strerror(state.system_error)})" if state.system_error else ""
            warnings.warn(
                f"{state.path}: {state.dropped} datagrams are missing because the disk was full or "
                f"slow{cause}: free some space for the next recording",
                RuntimeWarning,
                stacklevel=3,
            )

    @abstractmethod
    def reader(self) -> EventReader:
        """Make a reader that starts now."""

    @abstractmethod
    def sleep(self, seconds: float) -> None:
        """Wait while datagrams are moved. It may return early, so that Ctrl-C is noticed."""

    @abstractmethod
    def close(self) -> None:
        """Stop the robot if it was driven, and end; from any thread, repeatedly."""

    def close_at_exit(self) -> None:
        """Call close() when the program ends, unless this was garbage-collected before."""
        _living.add(self)

    @property
    def closed(self) -> bool:
        """Whether close() was called, or this is the child of a fork."""
        return not _native.roburoc4_pump_running(self.handle)


_living: weakref.WeakSet[Connection] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    # Closing waits until the robot is at rest. Native threads stop their robots meanwhile, but
    # nothing serves connections without a thread: these come first. All are closed even if one
    # raises.
    with contextlib.ExitStack() as stack:
        for connection in sorted(_living, key=lambda each: not each.own_thread):
            stack.callback(connection.close)  # called last in, first out
