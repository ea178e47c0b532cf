# SPDX-License-Identifier: MIT
"""A robot made of a recording: it answers as the recorded one did, and cannot be moved.

It has no clock and no socket: ``roburoc4 replay`` gives it datagrams and the time.
"""

from collections.abc import Callable, Iterator

from roburoc4.constants import Action, Service, WireError
from roburoc4.protocol import encode_answer
from roburoc4.records import Answer, Request, UnknownCommand, UnknownStatus

from .capture import Capture, Datagram
from .recording import BARE, Answers, RecordedRobot, read_telegram

TEXT = " (recording: commands change nothing)"
"""Appended to the recorded robot's text for its differential service."""
_MOST_CLIENTS = 64
_MOST_TEXT = 63
_SILENT_S = 2.0
_ERRORS_EVERY_S = 1.0
_RESTART_CYCLES = 100
_COPIES = 32

Peer = tuple[str, int]
Send = Callable[[Peer, bytes], object]


class Client:
    """A client of the replayed robot."""

    def __init__(self) -> None:
        self.services: set[int] = set()
        """Ids of the services that it subscribed to."""
        self.commands = 0
        self.answered_s = -_ERRORS_EVERY_S
        """When it was last warned that its commands do nothing."""


class _Stamps:
    """The robot's clock: as recorded, but without a step back where a recording starts over."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._first: int | None = None
        self._last = self._base = self._shown = 0

    def begin(self) -> None:
        """Prepare for the beginning of the recording; time continues."""
        if self._first is not None:
            self._base = self._shown + _RESTART_CYCLES
            self._first = None

    def of(self, cycles: int) -> int:
        """Return the cycles to send for recorded ones."""
        if self._first is None:
            self._first = cycles
            self._base = self._base or cycles
        elif cycles + _RESTART_CYCLES < self._last:  # the recorded robot restarted
            self._first = self._base = cycles
        self._last = cycles
        shown = self._base + (cycles - self._first) / self._speed
        self._shown = max(0, min(round(shown), (1 << 64) - 1))
        return self._shown


class ReplayedRobot:
    """A robot made of a recording, which starts at the first subscription."""

    def __init__(
        self,
        recording: RecordedRobot,
        send: Send,
        report: Callable[[str], object],
        *,
        speed: float = 1.0,
        loop: bool = False,
    ) -> None:
        self.clients: dict[Peer, Client] = {}
        self.statuses = 0
        self.ended = False
        self.capture = Capture(recording.path)
        self._recording = recording
        self._answers: Answers = recording.head.answers.copy()
        self._send = send
        self._report = report
        self._speed = speed
        self._loop = loop
        self._stamps = _Stamps(speed)
        self._datagrams: Iterator[Datagram] = iter(())
        self._next: Datagram | None = None
        self._begun_us = 0
        self._begun_s: float | None = None
        self._heard_us: int | None = None

    # ---- the recording ----

    @property
    def due_s(self) -> float | None:
        """When the next recorded datagram is due; None before the beginning and after the end."""
        if self._begun_s is None or self._next is None:
            return None
        return self._begun_s + (self._next.time_us - self._begun_us) / 1e6 / self._speed

    def advance(self, now_s: float) -> None:
        """Send what is due."""
        while (due_s := self.due_s) is not None and due_s <= now_s:
            assert self._next is not None
            self._play(self._next)
            self._heard_us = self._next.time_us
            self._take_next()
            if self._next is None:
                self._end(now_s)
                return

    def _begin(self, now_s: float) -> None:
        self.capture = Capture(self._recording.path)
        self._datagrams = self._of_robot()
        self._stamps.begin()
        self._take_next()
        if self._next is None:
            self.ended = True
            return
        self._begun_us, self._begun_s = self._next.time_us, now_s

    def _end(self, now_s: float) -> None:
        if self._loop:
            self._report("the recording starts over")
            self._begin(now_s + 1.0 / self._speed)
        else:
            self.ended = True

    def _of_robot(self) -> Iterator[Datagram]:
        """Read the recorded robot's statuses, each once; requests are learned as they pass."""
        robot = self._recording.head.robot
        recent: dict[bytes, object] = {}
        for datagram in self.capture:
            if datagram.destination == robot:
                request = read_telegram(datagram.payload, from_client=True)
                if isinstance(request, Request):
                    self._answers.ask(datagram.source, request, datagram.time_us)
            elif datagram.source == robot:
                data = datagram.payload
                known = recent.setdefault(data, datagram.destination)
                if len(recent) > _COPIES:
                    del recent[next(iter(recent))]
                if known == datagram.destination:
                    yield datagram

    def _take_next(self) -> None:
        self._next = next(self._datagrams, None)

    def _play(self, datagram: Datagram) -> None:
        time_us, _, destination, data, _ = datagram
        if data[:1] != b"\xff":
            answer = read_telegram(data, from_client=False)
            if isinstance(answer, Answer):
                self._answers.learn(destination, data, answer, time_us)
            return
        status = read_telegram(data, BARE, from_client=False)
        if not isinstance(status, UnknownStatus):  # too short to be a status
            return
        stamp = self._stamps.of(status.robot_cycles).to_bytes(8, "little")
        stamped = data[:3] + stamp + data[11:]
        self.statuses += 1
        for peer, client in self.clients.items():
            if status.service in client.services:
                self._send(peer, stamped)

    # ---- clients ----

    def receive(self, peer: Peer, data: bytes, now_s: float) -> None:
        """Handle a datagram from a client."""
        telegram = read_telegram(data, BARE, from_client=True)
        if telegram is None or (peer not in self.clients and len(self.clients) >= _MOST_CLIENTS):
            return
        client = self.clients.setdefault(peer, Client())
        if isinstance(telegram, Request):
            if not self._is_silent(now_s):
                self._answer(peer, client, data, telegram, now_s)
            return
        self._refuse(peer, client, "sends commands")
        if now_s - client.answered_s >= _ERRORS_EVERY_S:
            client.answered_s = now_s
            # the protocol's own refusal; a command has no action that could be named
            service = telegram.service if isinstance(telegram, UnknownCommand) else 0
            error = (0, Action.UPDATE, service, WireError.UNSUPPORTED)
            self._send(peer, encode_answer(*error))

    def _refuse(self, peer: Peer, client: Client, what: str) -> None:
        client.commands += 1
        if client.commands == 1:
            self._report(f"{peer[0]}:{peer[1]} {what}: this is a recording, nothing moves")

    def _is_silent(self, now_s: float) -> bool:
        """Whether the recorded robot was silent for long: then it does not answer either."""
        if self._begun_s is None or self._heard_us is None or self._next is None:
            return self.ended
        time_us = self._begun_us + (now_s - self._begun_s) * self._speed * 1e6
        left_s, past_s = self._next.time_us - time_us, time_us - self._heard_us
        return left_s > 0 and past_s > _SILENT_S * 1e6 and time_us > self._begun_us

    def _answer(
        self, peer: Peer, client: Client, data: bytes, request: Request, now_s: float
    ) -> None:
        if request.action == Action.REPLACE:
            self._refuse(peer, client, "sets odometry")
            error = WireError.UNSUPPORTED
            answer: bytes | None = encode_answer(request.id, request.action, request.service, error)
        else:
            answer = self._answers.answer(data, request)
        if answer is None:
            return
        if request.action == Action.QUERY and request.service == Service.DIRECTORY:
            answer = self._marked(request, answer)
        self._send(peer, answer)
        reply = read_telegram(answer, from_client=False)
        if not isinstance(reply, Answer) or reply.error:
            return
        if request.action == Action.INSERT:
            client.services.add(request.subject)
            if self._begun_s is None:
                self._begin(now_s)
        elif request.action == Action.DELETE:
            client.services.discard(request.subject)

    def _marked(self, request: Request, answer: bytes) -> bytes:
        """Mention the recording in the text of the differential service."""
        reply = read_telegram(answer, from_client=False)
        if not isinstance(reply, Answer) or reply.error or not isinstance(reply.body, str):
            return answer
        if "differential" not in reply.body.lower():
            return answer
        head = encode_answer(request.id, request.action, request.service)
        text = answer[len(head) :][: _MOST_TEXT - len(TEXT)]
        return head + text + TEXT.encode()

    def part(self, peer: Peer) -> None:
        """Stop sending to a client: nobody listens there."""
        self.clients.pop(peer, None)
