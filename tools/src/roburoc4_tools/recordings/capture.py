# SPDX-License-Identifier: MIT
"""UDP datagrams of a capture: pcapng or pcap, by our recorder, tcpdump, dumpcap or Wireshark.

Blocks are read one after the other, so memory does not grow with the file, and a truncated file is
read up to its end. The libraries on PyPI were tried: dpkt and python-pcapng raise an exception
where a file is truncated and skip the drop counts, and a datagram takes 5 (dpkt) to 80 (scapy)
times as long.
"""

import gzip
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple, cast

from roburoc4.constants import Result
from roburoc4.errors import RecordingError

_SECTION, _INTERFACE, _SIMPLE, _STATISTICS, _ENHANCED = 0x0A0D0D0A, 1, 3, 5, 6
_BYTE_ORDER = 0x1A2B3C4D
PCAP_MAGIC = {
    b"\xd4\xc3\xb2\xa1": ("<", 1),
    b"\xa1\xb2\xc3\xd4": (">", 1),
    b"\x4d\x3c\xb2\xa1": ("<", 1000),
    b"\xa1\xb2\x3c\x4d": (">", 1000),
}
_GZIP = b"\x1f\x8b"
MOST_BLOCK = 16 << 20
_MOST_FRAGMENTED = 64
_OPTION_FLAGS, _OPTION_DROPPED, _OPTION_RESOLUTION, _OPTION_OFFSET, _OPTION_ISB_DROPPED = (
    2,
    4,
    9,
    14,
    5,
)
_ONLY_FLAGS = b"\x02\0\x04\0"  # little-endian: then its direction is known, too
_INBOUND = {1: True, 2: False}
_VLAN = (0x8100, 0x88A8, 0x9100)
_IPV4, _IPV6, _UDP = 0x0800, 0x86DD, 17
_IPV6_EXTENSIONS = (0, 43, 60)
_IPV6_FRAGMENT = 44


class Endpoint(NamedTuple):
    """A UDP address: 4 or 16 bytes, and a port."""

    host: bytes
    port: int

    def __str__(self) -> str:
        import ipaddress

        address = ipaddress.ip_address(self.host)
        return f"[{address}]:{self.port}" if address.version == 6 else f"{address}:{self.port}"


class Datagram(NamedTuple):
    """A UDP datagram, and when it was captured."""

    time_us: int
    """Unix time."""
    source: tuple[bytes, int]
    """As an :class:`Endpoint`."""
    destination: tuple[bytes, int]
    payload: bytes
    inbound: bool | None
    """Whether the capturing machine received it; None if the file does not record it."""


class Capture:
    """The datagrams of a file, to be read once; ``cut`` and ``dropped`` grow meanwhile."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.cut = 0
        """Bytes at the end that are not a whole block: the file was truncated there."""
        self.dropped = 0
        """Datagrams that the recorder could not write, if it counted them."""
        self.position = 0
        """Bytes of whole blocks that were read."""
        self._fragments: dict[bytes, dict[int, bytes]] = {}

    def __iter__(self) -> Iterator[Datagram]:
        with self._open() as file:
            magic = file.read(4)
            file.seek(0)
            if magic in PCAP_MAGIC:
                packets = self._pcap(file)
            elif magic == b"\n\r\r\n":
                packets = self._pcapng(file)
            elif magic == b"#ROS":
                raise RecordingError(
                    f"{self.path} is a bag of ROS 1, which has messages instead of the robot's "
                    "datagrams: give a pcapng or pcap file"
                )
            elif len(magic) < 4:
                raise RecordingError(f"{self.path} is empty: nothing was recorded")
            else:
                raise RecordingError(
                    f"{self.path} is neither pcapng nor pcap: give a file of roburoc4 record, "
                    "tcpdump or Wireshark"
                )
            for time_us, link, data, inbound in packets:
                found = _fast_raw(data) if link == 101 else None
                found = found or self._parse(link, data)
                if found is not None:
                    yield Datagram(time_us, found[0], found[1], found[2], inbound)

    # ---- files ----

    def _open(self) -> IO[bytes]:
        """Open the file, compressed by gzip or not."""
        if self.path.exists() and not self.path.is_file():
            raise RecordingError(
                f"{self.path} is no file, and a recording is read more than once: save it to a "
                "file first"
            )
        try:
            file = self.path.open("rb")
        except (OSError, ValueError) as error:
            cause = getattr(error, "strerror", None) or error
            raise RecordingError(f"{self.path} cannot be read ({cause})", Result.SYSTEM) from None
        if file.read(2) == _GZIP:
            file.close()
            return cast("IO[bytes]", gzip.open(self.path))
        file.seek(0)
        return file

    def _take(self, file: IO[bytes], size: int) -> bytes | None:
        """Read this many bytes; None at the end, or where the file is truncated."""
        try:
            data = file.read(size)
        except (EOFError, zlib.error, gzip.BadGzipFile):
            data = b""
            self.cut += 1
        if len(data) == size:
            return data
        self.cut += len(data)
        return None

    def _damaged(self, what: str) -> RecordingError:
        return RecordingError(
            f"{self.path} is damaged {self.position} bytes from its beginning ({what}): run "
            "roburoc4 recover"
        )

    def _pcap(self, file: IO[bytes]) -> Iterator[tuple[int, int, bytes, bool | None]]:
        head = self._take(file, 24)
        if head is None:
            return
        order, fraction_us = PCAP_MAGIC[head[:4]]
        link = struct.unpack_from(order + "I", head, 20)[0] & 0x0FFFFFFF
        record = struct.Struct(order + "IIII")
        self.position = 24
        while (head := self._take(file, 16)) is not None:
            seconds, fraction, size, _ = record.unpack(head)
            if size > MOST_BLOCK:
                raise self._damaged(f"a packet of {size} bytes")
            data = self._take(file, size)
            if data is None:
                self.cut += 16
                return
            self.position += 16 + size
            yield seconds * 1_000_000 + fraction // fraction_us, link, data, None

    def _pcapng(self, file: IO[bytes]) -> Iterator[tuple[int, int, bytes, bool | None]]:
        order = "<"
        interfaces: list[_Interface] = []
        head_of, enhanced = struct.Struct("<II"), struct.Struct("<IIIII")
        while (head := self._take(file, 8)) is not None:
            kind, size = head_of.unpack(head)
            if kind == _SECTION:
                mark = self._take(file, 4)
                if mark is None:
                    self.cut += 8
                    return
                order = "<" if mark == _BYTE_ORDER.to_bytes(4, "little") else ">"
                if int.from_bytes(mark, "little" if order == "<" else "big") != _BYTE_ORDER:
                    raise self._damaged("no byte order")
                head_of, enhanced = struct.Struct(order + "II"), struct.Struct(order + "IIIII")
                size = head_of.unpack(head)[1] - 4
                head += mark
                interfaces = []
            if not 12 <= size <= MOST_BLOCK or size % 4:
                raise self._damaged(f"a block of {size} bytes")
            body = self._take(file, size - 8)
            if body is None:
                self.cut += len(head)
                return
            if struct.unpack_from(order + "I", body, len(body) - 4)[0] != size + len(head) - 8:
                raise self._damaged("two lengths that differ")
            body = body[:-4]
            if kind == _ENHANCED:
                if len(body) < 20:
                    raise self._damaged("a short packet block")
                number, high, low, length, _ = enhanced.unpack_from(body)
                if number >= len(interfaces) or 20 + length > len(body):
                    raise self._damaged("a packet block that fits no interface or is too short")
                interface = interfaces[number]
                inbound = None
                at = 20 + (length + 3) // 4 * 4
                if body[at : at + 4] == _ONLY_FLAGS and len(body) == at + 12:  # our own files
                    inbound = _INBOUND.get(body[at + 4] & 3)
                elif at < len(body):
                    inbound = self._packet_options(body, at, order)
                yield (
                    interface.time_us(high << 32 | low),
                    interface.link,
                    body[20 : 20 + length],
                    inbound,
                )
            elif kind == _INTERFACE:
                if len(body) < 8:
                    raise self._damaged("a short interface block")
                interfaces.append(_Interface(body, order))
            elif kind == _STATISTICS:
                self._statistics(body, order, interfaces)
            # a simple packet block has no time, and others no packet
            self.position += size + len(head) - 8

    def _packet_options(self, body: bytes, at: int, order: str) -> bool | None:
        inbound = None
        for code, value in _options(body, at, order):
            if code == _OPTION_FLAGS and len(value) == 4:
                direction = struct.unpack(order + "I", value)[0] & 3
                inbound = _INBOUND.get(direction)
            elif code == _OPTION_DROPPED and len(value) == 8:
                self.dropped += struct.unpack(order + "Q", value)[0]
        return inbound

    def _statistics(self, body: bytes, order: str, interfaces: list["_Interface"]) -> None:
        """Add the drops of an interface; those counted with packets are part of them."""
        if len(body) < 12:
            return
        number = struct.unpack_from(order + "I", body)[0]
        for code, value in _options(body, 12, order):
            if code == _OPTION_ISB_DROPPED and len(value) == 8 and number < len(interfaces):
                interfaces[number].dropped = struct.unpack(order + "Q", value)[0]
        self.dropped = max(self.dropped, sum(one.dropped for one in interfaces))

    # ---- packets ----

    def _parse(
        self, link: int, data: bytes
    ) -> tuple[tuple[bytes, int], tuple[bytes, int], bytes] | None:
        """Find the UDP datagram in a packet; None if there is none, or not all of it yet."""
        try:
            found = _network(link, data)
            if found is None:
                return None
            if found[0] == _IPV4:
                return self._ipv4(data, found[1])
            return self._ipv6(data, found[1])
        except (struct.error, IndexError):  # shorter than its headers
            return None

    def _ipv4(
        self, data: bytes, at: int
    ) -> tuple[tuple[bytes, int], tuple[bytes, int], bytes] | None:
        head = data[at] & 15
        size, identification, fragment, _, protocol = struct.unpack_from("!HHHBB", data, at + 2)
        if protocol != _UDP or head < 5 or data[at] >> 4 != 4:
            return None
        hosts = data[at + 12 : at + 20]
        # 0: the network card cuts it into segments after the capture
        body = data[at + 4 * head : at + size if size else None]
        if fragment & 0x3FFF:
            key = hosts + identification.to_bytes(2)
            joined = self._join(key, (fragment & 0x1FFF) * 8, body, bool(fragment & 0x2000))
            if joined is None:
                return None
            body = joined
        return _udp(hosts[:4], hosts[4:], body)

    def _ipv6(
        self, data: bytes, at: int
    ) -> tuple[tuple[bytes, int], tuple[bytes, int], bytes] | None:
        size, protocol = struct.unpack_from("!HB", data, at + 4)
        source, destination = data[at + 8 : at + 24], data[at + 24 : at + 40]
        body = data[at + 40 : at + 40 + size]
        while protocol in _IPV6_EXTENSIONS:
            protocol, body = body[0], body[8 + 8 * body[1] :]
        if protocol == _IPV6_FRAGMENT:
            protocol, fragment = body[0], struct.unpack_from("!H", body, 2)[0]
            joined = self._join(
                source + destination + body[4:8], fragment & 0xFFF8, body[8:], bool(fragment & 1)
            )
            if joined is None:
                return None
            body = joined
        return _udp(source, destination, body) if protocol == _UDP else None

    def _join(self, key: bytes, offset: int, part: bytes, more: bool) -> bytes | None:
        """Store a fragment; return the datagram once it is complete."""
        parts = self._fragments.pop(key, {})
        parts[offset if more else -1 - offset] = part  # the last one is marked
        self._fragments[key] = parts
        if len(self._fragments) > _MOST_FRAGMENTED:
            self._fragments.pop(next(iter(self._fragments)))
        last = min(parts)
        if last >= 0:
            return None
        whole = b""
        while len(whole) != -1 - last:
            if len(whole) not in parts or not parts[len(whole)]:
                return None
            whole += parts[len(whole)]
        del self._fragments[key]
        return whole + parts[last]


class _Interface:
    """What an interface block specifies for the packets that follow."""

    def __init__(self, body: bytes, order: str) -> None:
        self.link: int = struct.unpack_from(order + "H", body)[0]
        self.dropped = 0
        self._units, self._offset_s = 1_000_000, 0
        for code, value in _options(body, 8, order):
            if code == _OPTION_RESOLUTION and len(value) == 1:
                power = value[0] & 0x7F
                self._units = 2**power if value[0] & 0x80 else 10 ** min(power, 30)
            elif code == _OPTION_OFFSET and len(value) == 8:
                self._offset_s = struct.unpack(order + "q", value)[0]

    def time_us(self, stamp: int) -> int:
        """Convert a packet's time to Unix time; clients count it in 63 bits."""
        if self._units != 1_000_000:
            stamp = stamp * 1_000_000 // self._units
        return min(max(stamp + self._offset_s * 1_000_000, 0), 1 << 62)


def _options(body: bytes, at: int, order: str) -> Iterator[tuple[int, bytes]]:
    """Yield number and value; an option that is too short for its length ends them."""
    while at + 4 <= len(body):
        code, size = struct.unpack_from(order + "HH", body, at)
        if code == 0 or at + 4 + size > len(body):
            return
        yield code, body[at + 4 : at + 4 + size]
        at += 4 + (size + 3) // 4 * 4


def _network(link: int, data: bytes) -> tuple[int, int] | None:
    """Return the type and the position of the network layer, by the type of the link."""
    if link in (101, 12, 14):  # raw IP
        return {4: _IPV4, 6: _IPV6}.get(data[0] >> 4, 0), 0
    if link == 1:
        kind, at = struct.unpack_from("!H", data, 12)[0], 14
    elif link == 113:  # Linux "any"
        kind, at = struct.unpack_from("!H", data, 14)[0], 16
    elif link == 276:  # the same, version 2
        kind, at = struct.unpack_from("!H", data, 0)[0], 20
    elif link in (0, 108):  # BSD loopback: 2 is IPv4, others IPv6
        family = max(data[0], data[3])
        kind, at = (_IPV4 if family == 2 else _IPV6), 4
    else:
        return None
    while kind in _VLAN:
        kind, at = struct.unpack_from("!H", data, at + 2)[0], at + 4
    return (kind, at) if kind in (_IPV4, _IPV6) else None


def _udp(
    source: bytes, destination: bytes, body: bytes
) -> tuple[tuple[bytes, int], tuple[bytes, int], bytes] | None:
    source_port, destination_port, size = struct.unpack_from("!HHH", body)
    if not 8 <= size <= len(body):  # cut by the capture's snapshot length
        return None
    return (source, source_port), (destination, destination_port), body[8:size]


_PLAIN = struct.Struct("!BxHxxHxB2x4s4sHHH")


def _fast_raw(data: bytes) -> tuple[tuple[bytes, int], tuple[bytes, int], bytes] | None:
    """Find the datagram in the usual packet of our own files: IPv4 without options, complete."""
    if len(data) < 28:
        return None
    version, size, fragment, protocol, source, destination, from_port, to_port, length = (
        _PLAIN.unpack_from(data)
    )
    if version != 0x45 or fragment & 0x3FFF or protocol != _UDP:
        return None
    if not 8 <= length <= size - 20 <= len(data) - 20:
        return None
    return (source, from_port), (destination, to_port), data[28 : 20 + length]


class RawWriter:
    """Writes datagrams as pcapng of raw IP, as our recorder does."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self.datagrams = 0
        section = struct.pack("<IHHq", _BYTE_ORDER, 1, 0, -1)
        file.write(_block(_SECTION, section) + _block(_INTERFACE, struct.pack("<HHI", 101, 0, 0)))

    def add(self, datagram: Datagram, inbound: bool) -> None:
        """Append a datagram."""
        source, destination = datagram.source, datagram.destination
        body = struct.pack("!HHHH", source[1], destination[1], 8 + len(datagram.payload), 0)
        body += datagram.payload
        if len(source[0]) == 4:
            head = struct.pack("!BBHHHBBH", 0x45, 0, 20 + len(body), 0, 0x4000, 64, _UDP, 0)
            head += source[0] + destination[0]
            head = head[:10] + _checksum(head) + head[12:]
        else:
            head = struct.pack("!IHBB", 6 << 28, len(body), _UDP, 64) + source[0] + destination[0]
        packet = head + body
        time_us = datagram.time_us
        block = struct.pack(
            "<IIIII", 0, time_us >> 32, time_us & 0xFFFFFFFF, len(packet), len(packet)
        )
        flags = struct.pack("<HHIHH", _OPTION_FLAGS, 4, 1 if inbound else 2, 0, 0)
        self._file.write(_block(_ENHANCED, block + packet + bytes(-len(packet) % 4) + flags))
        self.datagrams += 1


def _block(kind: int, body: bytes) -> bytes:
    size = struct.pack("<I", 12 + len(body))
    return struct.pack("<I", kind) + size + body + size


def _checksum(head: bytes) -> bytes:
    total = sum(struct.unpack("!10H", head))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return struct.pack("!H", ~total & 0xFFFF)
