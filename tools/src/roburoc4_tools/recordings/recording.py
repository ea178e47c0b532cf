# SPDX-License-Identifier: MIT
"""Recordings as sources: a client of the library runs through a capture, in recorded time.

It sends its own requests and gets the recorded answers; the recorded statuses arrive when they
did. So what it reports (events, facts, loss) is what a live client would have reported, not
another interpretation of the bytes.
"""

from collections import OrderedDict, deque
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, Unpack

from roburoc4.constants import DEFAULT_PORT, Action, Event, Result, Service, WireError
from roburoc4.errors import ArgumentError, DecodeError, RecordingError
from roburoc4.notices import texts_of
from roburoc4.offline import OfflineClient
from roburoc4.protocol import (
    STATUS_SERVICES,
    Layout,
    decode,
    encode_answer,
    service_of,
    usual_answer,
)
from roburoc4.records import (
    Answer,
    DifferentialCommand,
    IoCardCommand,
    Request,
    Status,
    UnknownCommand,
    UnknownStatus,
)
from roburoc4.robot import Robot
from roburoc4.samples import flatten
from roburoc4.settings import Settings

from .capture import Capture, Datagram, Endpoint

if TYPE_CHECKING:
    import numpy.typing as npt

__all__ = ["Command", "RecordedEvent", "RecordedRobot", "open_recording"]

_LOOK_AHEAD = 20_000
_LOOK_AHEAD_US = 60_000_000
_MOST_OPEN = 256
_MOST_ANSWERS = 4096
_COPIES = 32
_SILENCE_US = 200_000
_LONG_SILENCE_US = 100_000_000
_BUFFER = 64
_IOCARD_EVENT = int(Event.IOCARD)  # an Event is slow to compute with
_WATCHDOG_US = 1_000_000
_HALT_US = 2_000_000
_LONGEST_DRIVING_PERIOD_MS = 330


class Command(NamedTuple):
    """A command that somebody sent to the recorded robot."""

    host_us: int
    """Unix time in microseconds."""
    sender: str
    """The sender's address and port."""
    telegram: DifferentialCommand | IoCardCommand | UnknownCommand


class RecordedEvent(NamedTuple):
    """Something that happened to the recorded robot."""

    host_us: int
    """Unix time in microseconds."""
    level: str
    """bad, weak, good or plain."""
    text: str


Item: TypeAlias = Status | Command | RecordedEvent


class Answers:
    """The recorded robot's answers by request, as far as the capture has been read."""

    def __init__(self) -> None:
        self._known: dict[Request, bytes] = {}
        self._open: OrderedDict[tuple[object, int], tuple[Request, int]] = OrderedDict()

    def copy(self) -> "Answers":
        """Return the same answers, for another pass."""
        other = Answers()
        other._known = dict(self._known)
        return other

    @property
    def complete(self) -> bool:
        """Whether the robot's directory is among them."""
        return _get(Service.DIRECTORY) in self._known

    def ask(self, client: object, request: Request, time_us: int) -> None:
        """Remember a recorded request."""
        self._open[client, request.id] = (_key(request), time_us)
        if len(self._open) > _MOST_OPEN:
            self._open.popitem(last=False)

    def learn(self, client: object, data: bytes, answer: Answer, time_us: int) -> int | None:
        """Remember a recorded answer, and how long it took if its request is known."""
        key, took_us = _get(answer.service), None
        asked = self._open.pop((client, answer.id), None)
        if asked is not None and (asked[0].action, asked[0].service) == answer[1:3]:
            key, took_us = asked[0], time_us - asked[1]
        elif answer.action != Action.GET or answer.id == 0:
            return None
        if key in self._known or len(self._known) < _MOST_ANSWERS:
            self._known[key] = data
        return took_us

    def answer(self, data: bytes, request: Request) -> bytes | None:
        """Return the recorded answer; to unrecorded requests, what any RobuROC4 would answer."""
        known = self._known.get(_key(request))
        if known is not None:
            return bytes([request.id]) + known[1:]
        if request.action == Action.QUERY and any(k.action == request.action for k in self._known):
            # it gave some of its texts: no others are invented
            error = WireError.UNSUPPORTED
            return encode_answer(request.id, request.action, request.service, error)
        if request.action in (Action.INSERT, Action.DELETE):
            return encode_answer(request.id, request.action, request.service)
        return usual_answer(data)


def _get(service: int) -> Request:
    return Request(0, Action.GET, service, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0)


def _key(request: Request) -> Request:
    """Remove what makes no difference to the answer: the id, the period, a pose."""
    return Request(0, *request[1:4], 0, *request[5:7], 0, 0.0, 0.0, 0.0)


def read_telegram(data: bytes, layout: Layout | None = None, *, from_client: bool) -> Any:
    """Decode; None for what is not a telegram."""
    try:
        return decode(data, layout, "client" if from_client else "robot")
    except DecodeError:
        return None


BARE = Layout(*(0xFFFF,) * 5)
"""A layout for which statuses and commands are decoded to the service's id and bytes."""


class _Head:
    """What the beginning of a capture shows: the robot, its answers and its statuses."""

    def __init__(self, path: Path, robot: str | None) -> None:
        first: list[Datagram] = []
        for datagram in Capture(path):
            first.append(datagram)
            late = datagram.time_us - first[0].time_us > _LOOK_AHEAD_US
            if late or len(first) >= _LOOK_AHEAD:
                break
        if not first:
            raise RecordingError(f"{path} holds no UDP datagrams: nothing was recorded")
        self.robot = _find_robot(path, first, robot)
        self.begun_us = first[0].time_us
        self.answers = Answers()
        self.period_ms: dict[str, int | None] = {}
        for datagram in first:
            self._take(datagram)

    def _take(self, datagram: Datagram) -> None:
        time_us, source, destination, data, _ = datagram
        if destination == self.robot:
            request = read_telegram(data, from_client=True)
            if isinstance(request, Request):
                self.answers.ask(source, request, time_us)
                if request.action == Action.INSERT:
                    self._subscribed(request)
        elif source == self.robot and data[:1] != b"\xff":
            answer = read_telegram(data, from_client=False)
            if isinstance(answer, Answer):
                self.answers.learn(destination, data, answer, time_us)

    def _subscribed(self, request: Request) -> None:
        """Expect statuses at the recorded periods, as far as a client accepts them."""
        for name, service in STATUS_SERVICES.items():
            if request.subject == service and request.period_cycles > 0:
                longest = _LONGEST_DRIVING_PERIOD_MS if name in _DRIVING else 2550
                self.period_ms[name] = min(request.period_cycles * 10, longest)

    def settings(self) -> Settings:
        """Make the settings of a client that watches the recording."""
        return {"period_ms": self.period_ms, "fresh_ms": 1000}


_DRIVING = ("iocard", "differential")


def _find_robot(path: Path, first: list[Datagram], name: str | None) -> tuple[bytes, int]:
    """Return the sender of most statuses; if an address is given, among those with it."""
    senders: dict[tuple[bytes, int], int] = {}
    for datagram in first:
        record = read_telegram(datagram.payload, from_client=False)
        is_status = record is not None and not isinstance(record, Answer | UnknownStatus)
        is_likely = is_status or datagram.source[1] == DEFAULT_PORT
        senders[datagram.source] = senders.get(datagram.source, 0) + is_likely
    if name is not None:
        named = [sender for sender in senders if name in (str(Endpoint(*sender)), _host(sender))]
        senders = {sender: 1 + senders[sender] for sender in named}
    found = max(senders, key=senders.__getitem__, default=None)
    if found is None or not senders[found]:
        what = f"nothing from {name}" if name else "no statuses of a RobuROC4"
        raise RecordingError(
            f"{path} has {what} in its first minute: name the robot with --robot HOST:PORT, as "
            "tcpdump shows it"
        )
    return found


def _host(sender: tuple[bytes, int]) -> str:
    return str(Endpoint(*sender)).rpartition(":")[0]


class _Pass:
    """One reading of a capture, from beginning to end."""

    def __init__(self, path: Path, head: _Head, settings: Settings) -> None:
        self.capture = Capture(path)
        self._client = OfflineClient(head.begun_us, self.advance, **settings)
        self.robot = self._client.robot
        self.counts = Counts()
        self._head = head
        self._answers = head.answers.copy()
        self._datagrams = iter(self.capture)
        self._pending: deque[bytes] = deque(maxlen=_BUFFER)
        self._recent: OrderedDict[bytes, object] = OrderedDict()
        self._facts = self.robot.facts
        self._layout: Layout | None = None
        self._drives: dict[str, _Drive] = {}
        self._commanded_us = -_WATCHDOG_US
        self._heard_us = 0

    # ---- the client's requests ----

    def _answer_all(self, time_us: int) -> None:
        """Answer the client's requests."""
        while self._pending:
            data = self._pending.popleft()
            request = read_telegram(data, from_client=True)
            if not isinstance(request, Request):
                continue  # a command: there is no robot to move
            answer = self._answers.answer(data, request)
            if answer is not None:
                self._pending.extend(self._client.feed(answer, time_us))

    # ---- datagrams ----

    def advance(self) -> list[Item] | None:
        """Continue to the next datagram; return what happened, or None at the end."""
        datagram = next(self._datagrams, None)
        if datagram is None:
            return None
        time_us, source, destination, data, _ = datagram
        self.counts.last_us = time_us
        if source == self._head.robot:
            return self._robot_said(time_us, destination, data)
        if destination == self._head.robot:
            return self._robot_heard(time_us, source, data)
        self.counts.others += 1
        return []

    def _robot_said(self, time_us: int, destination: object, data: bytes) -> list[Item]:
        self.counts.from_robot += 1
        found = self._live_until(time_us)
        if self._drives:
            found += self._ended_drives(time_us)
        self._heard_us = time_us
        given = data
        if data[:1] != b"\xff":
            given = b""  # the client gets the answers to its own requests
            answer = read_telegram(data, from_client=False)
            if isinstance(answer, Answer):
                took_us = self._answers.learn(destination, data, answer, time_us)
                if took_us is not None:
                    self.counts.round_trip(took_us)
        elif self._is_copy(data, destination):
            self.counts.copies += 1
            return found
        if self._pending:
            self._answer_all(time_us)
        self._pending.extend(self._client.feed(given, time_us))
        if self._pending:
            self._answer_all(time_us)
        found += self._happened(time_us)
        return found

    def _live_until(self, time_us: int) -> list[Item]:
        """Let the client do what is due earlier, so that its events have the right times."""
        client, found = self._client, list[Item]()
        # nothing happens later in a longer silence, however long a damaged file makes it
        until_us = min(time_us, self._heard_us + _LONG_SILENCE_US)
        while (due_us := client.due_us) < until_us:
            due_us = max(due_us, client.now_us + 1)
            self._pending.extend(client.feed(b"", due_us))
            if due_us - self._heard_us < _SILENCE_US:
                self._answer_all(due_us)
            found += self._happened(due_us)
        return found

    def _is_copy(self, data: bytes, destination: object) -> bool:
        """Whether this status was also sent to another client."""
        recent = self._recent
        known = recent.setdefault(data, destination)
        if len(recent) > _COPIES:
            recent.popitem(last=False)
        return known != destination

    def _happened(self, time_us: int) -> list[Item]:
        events, statuses = self._client.take()
        others = events & ~_IOCARD_EVENT
        if others or (events and self._bumper_changed()):
            return [*self._notices(Event(others), time_us), *statuses]
        return [*statuses]

    def _bumper_changed(self) -> bool:
        facts, now = self._facts, self.robot.facts
        return (facts.front_bumper, facts.rear_bumper) != (now.front_bumper, now.rear_bumper)

    def _notices(self, events: Event, time_us: int) -> list[Item]:
        before, self._facts = self._facts, self.robot.facts
        if time_us - self._commanded_us < 2 * _WATCHDOG_US:
            events &= ~Event.OTHER_COMMANDER  # it is in the recording: not another commander
        found = texts_of(events, before, self._facts, watches=not self.counts.commands)
        for name in ("front", "rear"):
            was, now = (getattr(facts, name + "_bumper") for facts in (before, self._facts))
            if bool(was) != bool(now):
                found.append(("weak", f"the {name} bumper was {'pressed' if now else 'released'}"))
        if events & (Event.READY | Event.PROPERTIES):
            self._layout = self._find_layout()
        return [RecordedEvent(time_us, level, text) for level, text in found]

    def _find_layout(self) -> Layout:
        properties = self.robot.properties
        ids = {entry.service: entry.id for entry in properties.services}
        usual = Layout()
        services = [ids.get(name, usual[at]) for at, name in enumerate(STATUS_SERVICES)]
        channels = usual[5:] if properties.iocard is None else properties.iocard
        return Layout._make([*services, *channels])

    def _robot_heard(self, time_us: int, source: tuple[bytes, int], data: bytes) -> list[Item]:
        telegram = read_telegram(data, self._layout, from_client=True)
        if telegram is None:
            self.counts.malformed += 1
            return []
        client = str(Endpoint(*source))
        if not isinstance(telegram, Request):
            self.counts.commands += 1
            command = Command(time_us, client, telegram)
            return [*self._driven(command), command]
        self.counts.requests += 1
        self._answers.ask(source, telegram, time_us)
        if telegram.action == Action.REPLACE:
            return [
                RecordedEvent(
                    time_us,
                    "plain",
                    f"{client} sets odometry to x {telegram.x_m:.2f} m, y {telegram.y_m:.2f} m, "
                    f"{telegram.theta_rad:.2f} rad",
                )
            ]
        return []

    # ---- who drives ----

    def _driven(self, command: Command) -> list[Item]:
        """Report the beginning and the end of a drive; a short halt is part of it."""
        if not isinstance(command.telegram, DifferentialCommand):
            return []
        now_us, sender = command.host_us, command.sender
        self._commanded_us = now_us
        found = self._ended_drives(now_us)
        drive = self._drives.get(sender)
        if any(speed != 0.0 for speed in command.telegram):
            if drive is None:
                found.append(RecordedEvent(now_us, "plain", f"{sender} begins to drive"))
            begun_us = now_us if drive is None else drive.begun_us
            self._drives[sender] = _Drive(begun_us, now_us, None)
        elif drive is not None:
            self._drives[sender] = drive._replace(
                last_us=now_us, halted_us=drive.halted_us or now_us
            )
        return found

    def _ended_drives(self, now_us: int, halt_us: int = _HALT_US) -> list[Item]:
        """Report the drives that this much time has ended."""
        found: list[Item] = []
        for sender, drive in list(self._drives.items()):
            if drive.halted_us is None and now_us - drive.last_us > _WATCHDOG_US:
                what = "sent no command for 1 s after a speed: the robot's watchdog stops it"
                found.append(RecordedEvent(drive.last_us + _WATCHDOG_US, "bad", f"{sender} {what}"))
            elif drive.halted_us is not None and now_us - drive.halted_us >= halt_us:
                seconds = (drive.halted_us - drive.begun_us) / 1e6
                what = f"stopped the robot, after {seconds:.1f} s of driving"
                found.append(RecordedEvent(drive.halted_us, "plain", f"{sender} {what}"))
            else:
                continue
            del self._drives[sender]
        return found

    def items(self) -> Iterator[Item]:
        """Continue to the end."""
        while (found := self.advance()) is not None:
            yield from found
        yield from self.rest()

    def rest(self) -> list[Item]:
        """Report the drives that had ended at the end of the recording."""
        return self._ended_drives(self.counts.last_us, halt_us=0)


class _Drive(NamedTuple):
    begun_us: int
    last_us: int
    halted_us: int | None
    """The first zero after the last speed."""


class Counts:
    """What a reading found, in addition to the client's counters."""

    def __init__(self) -> None:
        self.last_us = 0
        self.from_robot = self.copies = self.requests = self.commands = 0
        self.malformed = self.others = 0
        self.answered = 0
        self.round_trip_min_us = self.round_trip_max_us = self.round_trip_sum_us = 0

    def round_trip(self, took_us: int) -> None:
        """Remember how long an answer took."""
        least_us = self.round_trip_min_us if self.answered else took_us
        self.answered += 1
        self.round_trip_min_us = min(least_us, took_us)
        self.round_trip_max_us = max(self.round_trip_max_us, took_us)
        self.round_trip_sum_us += took_us


class RecordedRobot:
    """A robot in a capture; see :func:`open_recording`. Each reading starts at the beginning."""

    def __init__(self, path: str | Path, robot: str | None = None) -> None:
        if not isinstance(path, str | Path) or "\0" in str(path):
            raise ArgumentError(
                f"path: {path!r} cannot be used; give the path of a capture, as str or Path",
                Result.ARGUMENT,
            )
        self.path = Path(path)
        self.head = _Head(self.path, robot)

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__name__} {self.address} in {self.path}>"

    @property
    def address(self) -> str:
        """The robot's address and port."""
        return str(Endpoint(*self.head.robot))

    @property
    def begun_s(self) -> float:
        """Unix time of the first datagram."""
        return self.head.begun_us / 1e6

    def __iter__(self) -> Iterator[Status]:
        """Every status, in the recording's time: ``host_us`` is Unix time."""
        return (item for item in self.items() if not isinstance(item, Command | RecordedEvent))

    def items(self) -> Iterator[Item]:
        """Statuses, commands and events, in order."""
        return self.read().items()

    def read(self) -> "_Pass":
        """Start a reading."""
        return _Pass(self.path, self.head, self.head.settings())

    def connect(self, **settings: Unpack[Settings]) -> Robot:
        """Return a robot object in the recording's time, as ``Simulator.connect`` does.

        Time passes while it waits: in ``sleep``, ``wait_for``, ``statuses``. It is closed at the
        end of the recording. Commands have no effect.
        """
        reading = _Pass(self.path, self.head, {**self.head.settings(), **settings})
        reading.robot.wait_ready(timeout=1e9)
        return reading.robot

    def columns(self, service: str | Service) -> dict[str, "npt.NDArray[Any]"]:
        """Return the statuses of a service as NumPy arrays, suitable for ``pandas.DataFrame``.

        Names are those of the record's fields, lists as in :func:`~roburoc4.flatten`.
        """
        try:
            import numpy as np
        except ImportError as error:
            raise ImportError(
                "columns needs NumPy: pip install numpy, or apt install python3-numpy",
                name="numpy",
            ) from error
        kind = service_of(service).name.lower()
        columns: dict[str, list[Any]] = {}
        for status in self:
            if status.service == kind:
                for name, value in flatten(status).items():
                    columns.setdefault(name, []).append(value)
        return {name: np.asarray(column) for name, column in columns.items()}


def open_recording(path: str | Path, robot: str | None = None) -> RecordedRobot:
    """Open a capture (pcapng, pcap) of `roburoc4 record`, `connect(record=)` or tcpdump.

    ``robot`` is its ``HOST:PORT``, needed if the capture has several. Raises RecordingError if the
    file cannot be read, is no capture, or has no robot.
    """
    return RecordedRobot(path, robot)
