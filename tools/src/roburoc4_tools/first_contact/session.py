# SPDX-License-Identifier: MIT
"""A conversation with a robot of which nothing is known yet, and everything it said."""

import math
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from . import wire
from .response import Response
from .wire import CYCLE_S
from .world import World

COMMAND_S = 0.05
MAX_M_S, MAX_RAD_S = 0.6, 1.2
"""No command of these steps is faster, but for one that is sent while there is no motor power."""
ANSWER_S = 1.5
STOP_S = 8.0
LET_GO = "The key was let go, and zeros were sent. Get ready to repeat that."
Held = TypeVar("Held")
_PORT = 0
_PROGRESS_S = 3.0


class ReleasedError(Exception):
    """The key was let go, and the robot was stopped."""


class MissedError(Exception):
    """A person did not do in time what a countdown asked for; what to do before the next one."""


class SilentError(Exception):
    """The robot was not heard at all."""


class UnsafeError(Exception):
    """Going on would endanger somebody; the reason's name and a sentence."""

    def __init__(self, reason: str, text: str) -> None:
        super().__init__(text)
        self.reason = reason


def number(ask: Callable[[str], str], text: str) -> float:
    """Ask until the answer is a number."""
    question = text
    while True:
        answer = ask(question)
        with suppress(ValueError):
            value = float(answer.replace(",", "."))
            if math.isfinite(value):
                return value
        question = f"{answer!r} is no number; give one such as 1.25. {text}"


class Session:
    """One robot: telegrams out and in, what is known, and which datagrams prove it."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.known: dict[str, float] = {}
        self.proof: dict[str, tuple[int, int]] = {}
        self.earlier: dict[str, str] = {}
        """The same of earlier sessions, with the recording's name."""
        self.log: list[tuple[float, int, bool, bytes]] = []
        self.ids: dict[str, int] = {}
        self.fixed = False
        self.statuses: list[wire.Status] = []
        self.samples: list[wire.Speeds] = []
        self._answers: deque[wire.Answer] = deque()
        self._asked: deque[tuple[int, float]] = deque()
        self._last_id = 1
        self._since = 0
        self.commanded_s = 0.0
        self.heard_s = -math.inf
        self.clock: list[tuple[float, int]] = []
        """When statuses of the inputs with which stamps arrived."""
        self._driving = False
        """Whether the last command was a speed: then the key is held without commands, too."""
        self.usable: list[str] = []
        self.restarts = 0
        """How often people switched the robot off and on."""
        self._progress_s = -math.inf
        self.responses: dict[int, Response] = {}
        self.notes: dict[str, float] = {}
        self.watched: list[list[str]] = []
        """What people did, and what the robot reported meanwhile."""
        self.traces: dict[str, dict[str, list[list[float]]]] = {}
        """What is drawn on the page: curves by name, of seconds and values."""

    # ---- what is known

    def learn(self, name: str, value: float) -> None:
        """Keep an answer, with the datagrams since the last question."""
        self.known[name] = value
        self.proof[name] = (self._since, len(self.log))

    def begin(self) -> None:
        """Begin a question."""
        self._since = len(self.log)

    def lasts(self, what: str, seconds: float) -> None:
        """Say what the people wait for now, and for how long at most."""
        self.world.say(f"  {what}: up to {math.ceil(seconds)} s.")

    def progress(self, what: str, number: int, count: int) -> None:
        """Say how far a repetition is, with the first one and then every few seconds."""
        if number == 1 or self.world.now_s > self._progress_s + _PROGRESS_S:
            self._progress_s = self.world.now_s
            self.world.say(f"  {what}: {number} of {count}.")

    def please(self, key: str, text: str) -> None:
        """Ask for something to be done."""
        self.world.please(key, text)
        self.pump(0.0)  # what answers earlier questions must not seem to answer the next ones

    def ask(self, key: str, text: str) -> str:
        """Ask a question."""
        answer = self.world.ask(key, text)
        self.pump(0.0)
        return answer

    def until_held(self, deed: Callable[[], Held]) -> Held:
        """Do this, once more for each time that the key was let go meanwhile."""
        while True:
            try:
                return deed()
            except ReleasedError:
                self.please("again", LET_GO)
                self.hold()

    def hold(self) -> None:
        """Before the robot moves, wait until the key is pressed for this, whoever still held it."""
        self.world.hold("Hold the space bar; the robot stops when it is let go.")
        self.pump(0.0)

    # ---- datagrams

    def send(self, data: bytes, port: int = _PORT) -> None:
        """Send a datagram from one of our ports."""
        self.log.append((self.world.now_s, port, True, data))
        self.world.send(port, data)

    def pump(self, seconds: float) -> None:
        """Let time pass, and sort what arrives."""
        for datagram in self.world.wait(seconds):
            self.log.append((datagram.at_s, datagram.port, False, datagram.data))
            self.heard_s = datagram.at_s
            if datagram.data[:1] == b"\xff":
                status = wire.status_of(*datagram)
                if status is not None:
                    self.statuses.append(status)
                    if status.port == _PORT and status.service == self.ids.get("iocard"):
                        self.clock.append((status.at_s, status.cycles))
                continue
            answer = wire.answer_of(*datagram[:3])
            if not self._is_sample(answer):
                self._answers.append(answer)

    def _is_sample(self, answer: wire.Answer) -> bool:
        if (
            not self._asked
            or answer.action != wire.GET
            or answer.error
            or answer.target != self.ids.get("differential")
            or len(answer.payload) != wire.DIFFERENTIAL_BYTES
        ):
            return False
        if not self.fixed:
            if all(number != answer.id for number, _asked_s in self._asked):
                return False
            while self._asked[0][0] != answer.id:
                self._asked.popleft()
        _number, asked_s = self._asked.popleft()
        self.samples.append(wire.speeds_of(asked_s, answer.payload))
        return True

    def next_id(self) -> int:
        """Return an id that no open request has, if the robot allows that."""
        if self.known.get("only_id_fixed"):
            return wire.MANUAL_ID
        self._last_id = self._last_id + 1 if self._last_id < 254 else 2
        return self._last_id

    def request(
        self,
        action: int,
        target: int,
        payload: bytes = b"",
        *,
        port: int = _PORT,
        patience_s: float = ANSWER_S,
        tries: int = 2,
    ) -> wire.Answer | None:
        """Send a request and return its answer, an error too; None if there is none."""
        for _try in range(tries):
            number = self.next_id()
            self._answers.clear()
            self.send(wire.request(number, action, target, payload), port)
            end_s = self.world.now_s + patience_s
            while self.world.now_s < end_s:
                self.pump(CYCLE_S)
                while self._answers:
                    answer = self._answers.popleft()
                    if answer.port == port and self._fits(answer, number, action, target):
                        return answer
        return None

    def _fits(self, answer: wire.Answer, number: int, action: int, target: int) -> bool:
        if answer.action is None:
            return answer.id == 0
        same = answer.action == action and answer.target == target
        return same and (answer.id in (number, 0) or self.fixed)

    def answers(self) -> list[wire.Answer]:
        """Take the answers that no request waited for."""
        taken = list(self._answers)
        self._answers.clear()
        return taken

    # ---- subscriptions

    def subscribe(self, service: str, period_cycles: int, port: int = _PORT) -> wire.Answer | None:
        """Ask for the statuses of a service."""
        wanted = self.ids[service].to_bytes(2, "little") + bytes([period_cycles])
        return self.request(wire.INSERT, wire.NOTIFICATION, wanted, port=port)

    def unsubscribe(self, service: str, port: int = _PORT) -> wire.Answer | None:
        """End them."""
        wanted = self.ids[service].to_bytes(2, "little")
        return self.request(wire.DELETE, wire.NOTIFICATION, wanted, port=port)

    def most_subscriptions(self) -> float:
        """How many the robot has room for; a great number where no end was seen."""
        return self.known.get("max_subscriptions", math.inf)

    def lag_s(self, *services: str) -> float:
        """How late the statuses of these services arrive."""
        return max((self.known.get(f"queue_{name}_ms", 0.0) for name in services), default=0) / 1000

    def listen(self, seconds: float, port: int | None = _PORT) -> dict[str, list[wire.Status]]:
        """Return the statuses of the next seconds, by service."""
        self.statuses.clear()
        self.pump(seconds)
        heard: dict[str, list[wire.Status]] = {name: [] for name in self.ids}
        names = {number: name for name, number in self.ids.items()}
        for status in self.statuses:
            if status.service in names and port in (None, status.port):
                heard[names[status.service]].append(status)
        return heard

    def hear(self, service: str, seconds: float, port: int | None = _PORT) -> list[wire.Status]:
        """Return a service's statuses of the next seconds, and those that come later."""
        return self.listen(seconds + self.lag_s(service), port)[service]

    def heard_of(self, service: str) -> list[wire.Status]:
        """Return its statuses at our first port since the last time that all were forgotten."""
        return [x for x in self.statuses if x.service == self.ids[service] and not x.port]

    # ---- speeds

    def command(self, linear_m_s: float, angular_rad_s: float, *, powerless: bool = False) -> None:
        """Send one command: a speed only while the key is held."""
        if not powerless and (linear_m_s or angular_rad_s):
            if abs(linear_m_s) > MAX_M_S or abs(angular_rad_s) > MAX_RAD_S:
                raise ValueError("faster than these steps may be")
            self._stop_if_released()
        self._driving = bool(linear_m_s or angular_rad_s) and not powerless
        self.send(wire.speeds(self.ids["differential"], linear_m_s, angular_rad_s))
        self.commanded_s = self.world.now_s

    def _stop_if_released(self) -> None:
        if not self.world.held():
            self.stop()
            raise ReleasedError

    def run(
        self,
        seconds: float,
        command: tuple[float, float] | None = None,
        until: Callable[[], bool] = lambda: False,
    ) -> None:
        """Ask for the speeds in each cycle, and repeat a command if there is one."""
        end_s = self.world.now_s + seconds - CYCLE_S / 2
        due_s = tick_s = self.world.now_s
        while self.world.now_s < end_s and not until():
            if command is not None and self.world.now_s >= due_s - CYCLE_S / 2:
                self.command(*command)
                due_s += COMMAND_S
            if self._asked and self.world.now_s > self._asked[-1][1] + ANSWER_S:
                self._asked.clear()  # lost in a restart
            number = self.next_id()
            self._asked.append((number, self.world.now_s))
            self.send(wire.request(number, wire.GET, self.ids["differential"]))
            tick_s += CYCLE_S
            self.pump(max(tick_s - self.world.now_s, 0.0))
            if self._driving:
                self._stop_if_released()
            if command is not None and any(command):
                self._refuse_running_away()

    def _refuse_running_away(self) -> None:
        last = self.samples[-1].speed if self.samples else (0.0, 0.0)
        if abs(last[0]) > 2 * MAX_M_S or abs(last[1]) > 2 * MAX_RAD_S:
            self.stop()
            raise UnsafeError(
                "runs_away", f"The wheels turn at {last[0]:.1f} m/s, {last[1]:.1f} rad/s unasked."
            )

    def sampled(self, since_s: float, command: tuple[float, float] | None) -> list[wire.Speeds]:
        """Return the speeds since then, at least two, once all answers have arrived."""
        end_s = self.world.now_s - CYCLE_S / 2
        self.run(
            ANSWER_S,
            command,
            lambda: bool(self.samples) and self.samples[-1].asked_s >= end_s,
        )
        found = [s for s in self.samples if since_s - CYCLE_S / 2 <= s.asked_s <= end_s + CYCLE_S]
        if len(found) < 2:
            raise SilentError
        return found

    def leave(self) -> None:
        """Send the zeros that are due when the conversation ends, however it does."""
        for _ in range(5 if self.commanded_s else 0):
            self.command(0.0, 0.0)
            with suppress(BaseException):  # an impatient Ctrl-C, a terminal that is gone
                self.pump(COMMAND_S)

    def stop(self) -> bool:
        """Send zeros, at least four, until the robot reports rest; False if it does not."""
        since_s = self.world.now_s

        def rests() -> bool:
            new = [s for s in self.samples[-3:] if s.asked_s > since_s + 2 * CYCLE_S]
            four_s = 3 * COMMAND_S + CYCLE_S
            return (
                self.world.now_s > since_s + four_s
                and len(new) == 3
                and all(
                    max(map(abs, s.target)) < 1e-3 and max(map(abs, s.speed)) < 0.03 for s in new
                )
            )

        self.run(STOP_S, (0.0, 0.0), rests)
        return rests()
