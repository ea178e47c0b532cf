# SPDX-License-Identifier: MIT
"""Nodes, publishers and subscriptions that ROS 2 sees: what its rmw layers do, over CycloneDDS.

docs/ros2.md says which of their files each rule here is taken from.
"""

import os
import threading
from typing import Any
from xml.sax import saxutils

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic
from cyclonedds.util import duration

from ..cdr import Cdr
from ..ros_messages import type_hash
from .names import resolve
from .topics import LATCHED, Profile
from .types import struct_of

_LOOPBACKS = ("lo", "127.0.0.1", "localhost")
_ENCLAVE = b"enclave=/;"
_DISCOVERY = "ros_discovery_info"
_DISCOVERY_KIND = "rmw_dds_common/ParticipantEntitiesInfo"
_GID_SIZE, _HUMBLE_GID_SIZE = 16, 24
# A listener that hangs may hold up its robot's messages so long, and then loses them.
_LONGEST_BLOCK_MS = 100


class DdsError(Exception):
    """DDS could not be started; the message says what to do."""


class _Encoded:
    """A message that is in CDR already, as cyclonedds takes it."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    def serialize(self, use_version_2: bool | None = None) -> bytes:
        return self._data


class Publisher:
    """Sends the messages of one topic."""

    def __init__(self, writer: DataWriter[Any]) -> None:
        self.lost = 0
        """Messages that were given up, as a listener did not take them in time."""
        self._writer = writer
        self._writer.data_type = _Encoded

    @property
    def gid(self) -> bytes:
        """What ROS 2 knows it by."""
        return bytes(self._writer.guid.bytes)

    def publish(self, message: bytes) -> None:
        """Send a message in CDR."""
        try:
            self._writer.write(_Encoded(message))
        except DDSException:
            self.lost += 1


class Node:
    """A node: a name, and the publishers and readers that belong to it."""

    def __init__(self, participant: "Participant", namespace: str, name: str) -> None:
        self.namespace = namespace
        self.name = name
        self.publishers: list[Publisher] = []
        self.readers: list[DataReader[Any]] = []
        self._participant = participant

    def publisher(self, topic: str, kind: str, profile: Profile) -> Publisher:
        """Publish a topic; nobody sees to whom it belongs before ``announce``."""
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

    def _resolve(self, topic: str) -> str:
        return "rt" + resolve(topic, self.namespace)


class Participant:
    """All nodes of this program, as one participant of a domain; to be closed."""

    def __init__(self, domain: int, *, humble: bool = False, interface: str | None = None) -> None:
        self._humble = humble
        self._lock = threading.Lock()
        self._nodes: list[Node] = []
        self._topics: dict[str, DdsTopic[Any]] = {}
        settings = os.environ.get("CYCLONEDDS_URI", "")
        if interface is not None:
            settings = ",".join(filter(None, (settings, _only(interface))))
        try:
            self._domain = Domain(domain, settings)
            self.dds = DomainParticipant(domain, Qos(Policy.Userdata(_ENCLAVE)))
        except DDSException as error:
            at = f" at the interface {interface}" if interface else ""
            raise DdsError(
                f"DDS cannot start in domain {domain}{at} ({error.msg}): look at --interface and "
                "CYCLONEDDS_URI, and whether the network is up"
            ) from None
        self._topics[_DISCOVERY] = DdsTopic(
            self.dds, _DISCOVERY, struct_of(_DISCOVERY_KIND, humble)
        )
        self._discovery = Publisher(
            DataWriter(self.dds, self._topics[_DISCOVERY], _qos(_DISCOVERY_KIND, LATCHED))
        )

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

    def discovery_reader(self) -> DataReader[Any]:
        """Read what others, and we, announce."""
        qos = Qos(Policy.History.KeepAll, base=_qos(_DISCOVERY_KIND, LATCHED))
        return DataReader(self.dds, self._topics[_DISCOVERY], qos)

    def announce(self) -> None:
        """Say which nodes there are, and what belongs to them."""
        with self._lock:
            message = self._gid(Cdr(), bytes(self.dds.guid.bytes)).numbers("I", len(self._nodes))
            for node in self._nodes:
                message.text(node.namespace).text(node.name)
                readers = [bytes(reader.guid.bytes) for reader in node.readers]
                for gids in (readers, [one.gid for one in node.publishers]):
                    message.numbers("I", len(gids))
                    for gid in gids:
                        self._gid(message, gid)
            self._discovery.publish(bytes(message.data))

    def _gid(self, message: Cdr, gid: bytes) -> Cdr:
        size = _HUMBLE_GID_SIZE if self._humble else _GID_SIZE
        return message.numbers("B", *gid.ljust(size, b"\0"))

    def close(self) -> None:
        """Take everything back: others see at once that it is gone."""
        with self._lock:
            self._nodes = []
        self.announce()
        with self._lock:
            # With all that belongs to it, whoever still has a part of it.
            self._domain._delete(self._domain._ref)


def _qos(kind: str, profile: Profile) -> Qos:
    """Return what an rmw layer asks for, with the hash that tells the type."""
    durability = Policy.Durability
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=_LONGEST_BLOCK_MS))
        if profile.reliable
        else Policy.Reliability.BestEffort,
        durability.TransientLocal if profile.latched else durability.Volatile,
        Policy.History.KeepLast(profile.depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata(f"typehash={type_hash(kind)};".encode()),
    )


def _only(interface: str) -> str:
    """Return settings of CycloneDDS for one interface."""
    name = saxutils.quoteattr(interface)
    general = f"<General><Interfaces><NetworkInterface name={name}/></Interfaces></General>"
    if interface not in _LOOPBACKS:
        return general
    # Loopback mostly lacks multicast, so others there are looked for by their ports.
    return general + (
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<Peers><Peer Address='localhost'/></Peers></Discovery>"
    )
