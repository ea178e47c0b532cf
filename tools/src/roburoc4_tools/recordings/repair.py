# SPDX-License-Identifier: MIT
"""Recovers everything that is complete from a recording that was truncated or damaged."""

import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import IO, NamedTuple

from roburoc4.errors import RecordingError

from .capture import MOST_BLOCK, PCAP_MAGIC

_SECTION_BYTES = b"\n\r\r\n"
_MCAP_BYTES = b"\x89MCA"
_PACKET_BLOCKS = (3, 6)
_BLOCKS = (0x0A0D0D0A, 1, 2, 3, 4, 5, 6, 0xBAD, 0x40000BAD)
_PCAP_HEAD, _PCAP_RECORD = 24, 16

Show = Callable[[int], None]


class Recovered(NamedTuple):
    """What was saved of a file."""

    packets: int
    """Datagrams, rows or messages that were saved."""
    kept: int
    """Bytes that were usable."""
    left_out: int
    """Bytes that were not."""


def recover(source: Path, target: IO[bytes], show: Show) -> Recovered:
    """Copy what is complete in a pcapng, pcap, MCAP or CSV file.

    ``show`` is called with the number of bytes read.
    """
    with source.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        magic = file.read(4)
        if magic == _SECTION_BYTES:
            return _pcapng(file, size, target, show)
        if magic in PCAP_MAGIC:
            return _pcap(file, size, PCAP_MAGIC[magic][0], target, show)
        if magic == _MCAP_BYTES:
            return _mcap(file, size, target, show)
        if source.suffix.lower() == ".csv":
            return _rows(file, size, target, show)
    raise RecordingError(
        f"{source} does not begin as a pcapng, pcap, MCAP or CSV file does: nothing can be saved"
    )


class _Blocks:
    """The blocks of a pcapng file, by their place."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file = file
        self._size = size
        self._order = "<"

    def size_at(self, at: int) -> int:
        """Return the size of the complete block that begins there; 0 if there is none."""
        head = self._read(at, 12)
        if len(head) < 12:
            return 0
        order = self._order
        if head[:4] == _SECTION_BYTES:
            order = ">" if head[8:] == b"\x1a\x2b\x3c\x4d" else "<"
        kind, size = struct.unpack(order + "II", head[:8])
        if kind not in _BLOCKS or not 12 <= size <= MOST_BLOCK or size % 4:
            return 0
        if struct.pack(order + "I", size) != self._read(at + size - 4, 4):
            return 0
        self._order = order
        return int(size)

    def is_packet(self, at: int) -> bool:
        """Whether the block that begins there holds a packet."""
        return struct.unpack(self._order + "I", self._read(at, 4))[0] in _PACKET_BLOCKS

    def next_after(self, at: int) -> int:
        """Return where the next complete block begins; the file's size if there is none."""
        at += 4
        while at < self._size and not self.size_at(at):
            at += 4
        return min(at, self._size)

    def copy(self, at: int, size: int, target: IO[bytes]) -> None:
        """Copy a block."""
        target.write(self._read(at, size))

    def _read(self, at: int, size: int) -> bytes:
        self._file.seek(at)
        return self._file.read(size)


def _pcapng(file: IO[bytes], size: int, target: IO[bytes], show: Show) -> Recovered:
    blocks, at, kept, packets = _Blocks(file, size), 0, 0, 0
    while at < size:
        length = blocks.size_at(at)
        if not length:
            at = blocks.next_after(at)
            continue
        packets += blocks.is_packet(at)
        blocks.copy(at, length, target)
        at += length
        kept += length
        if packets % 4096 == 0:
            show(at)
    return Recovered(packets, kept, size - kept)


def _pcap(file: IO[bytes], size: int, order: str, target: IO[bytes], show: Show) -> Recovered:
    file.seek(0)
    head = file.read(_PCAP_HEAD)
    if len(head) < _PCAP_HEAD:
        return Recovered(0, 0, size)
    target.write(head)
    kept, packets = _PCAP_HEAD, 0
    while len(record := file.read(_PCAP_RECORD)) == _PCAP_RECORD:
        length = struct.unpack_from(order + "I", record, 8)[0]
        data = file.read(length) if length <= MOST_BLOCK else b""
        if len(data) < length:
            break  # truncated; nothing marks where another packet begins
        target.write(record + data)
        kept += _PCAP_RECORD + length
        packets += 1
        if packets % 4096 == 0:
            show(kept)
    return Recovered(packets, kept, size - kept)


def _rows(file: IO[bytes], size: int, target: IO[bytes], show: Show) -> Recovered:
    file.seek(0)
    kept = rows = 0
    columns = -1
    for line in file:
        cells = line.count(b",")
        columns = cells if columns < 0 else columns
        if not line.endswith(b"\n") or cells != columns or b"\0" in line:
            continue
        target.write(line)
        kept += len(line)
        rows += 1
        if rows % 4096 == 0:
            show(kept)
    return Recovered(max(0, rows - 1), kept, size - kept)


def _mcap(file: IO[bytes], size: int, target: IO[bytes], show: Show) -> Recovered:
    """Write the messages of complete chunks to a file with a new index."""
    from mcap.records import Channel, Header, Message, Schema
    from mcap.stream_reader import StreamReader
    from mcap.writer import Writer

    file.seek(0)
    writer, messages = Writer(target), 0
    schemas: dict[int, int] = {0: 0}
    channels: dict[int, int] = {}
    begun = False
    try:
        for record in StreamReader(file).records:
            if isinstance(record, Header):
                writer.start(record.profile, record.library)
                begun = True
            elif isinstance(record, Schema) and record.id not in schemas:
                schemas[record.id] = writer.register_schema(
                    record.name, record.encoding, record.data
                )
            elif isinstance(record, Channel) and record.id not in channels:
                channels[record.id] = writer.register_channel(
                    record.topic,
                    record.message_encoding,
                    schemas[record.schema_id],
                    record.metadata,
                )
            elif isinstance(record, Message):
                channel = channels[record.channel_id]
                writer.add_message(
                    channel, record.log_time, record.data, record.publish_time, record.sequence
                )
                messages += 1
                if messages % 4096 == 0:
                    show(file.tell())
    except Exception:  # the reader raises several kinds of error on a damaged file
        pass
    if not begun:
        raise RecordingError("the MCAP file has no whole header: nothing can be recovered")
    left = size - min(size, file.tell())
    writer.finish()  # type: ignore[no-untyped-call]
    return Recovered(messages, size - left, left)
