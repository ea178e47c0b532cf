# SPDX-License-Identifier: MIT
"""Messages as bytes: plain CDR (XCDR1), little-endian, with its header of four bytes."""

import struct
from collections.abc import Sequence

_HEAD = b"\0\1\0\0"
_SIZES = {code: struct.calcsize(code) for code in "BIifdqQ"}


class Cdr:
    """A message that is being written: each number is aligned to its size."""

    def __init__(self) -> None:
        self.data = bytearray(_HEAD)

    def numbers(self, code: str, *values: float) -> "Cdr":
        """Append numbers of one type, by its letter in ``struct``."""
        size = _SIZES[code]
        data = self.data
        data += bytes((len(_HEAD) - len(data)) % size)
        data += struct.pack(f"<{len(values)}{code}", *values)
        return self

    def text(self, text: str) -> "Cdr":
        """Append a string."""
        data = text.encode() + b"\0"
        self.numbers("I", len(data)).data += data
        return self

    def sequence(self, code: str, values: Sequence[float]) -> "Cdr":
        """Append a sequence: its length, then its numbers."""
        self.numbers("I", len(values))
        return self.numbers(code, *values) if values else self

    def header(self, made_s: float, frame: str) -> "Cdr":
        """Append a std_msgs/Header."""
        second, fraction_us = divmod(max(0, round(made_s * 1e6)), 1_000_000)
        self.numbers("I", min(second, (1 << 31) - 1), fraction_us * 1000)
        return self.text(frame)

    def transform(self, made_s: float, frames: tuple[str, str], pose: Sequence[float]) -> "Cdr":
        """Append a geometry_msgs/TransformStamped."""
        return self.header(made_s, frames[0]).text(frames[1]).numbers("d", *pose)


class CdrReader:
    """Reads what Cdr has written, in the same order; ValueError if it ends too early."""

    def __init__(self, data: bytes) -> None:
        if data[: len(_HEAD)] != _HEAD:
            raise ValueError("a message is not little-endian CDR")
        self._data = data
        self._at = len(_HEAD)

    def numbers(self, code: str, count: int) -> tuple[float, ...]:
        """Read this many numbers of one type; before none there is no padding."""
        if not count:
            return ()
        self._at += (len(_HEAD) - self._at) % _SIZES[code]
        if count * _SIZES[code] > self.left:
            raise ValueError("a message ends too early")
        values = struct.unpack_from(f"<{count}{code}", self._data, self._at)
        self._at += count * _SIZES[code]
        return values

    def octets(self, count: int) -> bytes:
        """Read this many bytes."""
        if count > self.left:
            raise ValueError("a message ends too early")
        self._at += count
        return self._data[self._at - count : self._at]

    def text(self) -> str:
        """Read a string."""
        (size,) = self.numbers("I", 1)
        return self.octets(int(size)).removesuffix(b"\0").decode()

    @property
    def left(self) -> int:
        """Bytes that were not read."""
        return len(self._data) - self._at

    def header(self) -> float:
        """Read a std_msgs/Header; return its stamp in seconds."""
        second, nanosecond = self.numbers("I", 2)
        self.text()
        return round(second + nanosecond / 1e9, 6)
