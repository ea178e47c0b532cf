# SPDX-License-Identifier: MIT
"""All robots of a configuration, connected and published."""

import contextlib
import threading
from collections.abc import Callable
from typing import Self

from roburoc4 import Settings
from roburoc4.robot import Robot, connect

from .config import Config, RobotConfig
from .participant import Participant
from .robot_node import RobotNode

_LOOK_S = 0.2


class Program:
    """Robots and their nodes; to be used in a ``with`` block, which leaves no entity behind."""

    def __init__(self, config: Config, report: Callable[[str], None]) -> None:
        """Begin; ``report`` is called with messages for the user."""
        self._ended = threading.Event()
        self._threads: list[threading.Thread] = []
        with contextlib.ExitStack() as stack:
            robots = [stack.enter_context(_connect(robot)) for robot in config.robots]
            humble = None if config.distro is None else config.distro == "humble"
            participant = Participant(
                config.domain,
                humble=humble,
                interface=config.interface,
                peers=config.peers,
                multicast=config.multicast,
                robots=[robot.address for robot in robots],
            )
            stack.callback(participant.close)
            self._participant = participant
            nodes = [
                RobotNode(robot, participant, its, report)
                for robot, its in zip(robots, config.robots, strict=True)
            ]
            participant.announce()
            stack.callback(self._end)  # first: a signal may come at any time
            for node in nodes:
                for run in (node.run, node.listener.run, node.services.run):
                    thread = threading.Thread(target=run, args=(self._ended,), daemon=True)
                    self._threads.append(thread)
                    thread.start()
            self._stack = stack.pop_all()

    def _end(self) -> None:
        self._ended.set()
        for thread in self._threads:
            if thread.ident is not None:  # it was started
                thread.join()

    def __enter__(self) -> Self:
        return self

    def wait(self) -> None:
        """Wait forever, and react to what other nodes announce."""
        while not self._ended.wait(_LOOK_S):
            self._participant.look()

    def __exit__(self, *_: object) -> None:
        self._stack.close()


def _connect(config: RobotConfig) -> Robot:
    settings: Settings = {
        "period_ms": config.period_ms,
        "max_linear_m_s": config.drive.max_linear_m_s,
        "max_angular_rad_s": config.drive.max_angular_rad_s,
    }
    if config.robot_file:
        settings["robot_file"] = config.robot_file
    return connect(config.address, wait=False, **settings)
