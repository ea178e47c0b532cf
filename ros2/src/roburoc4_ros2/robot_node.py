# SPDX-License-Identifier: MIT
"""A robot as a node: its statuses as messages, for as long as the program runs."""

import threading
import time
from collections.abc import Callable

from roburoc4.constants import Event, State
from roburoc4.records import Status
from roburoc4.robot import Robot
from roburoc4_tools.ros.cdr import Cdr
from roburoc4_tools.ros.state import conditions, diagnoses
from roburoc4_tools.ros.topics import Diagnosis, Messages, diagnostics
from roburoc4_tools.ros.urdf import urdf

from .commands import Commands
from .config import RobotConfig
from .listener import Listener
from .neighbours import Neighbours
from .participant import Participant
from .services import Services

_LOOK_S = 0.2
_DIAGNOSE_S = 1.0
_FIRST_NOTE_S = 3.0
# As in rcl_interfaces/Log, and in diagnostic_msgs/DiagnosticStatus.
_INFO, _WARN = 20, 30
_DIAGNOSE_WARNING = 1


class RobotNode:
    """One robot: what is published of it, and the commands that it receives."""

    def __init__(
        self,
        robot: Robot,
        participant: Participant,
        config: RobotConfig,
        report: Callable[[str], None],
    ) -> None:
        self.robot = robot
        self.config = config
        self.node = participant.node(config.namespace, config.node_name)
        self._tell = report
        self._messages = Messages(robot, robot.address, frames=config.frames, report=self._warn)
        self._publishers = {
            key: self.node.publisher(*topic) for key, topic in config.topics().items()
        }
        self._neighbours = Neighbours(participant, config, robot.address, self._warn)
        self._presence = _Presence(robot, self._report)
        self._conditions: dict[str, bool] = {}
        self._diagnosed_s = -_DIAGNOSE_S
        self.commands = Commands(robot, config.drive, self._warn)
        self.listener = Listener(
            participant, self.node, self.commands, config.subscriptions(), self._warn
        )
        self.services = Services(participant, self.node, config, self.listener, self._warn)

    def run(self, ended: threading.Event) -> None:
        """Publish until the end."""
        statuses, events = self.robot.statuses(), self.robot.events()
        self._describe()
        while not ended.is_set():
            for status in statuses.take(_LOOK_S):
                self._publish_status(status)
            if events.take() & Event.PROPERTIES:
                self._describe()
            self._look()
            self._presence.look()

    def _warn(self, text: str) -> None:
        self._report(text, _WARN)

    def _report(self, text: str, level: int) -> None:
        """Tell the user, on the terminal and on /rosout."""
        self._tell(f"{self.config.name}: {text}" if self.config.name else text)
        second, nanosecond = divmod(time.time_ns(), 1_000_000_000)
        message = Cdr().numbers("i", second).numbers("I", nanosecond).numbers("B", level)
        name = f"{self.config.namespace}/{self.config.node_name}".strip("/").replace("/", ".")
        for part in (name, text, "", ""):
            message.text(part)
        self._publish("rosout", bytes(message.numbers("I", 0).data))

    def _publish_status(self, status: Status) -> None:
        for key, message in self._messages.of(status):
            self._publish(key, message)

    def _publish(self, key: str, message: bytes) -> None:
        if key in self._publishers:
            self._publishers[key].publish(message)

    def _describe(self) -> None:
        properties = self.robot.properties
        if properties.services:
            text = urdf(self.config.frames, properties)
            self._publish("robot_description", bytes(Cdr().text(text).data))

    def _look(self) -> None:
        """Publish the current state: changes at once, and all of it once a second."""
        now_s = time.monotonic()
        is_due = now_s - self._diagnosed_s >= _DIAGNOSE_S
        before, self._conditions = self._conditions, conditions(self.robot)
        for key, condition in self._conditions.items():
            if is_due or before.get(key) is not condition:
                self._publish(key, bytes(Cdr().numbers("B", condition).data))
        if is_due:
            self._diagnosed_s = now_s
            name = f"{self.config.namespace}/{self.config.node_name}".lstrip("/")
            found = diagnoses(self.robot, name)
            self._neighbours.look()
            state = self.listener.call(lambda commands: commands.state)
            found.append(state.diagnosis(name))
            found.append(_other_nodes(name, self._neighbours.problems))
            self._publish("diagnostics", diagnostics(time.time(), self.robot.address, found))


def _other_nodes(name: str, problems: list[str]) -> Diagnosis:
    values = {str(number): text for number, text in enumerate(problems, 1)}
    text = problems[0] if problems else "nothing is in the way"
    return Diagnosis(_DIAGNOSE_WARNING if problems else 0, f"{name}: other nodes", text, values)


class _Presence:
    """Reports when the robot is connected and when it falls silent."""

    def __init__(self, robot: Robot, report: Callable[[str, int], None]) -> None:
        self._robot = robot
        self._report = report
        self._ready: bool | None = None
        self._begun_s = time.monotonic()

    def look(self) -> None:
        state, address = self._robot.state, self._robot.address
        if state is State.READY and self._ready is not True:
            self._ready = True
            self._report(f"connected to the robot at {address}", _INFO)
        elif state is State.LOST and self._ready:
            self._ready = False
            self._report(
                f"the robot at {address} fell silent: waiting for it; check its power and cable",
                _WARN,
            )
        elif self._ready is None and time.monotonic() - self._begun_s > _FIRST_NOTE_S:
            self._ready = False
            self._report(f"no answer from {address} yet: still waiting; run roburoc4 doctor", _WARN)
