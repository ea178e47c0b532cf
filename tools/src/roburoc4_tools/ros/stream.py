# SPDX-License-Identifier: MIT
"""One robot's messages as a stream: of its statuses, and once a second of its state."""

from collections.abc import Iterator

from roburoc4.robot import Robot

from .cdr import Cdr
from .state import conditions, diagnoses
from .topics import Item, Message, Messages, diagnostics
from .urdf import urdf

_LOOK_US = 1_000_000
_NODE = "roburoc4"


class Stream:
    """Makes the messages that the node would publish, for a file or for Foxglove."""

    def __init__(self, robot: Robot | None, address: str, offset_s: float = 0.0) -> None:
        """Begin; ``offset_s`` is added to the robot object's time to get Unix time."""
        self.messages = Messages(robot, address, offset_s)
        self._robot = robot
        self._address = address
        self._conditions: dict[str, bool] = {}
        self._looked_us = -_LOOK_US
        self._description = ""

    def of(self, item: Item) -> Iterator[Message]:
        """Make messages of a status, a command or an event, and what is due of the state."""
        yield from self.messages.of(item)
        if self._robot is not None:
            yield from self._state(self._robot, self.messages.seen_us(item))

    def _state(self, robot: Robot, now_us: int) -> Iterator[Message]:
        """Make what the node publishes besides statuses: changes, and all of it once a second."""
        is_due = now_us - self._looked_us >= _LOOK_US
        before, self._conditions = self._conditions, conditions(robot)
        for topic, condition in self._conditions.items():
            if is_due or before.get(topic) is not condition:
                yield topic, bytes(Cdr().numbers("B", condition).data)
        if not is_due:
            return
        self._looked_us = now_us
        found = diagnoses(robot, _NODE, watches=True)
        yield "diagnostics", diagnostics(now_us / 1e6, self._address, found)
        properties = robot.properties
        description = urdf(self.messages.frames, properties) if properties.services else ""
        if description != self._description:
            self._description = description
            yield "robot_description", bytes(Cdr().text(description).data)
