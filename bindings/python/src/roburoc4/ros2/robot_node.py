# SPDX-License-Identifier: MIT
"""A robot as a node: its statuses as messages, for as long as the program runs."""

import threading
import time
from collections.abc import Callable

from ..constants import State
from ..records import Status
from ..robot import Robot
from ..ros_topics import Messages
from .config import RobotConfig
from .participant import Participant

_LOOK_S = 0.2
_FIRST_NOTE_S = 3.0


class RobotNode:
    """One robot, and what is published of it."""

    def __init__(
        self,
        robot: Robot,
        participant: Participant,
        config: RobotConfig,
        tell: Callable[[str], None],
    ) -> None:
        self._robot = robot
        self._tell = tell
        self._messages = Messages(robot, robot.address, frames=config.frames)
        node = participant.node(config.namespace, config.node_name)
        self._publishers = {key: node.publisher(*topic) for key, topic in config.topics().items()}
        self._presence = _Presence(robot, tell)

    def run(self, ended: threading.Event) -> None:
        """Publish until the end."""
        source = self._robot.reader()
        while not ended.is_set():
            source.wait(_LOOK_S)
            source.drain(self._publish_status)
            self._presence.look()

    def _publish_status(self, status: Status) -> None:
        for key, message in self._messages.of(status):
            if key in self._publishers:
                self._publishers[key].publish(message)


class _Presence:
    """Tells a person when the robot comes and goes."""

    def __init__(self, robot: Robot, tell: Callable[[str], None]) -> None:
        self._robot = robot
        self._tell = tell
        self._ready: bool | None = None
        self._begun_s = time.monotonic()

    def look(self) -> None:
        state, address = self._robot.state, self._robot.address
        if state is State.READY and self._ready is not True:
            self._ready = True
            self._tell(f"connected to the robot at {address}")
        elif state is State.LOST and self._ready:
            self._ready = False
            self._tell(f"the robot at {address} fell silent: waiting for it; look at power, cable")
        elif self._ready is None and time.monotonic() - self._begun_s > _FIRST_NOTE_S:
            self._ready = False
            self._tell(f"no answer from {address} yet: still waiting; roburoc4 doctor looks closer")
