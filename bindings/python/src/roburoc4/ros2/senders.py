# SPDX-License-Identifier: MIT
"""Who publishes: the node of a publisher, as its middleware announces it."""

import contextlib
from typing import Any

from cyclonedds.core import DDSException
from cyclonedds.sub import DataReader

from .commands import Sender, keep
from .participant import Participant


class Senders:
    """Publishers of some topics; used by one thread at a time."""

    def __init__(self, participant: Participant) -> None:
        self._announced = participant.discovery_reader()
        self._nodes: dict[bytes, dict[bytes, str]] = {}
        self._known: dict[int, bytes] = {}

    def of(self, reader: DataReader[Any], handle: int) -> Sender:
        """Return who sent what this reader got from the publisher of this handle."""
        gid = self._gid(reader, handle)
        self._hear()
        nodes = (nodes[gid] for nodes in self._nodes.values() if gid in nodes)
        return Sender(gid.hex(), next(nodes, ""))

    def _gid(self, reader: DataReader[Any], handle: int) -> bytes:
        if handle not in self._known:
            endpoint = None
            with contextlib.suppress(DDSException):  # it is gone already
                endpoint = reader.get_matched_publication_data(handle)
            if endpoint is None:
                return handle.to_bytes(8, "big")
            keep(self._known, handle, endpoint.key.bytes)
        return self._known[handle]

    def _hear(self) -> None:
        while True:
            try:
                samples = self._announced.take(1)
            except DDSException:
                return
            except Exception:  # of another distribution, or broken
                continue
            if not samples:
                return
            for sample in samples:
                if sample.sample_info.valid_data:
                    names = {
                        bytes(gid.data)[:16]: f"{node.node_namespace.rstrip('/')}/{node.node_name}"
                        for node in sample.node_entities_info_seq
                        for gid in node.writer_gid_seq
                    }
                    keep(self._nodes, bytes(sample.gid.data), names)
