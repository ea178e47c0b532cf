# SPDX-License-Identifier: MIT
"""Who publishes: the node of a publisher, as its middleware announces it."""

import contextlib
from typing import Any

from cyclonedds.core import DDSException
from cyclonedds.sub import DataReader

from .commands import Sender
from .participant import Participant
from .remembered import keep


class Senders:
    """Publishers of some topics; used by one thread at a time."""

    def __init__(self, participant: Participant) -> None:
        self._participant = participant
        self._known: dict[int, bytes] = {}

    def of(self, reader: DataReader[Any], handle: int) -> Sender:
        """Return who sent what this reader got from the publisher of this handle."""
        gid = self._gid(reader, handle)
        return Sender(gid.hex(), self._participant.node_of(gid))

    def _gid(self, reader: DataReader[Any], handle: int) -> bytes:
        if handle not in self._known:
            endpoint = None
            with contextlib.suppress(DDSException):  # it is gone already
                endpoint = reader.get_matched_publication_data(handle)
            if endpoint is None:
                return handle.to_bytes(8, "big")
            keep(self._known, handle, endpoint.key.bytes)
        return self._known[handle]
