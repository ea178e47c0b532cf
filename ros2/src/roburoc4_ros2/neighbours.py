# SPDX-License-Identifier: MIT
"""What other nodes publish for a robot without effect, or besides its node; found by discovery."""

import time
import uuid
from collections.abc import Callable, Iterator
from typing import NamedTuple

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import InstanceState
from cyclonedds.qos import Policy

from roburoc4_tools.ros.messages import dds_name, ros_name
from roburoc4_tools.ros.published import CMD_VEL, CMD_VEL_UNSTAMPED, STOPS

from .commands import Sender
from .config import RobotConfig
from .names import resolve
from .participant import MARK, Participant

_MANY = 1000
_NAME_COMES_S = 2.0
_DDS = "::dds_::"


class Publication(NamedTuple):
    """A publisher of another program."""

    gid: bytes
    topic: str
    type_name: str
    group_data: bytes
    since_s: float


class Publications:
    """All publishers of other programs; used by one thread at a time."""

    def __init__(self, participant: Participant) -> None:
        self._own = participant.dds.guid
        self._reader = BuiltinDataReader(participant.dds, BuiltinTopicDcpsPublication)
        self._found: dict[uuid.UUID, Publication] = {}

    def look(self) -> list[Publication]:
        """Return those that exist now."""
        for endpoint in self._reader.take(_MANY):
            info = endpoint.sample_info
            if not info.valid_data or info.instance_state != InstanceState.Alive:
                self._found.pop(endpoint.key, None)
            elif endpoint.participant_key != self._own:
                group = endpoint.qos[Policy.Groupdata]
                self._found[endpoint.key] = Publication(
                    endpoint.key.bytes,
                    endpoint.topic_name,
                    endpoint.type_name,
                    group.data if group else b"",
                    time.monotonic(),
                )
        return list(self._found.values())


class Neighbours:
    """Reports to the user what others publish for one robot."""

    def __init__(
        self,
        participant: Participant,
        config: RobotConfig,
        address: str,
        report: Callable[[str], None],
    ) -> None:
        self.problems: list[str] = []
        """As of the last :meth:`look`."""
        self._participant = participant
        self._config = config
        self._address = address
        self._report = report
        self._publications = Publications(participant)
        self._reported: set[tuple[bytes, str]] = set()
        subscriptions = {each.name: each for each in config.subscriptions()}
        self._stop = subscriptions[config.remap.get(STOPS[0].name, STOPS[0].name)]
        self._cmd_vel = config.remap.get(CMD_VEL.name, CMD_VEL.name)
        topics = config.topics()
        self._once = {self._wire(topics["odom"].name), self._wire(topics["robot_description"].name)}

    def _wire(self, topic: str) -> str:
        return "rt" + resolve(topic, self._config.namespace)

    def look(self) -> None:
        """Report what is new."""
        self.problems = []
        for publication in self._publications.look():
            for problem in self._problems_of(publication):
                node = self._participant.node_of(publication.gid)
                if not node and time.monotonic() - publication.since_s < _NAME_COMES_S:
                    continue  # its node may be announced a little later
                text = f"{Sender(publication.gid.hex(), node).text} {problem}"
                self.problems.append(text)
                if (publication.gid, problem) not in self._reported:
                    self._reported.add((publication.gid, problem))
                    self._report(text)

    def _problems_of(self, publication: Publication) -> Iterator[str]:
        kind = publication.type_name.replace(_DDS, "::").replace("::", "/").removesuffix("_")
        topic = publication.topic.removeprefix("rt")
        published = f"publishes {kind} on {topic}"
        if publication.topic == self._wire(self._cmd_vel):
            remedy = self._remedy(publication.type_name)
            if remedy:
                yield f"{published}, which does not drive the robot: {remedy}"
        elif publication.topic == self._wire(self._stop.name):
            if publication.type_name != dds_name(self._stop.kind):
                yield f"{published}, which stops nothing: publish {ros_name(self._stop.kind)}"
        elif publication.topic in self._once:
            yield f"publishes {topic}, too: give one of the two another namespace, or end it"
        addresses = publication.group_data.split()
        if addresses[:1] == [MARK] and self._participant.mark_of(self._address) in addresses:
            yield f"is another node for the robot at {self._address}: end one of the two"

    def _remedy(self, type_name: str) -> str:
        drive = self._config.drive
        stamped = {dds_name(CMD_VEL.kind): True, dds_name(CMD_VEL_UNSTAMPED.kind): False}
        if type_name not in stamped:
            return f"publish {ros_name(CMD_VEL.kind)}"
        options = [] if drive.enabled else ["--enable-drive"]
        if stamped[type_name] != drive.stamped:
            if drive.stamped:
                options.append("--twist")
            else:
                return "start this node without --twist, or let that one publish Twist"
        return f"start this node with {' '.join(options)}" if options else ""
