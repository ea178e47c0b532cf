# SPDX-License-Identifier: MIT
"""The blocking robot, and the function that connects to one."""

import contextlib
import math
from collections.abc import Callable
from typing import Any, Literal, Self, TypeVar, Unpack, overload

from . import _native
from .connection import ALL_EVENTS
from .constants import DEFAULT_HOST, Event, Result, Service
from .errors import (
    NOT_ASYNC,
    NotArmedError,
    NotKnownError,
    RobotTimeoutError,
    check_heading,
    duration_s,
    finite,
    function,
    is_within,
    switch,
    timeout_s,
    unusable,
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
from .robot_base import (
    RELOCALIZE_S,
    RobotBase,
    in_condition,
    true_or_unknown,
)
from .samples import (
    EventQueue,
    Events,
    Reader,
    Recording,
    Statuses,
    mask_of,
    name_of_statuses,
)
from .settings import Settings, service_of
from .udp import SocketConnection
from .waiting import Steps, arming, going, until

__all__ = ["Robot", "UnthreadedRobot", "connect"]

_T = TypeVar("_T")
_LONG_PAUSE_S = 0.25


class Robot(RobotBase, Moving[MoveResult]):
    """A connected robot, to be used in a ``with`` block; see :func:`connect`.

    All methods can be called from any thread. Leaving the block, an exception, Ctrl-C and garbage
    collection stop the robot.
    """

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop the robot if it was driven, and close the link; from any thread, repeatedly.

        The latest values can still be read; commands raise ClosedError.
        """
        self._connection.close()

    # ---- waiting ----

    def _wait_until(self, condition: Callable[[], _T], timeout: float | None, what: object) -> _T:
        return self._wait(until(self._connection, condition, timeout, what))

    def _wait(self, steps: Steps[_T]) -> _T:
        reader = self._connection.reader()
        try:
            while True:
                reader.take_events()
                wish = next(steps)
                if not isinstance(wish, float | int):
                    raise unusable("on_progress", wish, NOT_ASYNC)
                reader.wait(ALL_EVENTS, wish)
        except StopIteration as end:
            result: _T = end.value
            return result
        finally:
            steps.close()

    def wait_ready(self, timeout: float = 10.0) -> None:
        """Wait until the robot is ready, as ``connect`` does; close and raise after silence."""
        readiness = self._readiness(timeout_s(timeout))
        try:
            self._wait_until(readiness, None, None)
        except BaseException:
            self.close()
            raise

    @overload
    def wait_for(self, condition: Event, timeout: float | None = ...) -> Event: ...
    @overload
    def wait_for(
        self, condition: Literal["iocard"], timeout: float | None = ...
    ) -> IoCardStatus: ...
    @overload
    def wait_for(
        self, condition: Literal["telemeter"], timeout: float | None = ...
    ) -> TelemeterStatus: ...
    @overload
    def wait_for(
        self, condition: Literal["battery"], timeout: float | None = ...
    ) -> BatteryStatus: ...
    @overload
    def wait_for(
        self, condition: Literal["localization"], timeout: float | None = ...
    ) -> LocalizationStatus: ...
    @overload
    def wait_for(
        self, condition: Literal["differential"], timeout: float | None = ...
    ) -> DifferentialStatus: ...
    @overload
    def wait_for(self, condition: str | Service, timeout: float | None = ...) -> Status: ...
    @overload
    def wait_for(self, condition: "Callable[[Robot], _T]", timeout: float | None = ...) -> _T: ...

    def wait_for(
        self,
        condition: "Event | str | Service | Callable[[Robot], object]",
        timeout: float | None = 10.0,
    ) -> object:
        """Wait for something and return it; raises RobotTimeoutError after ``timeout`` seconds.

        A service ("localization"): its next status. Events: those that happen after this call. A
        function of the robot: its first true value; it is called after every event, and may raise
        NotKnownError as long as something is unknown.
        """
        if isinstance(condition, Event):
            events, reader = condition, self._connection.reader()
            return self._wait_until(
                lambda: Event(reader.take_events()) & events, timeout, condition
            )
        if isinstance(condition, str | Service):
            return self._wait_for_status(service_of(condition), timeout)
        function("condition", condition)
        return self._wait_until(true_or_unknown(condition, self), timeout, condition)

    def _wait_for_status(self, service: Service, timeout: float | None) -> Status | None:
        source = self._source(service)
        return self._wait_until(source.next, timeout, service)

    def _first(self, service: Service) -> Status:
        """Read the latest status; wait for the first one for up to two of its periods."""
        try:
            return super()._first(service)
        except NotKnownError:
            if in_condition.get():
                raise
            left_s = self._first_status_until_s(service) - self._connection.now_s()
            if left_s <= 0 or self.closed:
                raise
        with contextlib.suppress(RobotTimeoutError):  # super() raises an error that explains more
            self._wait_for_status(service, left_s)
        return super()._first(service)

    # ---- driving ----

    def arm(self, timeout: float = 10.0) -> None:
        """Allow driving, or raise NotArmedError with the reason why not.

        Waits if the reason will pass by itself: no status yet, or a robot that is still rolling.
        ``stop`` from another thread ends the wait.
        """
        end_s, stops = self._connection.now_s() + timeout_s(timeout), self._stops
        self._wait(arming(lambda: self._try_to_arm(end_s, stops)))

    def drive_for(self, linear_m_s: float, angular_rad_s: float, seconds: float) -> None:
        """Drive for this time, then pause. Blocks, and renews the command from this thread.

        Raises NotArmedError, after stopping, as soon as driving is no longer allowed, as after
        ``stop`` from another thread; and RobotError with the code LAPSED if the program was blocked
        for longer than its lease, which has stopped the robot.
        """
        end_s = self._end_of_drive_s(seconds)
        with self._connection.only_move():
            self.drive(linear_m_s, angular_rad_s)
            try:
                while (left_s := end_s - self._connection.now_s()) > 0:
                    self._renew(linear_m_s, angular_rad_s)
                    self.sleep(min(left_s, self._renewal_s))
                self._renew(0.0, 0.0)
            finally:
                self.pause()

    def sleep(self, seconds: float) -> None:
        """Wait on the robot's clock, also in virtual time; not at all if ``seconds`` is below 0."""
        passed = is_within(-math.inf, seconds, 0.0)
        end_s = self._connection.now_s() + duration_s("seconds", 0.0 if passed else seconds)
        while (left_s := end_s - self._connection.now_s()) > 0:
            self._connection.sleep(left_s)

    # ---- moves ----

    def _go(self, move: Move, on_progress: Progress | None) -> MoveResult:
        if on_progress is not None:
            function("on_progress", on_progress)
        with self._connection.only_move():
            return self._finish(move, on_progress)

    def _finish(self, move: Move, on_progress: Progress | None = None) -> MoveResult:
        return self._wait(going(move, on_progress))

    # ---- odometry ----

    def relocalize(self, x_m: float, y_m: float, theta_rad: float) -> None:
        """Set the robot's pose; wait for its answer and for a pose that follows it.

        Raises RefusedError; RobotTimeoutError without an answer in 2 s or a pose 3 s later.
        """
        finite(x_m=x_m, y_m=y_m, theta_rad=theta_rad)
        check_heading(theta_rad)
        _native.roburoc4_client_relocalize(self._connection.handle, x_m, y_m, theta_rad)
        self._wait_until(self._is_relocalized, RELOCALIZE_S, self.relocalize)
        if self.service_link(Service.LOCALIZATION).subscribed:
            self._wait_for_status(Service.LOCALIZATION, RELOCALIZE_S)

    # ---- statuses ----

    def _source(self, *services: str | Service) -> Reader[Status]:
        return Reader(self._connection.reader(), mask_of(services))

    @overload
    def statuses(
        self, service: Literal["iocard"], /, *, timeout: float | None = ...
    ) -> Statuses[IoCardStatus]: ...
    @overload
    def statuses(
        self, service: Literal["telemeter"], /, *, timeout: float | None = ...
    ) -> Statuses[TelemeterStatus]: ...
    @overload
    def statuses(
        self, service: Literal["battery"], /, *, timeout: float | None = ...
    ) -> Statuses[BatteryStatus]: ...
    @overload
    def statuses(
        self, service: Literal["localization"], /, *, timeout: float | None = ...
    ) -> Statuses[LocalizationStatus]: ...
    @overload
    def statuses(
        self, service: Literal["differential"], /, *, timeout: float | None = ...
    ) -> Statuses[DifferentialStatus]: ...
    @overload
    def statuses(
        self, *services: str | Service, timeout: float | None = ...
    ) -> Statuses[Status]: ...
    def statuses(self, *services: str | Service, timeout: float | None = None) -> Statuses[Any]:
        """Iterate over all statuses of these services (none given: all) from now on.

        Waits for each status. After ``timeout`` seconds RobotTimeoutError is raised; the following
        ``next()`` waits again. Iteration continues after the link was lost, and ends at ``close``.
        Unread statuses are buffered (``connect(buffer=10000)``). When the buffer overflows,
        SamplesLostError is raised once, and the following ``next()`` continues with the oldest one
        left.
        """
        return Statuses(self._source(*services), timeout, name_of_statuses(services))

    def events(self, *, timeout: float | None = None) -> Events:
        """Iterate over events from now on; ``event.text`` describes an event in a sentence.

        Waits for each event. After ``timeout`` seconds RobotTimeoutError is raised; the following
        ``next()`` waits again. Ends at ``close``. Events that only announce statuses are omitted.
        """
        return Events(EventQueue(self._connection.reader(), timeout))

    def record(self, seconds: float, *services: str | Service) -> Recording:
        """Collect the statuses of these services (none given: all) for this time, as columns."""
        duration_s("seconds", seconds)
        source = self._source(*services)
        recording = Recording(mask_of(services), self.period_s)
        end_s = self._connection.now_s() + seconds
        while (left_s := end_s - self._connection.now_s()) > 0:
            source.wait(left_s)
            source.drain(recording.add)
        recording.end(self.now_s)
        return recording


class UnthreadedRobot(Robot):
    """A robot without its own thread: ``connect(threaded=False)``.

    Call ``spin``, or any method that waits, repeatedly: otherwise nothing is received or repeated.
    If the program hangs, only the robot's own watchdog stops the robot (after 1 s).
    """

    def __init__(self, connection: SocketConnection, settings: Settings) -> None:
        super().__init__(connection, settings)
        self._socket = connection

    def drive(
        self, linear_m_s: float, angular_rad_s: float, *, lease_s: float | None = None
    ) -> None:
        """See :meth:`Robot.drive`; only ``spin`` repeats the command."""
        try:
            super().drive(linear_m_s, angular_rad_s, lease_s=lease_s)
        except NotArmedError as error:
            pause_s = self._socket.longest_pause_s
            if pause_s < _LONG_PAUSE_S or error.code in (Result.DISARMED, Result.STOP_CALLED):
                raise
            raise NotArmedError(
                f"{error}. The program received nothing for {pause_s:.1f} s: with threaded=False, "
                "call spin() or robot.sleep() instead of time.sleep()",
                error.code,
            ) from None

    def arm(self, timeout: float = 10.0) -> None:
        """See :meth:`Robot.arm`."""
        super().arm(timeout)
        self._socket.forget_pauses()

    def spin(self, timeout: float = 0.0) -> None:
        """Receive and send for ``timeout`` seconds; 0 does what is due and returns."""
        self._socket.spin(duration_s("timeout", timeout))

    def fileno(self) -> int:
        """Return the socket. Only wait until it is readable, then call ``spin(0)``."""
        return self._socket.fileno()

    def next_deadline(self) -> float:
        """Return the seconds until ``spin(0)`` is due if nothing can be read earlier."""
        return self._socket.next_deadline_s()


@overload
def connect(
    host: str = ...,
    *,
    timeout: float = ...,
    wait: bool = ...,
    threaded: Literal[True] = ...,
    **settings: Unpack[Settings],
) -> Robot: ...
@overload
def connect(
    host: str = ...,
    *,
    timeout: float = ...,
    wait: bool = ...,
    threaded: Literal[False],
    **settings: Unpack[Settings],
) -> UnthreadedRobot: ...
def connect(
    host: str = DEFAULT_HOST,
    *,
    timeout: float = 10.0,
    wait: bool = True,
    threaded: bool = True,
    **settings: Unpack[Settings],
) -> Robot:
    """Connect to the robot at "HOST" or "HOST:PORT", and wait until it is ready.

    ``timeout`` limits silence, not progress: RobotTimeoutError reports what was tried and what to
    check. With ``wait=False`` the robot is returned at once and connects in the background. The
    settings are those of :class:`~roburoc4.Settings`.

    With ``threaded`` a native thread keeps the link alive, whatever Python does. It never renews a
    drive command, so if the program hangs, the robot is stopped. Without it, see
    :class:`UnthreadedRobot`.

        with roburoc4.connect("192.168.0.2") as robot:
            robot.arm()
            robot.drive_for(0.5, 0.0, seconds=2)
    """
    if wait := switch("wait", wait):
        timeout_s(timeout)
    robot: Robot
    if switch("threaded", threaded):
        robot = Robot(PumpConnection(host, settings), settings)
    else:
        robot = UnthreadedRobot(SocketConnection(host, settings), settings)
    if wait:
        robot.wait_ready(timeout)
    return robot
