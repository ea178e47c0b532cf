# SPDX-License-Identifier: MIT
"""The robot for asyncio.

    async with roburoc4.aio.connect("192.168.0.2") as robot:
        await robot.arm()
        await robot.drive_for(0.5, 0.0, seconds=2)
        async for status in robot.statuses("localization"):
            ...

The link is kept alive by the same native thread as that of :func:`roburoc4.connect`: if the loop
hangs, the robot is stopped. Methods that do not wait are those of :class:`roburoc4.Robot`.
"""

import asyncio
import contextlib
import threading
import weakref
from collections.abc import AsyncIterator, Callable, Coroutine, Generator
from typing import Any, Literal, Self, TypeVar, Unpack, overload

from . import _native
from .connection import ALL_EVENTS, Connection, EventReader
from .constants import DEFAULT_HOST, Event, Service
from .errors import (
    ClosedError,
    check_heading,
    duration_s,
    finite,
    function,
    is_async,
    switch,
    timeout_s,
)
from .moves import Move, MoveResult, Progress
from .moving import Moving
from .pump import PumpConnection
from .records import (
    BatteryStatus,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    Status,
    TelemeterStatus,
)
from .robot_base import RELOCALIZE_S, RobotBase, true_or_unknown
from .samples import EventQueue, Patience, Reader, Recording, mask_of, name_of_statuses
from .settings import Settings, service_of
from .waiting import LOOK_AGAIN_S, Steps, arming, going, until

__all__ = ["Events", "Robot", "Statuses", "connect"]

_S = TypeVar("_S", bound=Status)
_T = TypeVar("_T")


class _Bell:
    """Wakes coroutines when a pump has news; a thread waits for it without the interpreter lock."""

    def __init__(self, connection: Connection) -> None:
        self._loop = asyncio.get_running_loop()
        self._waiting: set[asyncio.Future[None]] = set()
        threading.Thread(
            target=_listen,
            args=(
                connection.reader(),
                weakref.ref(connection),
                self._loop,
                weakref.WeakMethod(self._ring),
            ),
            name="roburoc4-aio",
            daemon=True,
        ).start()

    def _ring(self) -> None:
        for future in self._waiting:
            if not future.done():
                future.set_result(None)
        self._waiting.clear()

    async def wait(self, seconds: float) -> None:
        """Wait for news, at most this long."""
        future = self._loop.create_future()
        self._waiting.add(future)
        try:
            async with asyncio.timeout(seconds):
                await future
        except TimeoutError:
            pass
        finally:
            self._waiting.discard(future)


def _listen(
    reader: EventReader,
    connection: "weakref.ref[Connection]",
    loop: asyncio.AbstractEventLoop,
    ring: "weakref.WeakMethod[Callable[[], None]]",
) -> None:
    """Run in a thread, which ends with the connection, its bell, or the loop."""
    over = False
    while not over and connection() is not None:
        try:
            news = reader.wait(ALL_EVENTS, 1.0)
            reader.take_events()
        except ClosedError:
            news = over = True
        bell = ring()
        if bell is None:
            return
        if news:
            try:
                loop.call_soon_threadsafe(bell)
            except RuntimeError:
                return  # the loop is closed


class Robot(RobotBase, Moving[Coroutine[Any, Any, MoveResult]]):
    """A connected robot for asyncio; see :func:`connect`. It belongs to the loop that made it."""

    def __init__(self, connection: Connection, settings: Settings) -> None:
        super().__init__(connection, settings)
        self._bell = _Bell(connection)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Stop the robot if it was driven, and close the link; may be called repeatedly.

        A cancelled close continues by itself.
        """
        with contextlib.suppress(ClosedError):
            self.stop_if_driving()
        await asyncio.shield(asyncio.to_thread(self._connection.close))

    def stop_if_driving(self) -> None:
        """Send the first zero at once if a speed was sent."""
        facts = self.facts
        if facts.driving or facts.stopping:
            self.stop()

    async def _wait_until(
        self, condition: Callable[[], _T], timeout: float | None, what: object
    ) -> _T:
        return await self._wait(until(self._connection, condition, timeout, what))

    async def _wait(self, steps: Steps[_T]) -> _T:
        reader = self._connection.reader()
        try:
            while True:
                reader.take_events()  # raises ClosedError after the end
                wish = next(steps)
                await (self._bell.wait(wish) if isinstance(wish, float | int) else wish)
        except StopIteration as end:
            result: _T = end.value
            return result
        finally:
            steps.close()

    async def wait_ready(self, timeout: float = 10.0) -> None:
        """Wait until the robot is ready and has sent statuses; close and raise after silence."""
        readiness = self._readiness(timeout_s(timeout))
        try:
            await self._wait_until(readiness, None, None)
            await self._wait_until(self._has_first_statuses, None, None)
        except BaseException:
            await self.close()
            raise

    @overload
    async def wait_for(self, condition: Event, timeout: float | None = ...) -> Event: ...
    @overload
    async def wait_for(
        self, condition: Literal["iocard"], timeout: float | None = ...
    ) -> IoCardStatus: ...
    @overload
    async def wait_for(
        self, condition: Literal["telemeter"], timeout: float | None = ...
    ) -> TelemeterStatus: ...
    @overload
    async def wait_for(
        self, condition: Literal["battery"], timeout: float | None = ...
    ) -> BatteryStatus: ...
    @overload
    async def wait_for(
        self, condition: Literal["localization"], timeout: float | None = ...
    ) -> LocalizationStatus: ...
    @overload
    async def wait_for(
        self, condition: Literal["differential"], timeout: float | None = ...
    ) -> DifferentialStatus: ...
    @overload
    async def wait_for(self, condition: str | Service, timeout: float | None = ...) -> Status: ...
    @overload
    async def wait_for(
        self, condition: "Callable[[Robot], _T]", timeout: float | None = ...
    ) -> _T: ...

    async def wait_for(
        self,
        condition: "Event | str | Service | Callable[[Robot], object]",
        timeout: float | None = 10.0,
    ) -> object:
        """Wait for events, a status or a condition, as :meth:`roburoc4.Robot.wait_for` does."""
        if isinstance(condition, Event):
            events, reader = condition, self._connection.reader()
            return await self._wait_until(
                lambda: Event(reader.take_events()) & events, timeout, condition
            )
        if isinstance(condition, str | Service):
            service = service_of(condition)
            source: Reader[Status] = Reader(self._connection.reader(), 1 << service)
            return await self._wait_until(source.next, timeout, service)
        function("condition", condition)
        return await self._wait_until(true_or_unknown(condition, self), timeout, condition)

    async def arm(self, timeout: float = 10.0) -> None:
        """Allow driving, or raise NotArmedError; see :meth:`roburoc4.Robot.arm`."""
        end_s, stops = self._connection.now_s() + timeout_s(timeout), self._stops
        await self._wait(arming(lambda: self._try_to_arm(end_s, stops)))

    async def drive_for(self, linear_m_s: float, angular_rad_s: float, seconds: float) -> None:
        """See :meth:`roburoc4.Robot.drive_for`; cancelling it stops the robot."""
        end_s = self._end_of_drive_s(seconds)
        with self._connection.only_move():
            self.drive(linear_m_s, angular_rad_s)
            try:
                while (left_s := end_s - self._connection.now_s()) > 0:
                    self._renew(linear_m_s, angular_rad_s)
                    await asyncio.sleep(min(left_s, self._renewal_s))
                self._renew(0.0, 0.0)
            finally:
                self.pause()

    async def _go(self, move: Move, on_progress: Progress | None) -> MoveResult:
        if on_progress is not None and not is_async(on_progress):
            function("on_progress", on_progress)
        with self._connection.only_move():
            return await self._finish(move, on_progress)

    async def _finish(self, move: Move, on_progress: Progress | None = None) -> MoveResult:
        return await self._wait(going(move, on_progress))

    async def relocalize(self, x_m: float, y_m: float, theta_rad: float) -> None:
        """Set the robot's pose; wait for its answer and for a pose that follows it."""
        finite(x_m=x_m, y_m=y_m, theta_rad=theta_rad)
        check_heading(theta_rad)
        _native.roburoc4_client_relocalize(self._connection.handle, x_m, y_m, theta_rad)
        await self._wait_until(self._is_relocalized, RELOCALIZE_S, self.relocalize)
        if self.service_link(Service.LOCALIZATION).subscribed:
            await self.wait_for(Service.LOCALIZATION, RELOCALIZE_S)

    @overload
    def statuses(
        self, service: Literal["iocard"], /, *, timeout: float | None = ...
    ) -> "Statuses[IoCardStatus]": ...
    @overload
    def statuses(
        self, service: Literal["telemeter"], /, *, timeout: float | None = ...
    ) -> "Statuses[TelemeterStatus]": ...
    @overload
    def statuses(
        self, service: Literal["battery"], /, *, timeout: float | None = ...
    ) -> "Statuses[BatteryStatus]": ...
    @overload
    def statuses(
        self, service: Literal["localization"], /, *, timeout: float | None = ...
    ) -> "Statuses[LocalizationStatus]": ...
    @overload
    def statuses(
        self, service: Literal["differential"], /, *, timeout: float | None = ...
    ) -> "Statuses[DifferentialStatus]": ...
    @overload
    def statuses(
        self, *services: str | Service, timeout: float | None = ...
    ) -> "Statuses[Status]": ...
    def statuses(self, *services: str | Service, timeout: float | None = None) -> "Statuses[Any]":
        """Iterate over all statuses of these services; see :meth:`roburoc4.Robot.statuses`."""
        source: Reader[Status] = Reader(self._connection.reader(), mask_of(services))
        return Statuses(source, self._bell, timeout, name_of_statuses(services))

    def events(self, *, timeout: float | None = None) -> "Events":
        """Iterate over events from now on; see :meth:`roburoc4.Robot.events`."""
        return Events(EventQueue(self._connection.reader(), timeout), self._bell)

    async def record(self, seconds: float, *services: str | Service) -> Recording:
        """Collect the statuses of these services (none given: all) for this time, as columns."""
        duration_s("seconds", seconds)
        mask = mask_of(services)
        source: Reader[Status] = Reader(self._connection.reader(), mask)
        recording = Recording(mask, self.period_s)
        end_s = self._connection.now_s() + seconds
        while (left_s := end_s - self._connection.now_s()) > 0:
            await self._bell.wait(min(left_s, LOOK_AGAIN_S))
            source.drain(recording.add)
        recording.end(self.now_s)
        return recording


class Events(AsyncIterator[Event]):
    """Every event since it was created, for ``async for``."""

    def __init__(self, queue: EventQueue, bell: _Bell) -> None:
        self._queue = queue
        self._bell = bell

    def __aiter__(self) -> "Events":
        return self

    async def __anext__(self) -> Event:
        patience = self._queue.patience()
        try:
            while (event := self._queue.next()) is None:
                await self._bell.wait(min(LOOK_AGAIN_S, patience.left_s()))
        except ClosedError:
            raise StopAsyncIteration from None
        return event


class Statuses(AsyncIterator[_S]):
    """Every status since it was created, for ``async for``."""

    def __init__(self, source: Reader[_S], bell: _Bell, timeout: float | None, what: str) -> None:
        self._source = source
        self._bell = bell
        self._timeout = timeout
        self._what = what

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before they were read."""
        return self._source.lost

    def __aiter__(self) -> "Statuses[_S]":
        return self

    async def __anext__(self) -> _S:
        patience = Patience(self._source.now_s, self._timeout, self._what)
        try:
            while (status := self._source.next()) is None:
                await self._bell.wait(min(LOOK_AGAIN_S, patience.left_s()))
        except ClosedError:
            raise StopAsyncIteration from None
        return status


class _Connecting:
    """A robot to ``await``; ``async with`` also closes it."""

    def __init__(self, host: str, timeout: float, wait: bool, settings: Settings) -> None:
        self._host = host
        self._timeout = timeout
        self._wait = wait
        self._settings = settings
        self._robot: Robot | None = None

    async def _connect(self) -> Robot:
        connection = await asyncio.to_thread(PumpConnection, self._host, self._settings)
        robot = Robot(connection, self._settings)
        if self._wait:
            await robot.wait_ready(self._timeout)
        return robot

    def __await__(self) -> Generator[None, None, Robot]:
        return self._connect().__await__()

    async def __aenter__(self) -> Robot:
        self._robot = await self._connect()
        return self._robot

    async def __aexit__(self, *_: object) -> None:
        if self._robot is not None:
            await self._robot.close()


def connect(
    host: str = DEFAULT_HOST,
    *,
    timeout: float = 10.0,
    wait: bool = True,
    **settings: Unpack[Settings],
) -> _Connecting:
    """Connect to a robot, with ``async with`` or ``await``.

    The arguments are those of :func:`roburoc4.connect`. Properties cannot wait here, so this also
    waits for the first status of each service.
    """
    if wait := switch("wait", wait):
        timeout_s(timeout)
    return _Connecting(host, timeout, wait, settings)
