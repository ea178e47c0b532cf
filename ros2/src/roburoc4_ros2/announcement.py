# SPDX-License-Identifier: MIT
"""What a participant announces of its nodes: rmw_dds_common/ParticipantEntitiesInfo, both forms.

A gid has 16 bytes, in Humble 24, of which the last eight are 0. Neither form can be taken for the
other.
"""

from typing import NamedTuple

from roburoc4_tools.ros.cdr import Cdr, CdrReader

GID_SIZE = 16
HUMBLE_GID_SIZE = 24
_PADDING = 3


class AnnouncedNode(NamedTuple):
    """A node, and its readers and writers by their gids of 16 bytes."""

    namespace: str
    name: str
    readers: tuple[bytes, ...]
    writers: tuple[bytes, ...]

    @property
    def full_name(self) -> str:
        """As in `ros2 node list`."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


class Announcement(NamedTuple):
    """A participant and all of its nodes."""

    gid: bytes
    nodes: tuple[AnnouncedNode, ...]

    def encode(self, gid_size: int) -> bytes:
        """Return it in CDR."""
        message = Cdr()
        _put(message, self.gid, gid_size).numbers("I", len(self.nodes))
        for node in self.nodes:
            message.text(node.namespace).text(node.name)
            for gids in (node.readers, node.writers):
                message.numbers("I", len(gids))
                for gid in gids:
                    _put(message, gid, gid_size)
        return bytes(message.data)


def decode(data: bytes) -> tuple[Announcement, int]:
    """Return an announcement and the size of its gids; ValueError if it is not one."""
    for size in (GID_SIZE, HUMBLE_GID_SIZE):
        try:
            return _decode(data, size), size
        except ValueError:
            continue
    raise ValueError("an announcement in no known form")


def _put(message: Cdr, gid: bytes, size: int) -> Cdr:
    return message.numbers("B", *gid.ljust(size, b"\0"))


def _decode(data: bytes, size: int) -> Announcement:
    reader = CdrReader(data)
    gid = _gid(reader, size)
    nodes = tuple(
        AnnouncedNode(reader.text(), reader.text(), _gids(reader, size), _gids(reader, size))
        for _ in range(_count(reader))
    )
    if reader.left > _PADDING:
        raise ValueError("it is longer than its contents")
    return Announcement(gid, nodes)


def _count(reader: CdrReader) -> int:
    (count,) = reader.numbers("I", 1)
    if count > reader.left:
        raise ValueError("a count is greater than the message")
    return int(count)


def _gids(reader: CdrReader, size: int) -> tuple[bytes, ...]:
    return tuple(_gid(reader, size) for _ in range(_count(reader)))


def _gid(reader: CdrReader, size: int) -> bytes:
    gid = reader.octets(size)
    if any(gid[GID_SIZE:]):
        raise ValueError("a gid is longer than it can be")
    return gid[:GID_SIZE]
