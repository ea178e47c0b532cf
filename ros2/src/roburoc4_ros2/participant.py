# SPDX-License-Identifier: MIT
"""Nodes, publishers and subscriptions that ROS 2 sees: what its rmw layers do, over CycloneDDS.

docs/ros2.md lists the files of theirs from which the rules here are taken.
"""

import contextlib
import os
import secrets
import socket
import threading
from collections.abc import Sequence
from typing import Any
from xml.sax import saxutils

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.pub import Publisher as DdsPublisher
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic
from cyclonedds.util import duration

from roburoc4_tools.ros.messages import type_hash
from roburoc4_tools.ros.published import LATCHED, Profile

from .announcement import GID_SIZE, HUMBLE_GID_SIZE, AnnouncedNode, Announcement, decode
from .names import resolve
from .remembered import keep
from .types import struct_of

# Messages that are taken at a time.
_MANY = 1000
_LOOPBACKS = ("lo", "127.0.0.1", "localhost")
# By this mark, and the robots' addresses after it, our programs recognize each other. ROS 2 ignores
# it.
MARK = b"roburoc4"
# Of a gid: the part that all gids of a participant share.
_PREFIX = 12
_ENCLAVE = b"enclave=/;"
_DISCOVERY = "ros_discovery_info"
_DISCOVERY_KIND = "rmw_dds_common/ParticipantEntitiesInfo"
# A subscriber that hangs may delay its robot's messages this long, and then loses them.
_LONGEST_BLOCK_MS = 100
# With the key's hash, Fast DDS removes at once what has ended; without it, after 10 s.
_LEAVES_AT_ONCE = "<Internal><GenerateKeyhash>true</GenerateKeyhash></Internal>"


class DdsError(Exception):
    """DDS could not be started; the message says what to do."""


class _Encoded:
    """A message that is in CDR already, as cyclonedds takes it."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    def serialize(self, use_version_2: bool | None = None) -> bytes:
        return self._data


class Raw(bytes):
    """A message in CDR as it was received; cyclonedds adds an attribute."""

    @classmethod
    def deserialize(cls, data: bytes) -> "Raw":
        """Take it as it is."""
        return cls(data)

    deserialize_key = deserialize


class Publisher:
    """Sends the messages of one topic."""

    def __init__(self, writer: DataWriter[Any]) -> None:
        self.lost = 0
        """Messages that were dropped because a subscriber did not take them in time."""
        self._writer = writer
        self._writer.data_type = _Encoded

    @property
    def gid(self) -> bytes:
        """Its identifier in ROS 2."""
        return bytes(self._writer.guid.bytes)

    def publish(self, message: bytes) -> None:
        """Send a message in CDR."""
        try:
            self._writer.write(_Encoded(message))
        except DDSException:
            self.lost += 1

    def is_heard_by(self, participant: Any) -> bool:
        """Whether a reader of that participant, by its key, is matched: it gets what is sent."""
        return any(
            (end := self._writer.get_matched_subscription_data(handle)) is not None
            and end.participant_key == participant
            for handle in self._writer.get_matched_subscriptions()
        )


class Node:
    """A node: a name, and the publishers and readers that belong to it."""

    def __init__(self, participant: "Participant", namespace: str, name: str) -> None:
        self.namespace = namespace
        self.name = name
        self.publishers: list[Publisher] = []
        self.readers: list[DataReader[Any]] = []
        self._participant = participant

    def publisher(self, topic: str, kind: str, profile: Profile) -> Publisher:
        """Publish a topic; only ``announce`` shows others that it belongs to this node."""
        dds, qos = self._participant.topic(self._resolve(topic), kind), _qos(kind, profile)
        publisher = Publisher(DataWriter(self._participant.dds, dds, qos))
        self.publishers.append(publisher)
        return publisher

    def reader(
        self, topic: str, kind: str, profile: Profile, listener: Any = None
    ) -> DataReader[Any]:
        """Read a topic, with cyclonedds' own object; likewise."""
        dds, qos = self._participant.topic(self._resolve(topic), kind), _qos(kind, profile)
        reader: DataReader[Any] = DataReader(self._participant.dds, dds, qos, listener)
        self.readers.append(reader)
        return reader

    def service(self, name: str, kind: str, depth: int) -> tuple[DataReader[Any], Publisher]:
        """Offer a service as rmw_cyclonedds_cpp does: a reader of requests, in CDR, and answers."""
        full, ends = resolve(name, self.namespace), []
        for prefix, part, suffix in (("rq", "Request", "Request"), ("rr", "Response", "Reply")):
            message = f"{kind.replace('/', '/srv/')}_{part}"
            ends.append(self._participant.topic(f"{prefix}{full}{suffix}", message))
        qos = _qos(kind, Profile(depth), f"serviceid={secrets.token_hex(16)};")
        reader: DataReader[Any] = DataReader(self._participant.dds, ends[0], qos)
        reader.topic.data_type = Raw
        publisher = Publisher(DataWriter(self._participant.dds, ends[1], qos))
        self.readers.append(reader)
        self.publishers.append(publisher)
        return reader, publisher

    def announced(self) -> AnnouncedNode:
        """Return what is announced of it."""
        readers = tuple(bytes(reader.guid.bytes) for reader in self.readers)
        writers = tuple(publisher.gid for publisher in self.publishers)
        return AnnouncedNode(self.namespace, self.name, readers, writers)

    def _resolve(self, topic: str) -> str:
        return "rt" + resolve(topic, self.namespace)


class Participant:
    """All nodes of this program, as one participant of a domain; to be closed."""

    def __init__(
        self,
        domain: int,
        *,
        humble: bool | None = None,
        interface: str | None = None,
        peers: Sequence[str] = (),
        multicast: bool = True,
        robots: Sequence[str] = (),
    ) -> None:
        """Join; nodes are announced in Humble's form or not, or (None) as other nodes are."""
        self._gid_size = HUMBLE_GID_SIZE if humble else GID_SIZE
        self._follows = humble is None
        self._others: dict[bytes, Announcement] = {}
        self._is_due = False
        self._lock = threading.Lock()
        self._nodes: list[Node] = []
        self._topics: dict[str, DdsTopic[Any]] = {}
        # Later settings win.
        settings = [_LEAVES_AT_ONCE]
        if peers:
            settings.append(_with_peers(peers, multicast))
        settings.append(os.environ.get("CYCLONEDDS_URI", ""))
        if interface is not None:
            settings.append(_only(interface))
        try:
            self._domain = Domain(domain, ",".join(filter(None, settings)))
            self.dds = DomainParticipant(domain, Qos(Policy.Userdata(_ENCLAVE)))
        except DDSException as error:
            at = f" at the interface {interface}" if interface else ""
            raise DdsError(
                f"DDS cannot start in domain {domain}{at} ({error.msg}): check --interface and "
                "CYCLONEDDS_URI, and whether the network is up"
            ) from None
        discovery, qos = self.topic(_DISCOVERY, _DISCOVERY_KIND), _qos(_DISCOVERY_KIND, LATCHED)
        mark = b" ".join([MARK, *map(self.mark_of, robots)])
        marked = DdsPublisher(self.dds, Qos(Policy.Groupdata(mark)))
        self._discovery = Publisher(DataWriter(marked, discovery, qos))
        all_of_others = Qos(Policy.History.KeepAll, Policy.IgnoreLocal.Participant, base=qos)
        self._heard: DataReader[Any] = DataReader(self.dds, discovery, all_of_others)
        self._heard.topic.data_type = Raw

    @staticmethod
    def mark_of(address: str) -> bytes:
        """Return what stands for a robot in the mark: a loopback address is this computer's."""
        here = socket.gethostname() if address.startswith("127.") else ""
        return f"{here}/{address}".encode()

    def node(self, namespace: str, name: str) -> Node:
        """Make a node; call ``announce`` when it has all its topics."""
        node = Node(self, namespace, name)
        with self._lock:
            self._nodes.append(node)
        return node

    def topic(self, name: str, kind: str) -> DdsTopic[Any]:
        """Return the topic of a name on the wire."""
        with self._lock:
            if name not in self._topics:
                self._topics[name] = DdsTopic(self.dds, name, struct_of(kind))
            return self._topics[name]

    def announce(self) -> None:
        """Announce all nodes, and what belongs to them."""
        with self._lock:
            nodes = tuple(node.announced() for node in self._nodes)
            message = Announcement(bytes(self.dds.guid.bytes), nodes).encode(self._gid_size)
            self._is_due = False
        self._discovery.publish(message)  # may wait for a subscriber: not under the lock

    def look(self) -> None:
        """Read what others announce; announce the nodes again if the form must change to theirs."""
        self._hear()
        if self._is_due:
            self.announce()

    def _hear(self) -> None:
        with self._lock:
            for data in self._heard.take(_MANY):
                if not isinstance(data, Raw):  # a participant has left
                    continue
                with contextlib.suppress(ValueError):
                    announcement, size = decode(data)
                    self._remember(announcement)
                    if size == self._gid_size or not self._follows or not announcement.nodes:
                        continue
                    if not self._is_ours(data):
                        self._gid_size, self._is_due = size, True

    def _remember(self, announcement: Announcement) -> None:
        if announcement.nodes:
            keep(self._others, announcement.gid, announcement)
        else:
            self._others.pop(announcement.gid, None)

    def _is_ours(self, data: Any) -> bool:
        """Whether our own kind of program announces that: two would follow each other."""
        with contextlib.suppress(DDSException):
            handle = data.sample_info.publication_handle
            if endpoint := self._heard.get_matched_publication_data(handle):
                group = endpoint.qos[Policy.Groupdata]
                return group is not None and group.data.startswith(MARK)
        return True  # one that has left is not followed

    def others(self) -> list[Announcement]:
        """Return what other participants announced last."""
        self._hear()
        with self._lock:
            return list(self._others.values())

    def node_of(self, gid: bytes) -> str:
        """Return the full name of the node that a publisher belongs to; empty if not known.

        What announces nodes belongs to all of its participant: the first is named.
        """
        found = [(one, node) for one in self.others() for node in one.nodes]
        nodes = [node for _, node in found if gid in node.writers]
        nodes += [node for one, node in found if gid[:_PREFIX] == one.gid[:_PREFIX]]
        return nodes[0].full_name if nodes else ""

    def close(self) -> None:
        """Withdraw everything: others see at once that it is gone."""
        with self._lock:
            self._nodes = []
        self.announce()
        with self._lock:
            # With all that belongs to it, even if something else still refers to a part.
            self._domain._delete(self._domain._ref)


def _qos(kind: str, profile: Profile, user_data: str = "") -> Qos:
    """Return the QoS that an rmw layer requests, with the type's hash or other data."""
    durability = Policy.Durability
    policies = [Policy.Lifespan(duration(seconds=profile.lifespan_s))] if profile.lifespan_s else []
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=_LONGEST_BLOCK_MS))
        if profile.reliable
        else Policy.Reliability.BestEffort,
        durability.TransientLocal if profile.latched else durability.Volatile,
        Policy.History.KeepLast(profile.depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata((user_data or f"typehash={type_hash(kind)};").encode()),
        *policies,
    )


def _only(interface: str) -> str:
    """Return settings of CycloneDDS for one interface."""
    name = saxutils.quoteattr(interface)
    general = f"<General><Interfaces><NetworkInterface name={name}/></Interfaces></General>"
    if interface not in _LOOPBACKS:
        return general
    # Loopback usually lacks multicast.
    return general + _with_peers(["localhost"], multicast=True)


def _with_peers(peers: Sequence[str], multicast: bool) -> str:
    """Return settings that also search these hosts for participants, by their ports, as ROS 2."""
    found = "".join(f"<Peer Address={saxutils.quoteattr(peer)}/>" for peer in peers)
    return ("" if multicast else "<General><AllowMulticast>false</AllowMulticast></General>") + (
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        f"<Peers>{found}</Peers></Discovery>"
    )
