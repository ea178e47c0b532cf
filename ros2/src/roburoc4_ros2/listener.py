# SPDX-License-Identifier: MIT
"""The subscriptions of one robot: cmd_vel and stop, read by a thread of their own."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from cyclonedds.core import (
    DDSException,
    InstanceState,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.sub import DataReader

from roburoc4_tools.ros.published import Topic

from .commands import Commands, Sender
from .participant import Node, Participant
from .senders import Senders

_WAIT_S = 0.02
"""Short, so that a hang of this program is noticed: see Gate.look."""
_RETRY_S = 1.0
_T = TypeVar("_T")
_STOP = "std_msgs/Empty"
_NEWS = ViewState.Any | InstanceState.Any | SampleState.NotRead
_SOMEBODY = Sender("", "a publisher")


class Listener:
    """Reads commands, and gives them to a robot."""

    def __init__(
        self,
        participant: Participant,
        node: Node,
        commands: Commands,
        topics: list[Topic],
        report: Callable[[str], None],
    ) -> None:
        """Subscribe to these topics: those without content stop the robot, others drive it."""
        self.commands = commands
        self._report = report
        self._senders = Senders(participant)
        self._stops = [node.reader(*one) for one in topics if one.kind == _STOP]
        self._cmd_vel = [node.reader(*one) for one in topics if one.kind != _STOP]
        self._lock = threading.Lock()
        self._waitset = WaitSet(participant.dds)
        self._conditions = [
            ReadCondition(reader, _NEWS) for reader in (*self._stops, *self._cmd_vel)
        ]
        for condition in self._conditions:
            self._waitset.attach(condition)

    def run(self, ended: threading.Event) -> None:
        """Read until the end. However this ends, the robot is stopped."""
        try:
            while not ended.is_set():
                try:
                    self._turn()
                except Exception as error:  # an unforeseen one, too: `stop` must be read again
                    why = error.msg if isinstance(error, DDSException) else repr(error)
                    self._report(f"commands cannot be read ({why}): stopped; trying again")
                    self.commands.end()
                    ended.wait(_RETRY_S)
        finally:
            self.commands.end()

    def call(self, act: Callable[[Commands], _T]) -> _T:
        """Do something with the commands, while the thread that reads them does nothing."""
        with self._lock:
            return act(self.commands)

    def _turn(self) -> None:
        has_news = self._waitset.wait(round(_WAIT_S * 1e9)) > 0
        self.call(lambda commands: commands.look(_WAIT_S))
        if has_news:
            self._read()
            self.call(Commands.look)

    def _read(self) -> None:
        for reader in self._stops:  # first
            for sample in _taken(reader):
                sender = self._sender(reader, sample)
                with self._lock:
                    self.commands.stop(sender)
        for reader in self._cmd_vel:
            for sample in _taken(reader):
                sender = self._sender(reader, sample)
                with self._lock:
                    self._obey(sender, sample)

    def _obey(self, sender: Sender, sample: Any) -> None:
        if sample is None:
            self.commands.unreadable(sender)
        else:
            sent_us = sample.sample_info.source_timestamp // 1000
            self.commands.drive(sender, sample, sent_us or time.time_ns() // 1000)

    def _sender(self, reader: DataReader[Any], sample: Any) -> Sender:
        if sample is None:
            return _SOMEBODY
        return self._senders.of(reader, sample.sample_info.publication_handle)


def _taken(reader: DataReader[Any]) -> Iterator[Any]:
    """Take all messages that are there; None for each that cannot be read."""
    while True:
        try:
            samples = reader.take(1)
        except DDSException:
            raise
        except Exception:  # the decoder may raise anything for bytes of others
            yield None
            continue
        if not samples:
            return
        if samples[0].sample_info.valid_data:
            yield samples[0]
