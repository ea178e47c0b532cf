# SPDX-License-Identifier: MIT
"""A part of one recording, or of several that are merged by time."""

from __future__ import annotations

import heapq
import re
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

from roburoc4.constants import DEFAULT_PORT

from .capture import Capture, Datagram, RawWriter

_STATUS = 0xFF
_MOST_ANSWERS = 10_000
_CLOCK = re.compile(r"(?:(?:(\d+):)?(\d+):)?(\d+(?:\.\d+)?)", re.ASCII)

When = Callable[[float], float]
"""A time as Unix time, from the Unix time at which the recording begins."""


def when(text: str) -> When:
    """Read a time: seconds or [H:]M:S after the beginning, or a date and time (ISO 8601, UTC)."""
    if match := _CLOCK.fullmatch(text):
        hours, minutes, seconds = match.groups(default="0")
        offset_s = int(hours) * 3600 + int(minutes) * 60 + float(seconds)
        return lambda begun_s: begun_s + offset_s
    moment = datetime.fromisoformat(text)  # ValueError
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=UTC)
    return lambda _: moment.timestamp()


def merged(paths: Sequence[Path]) -> Iterator[Datagram]:
    """Yield the datagrams of recordings by their time."""
    return heapq.merge(*map(Capture, paths), key=lambda datagram: datagram.time_us)


def cut(
    paths: Sequence[Path], target: IO[bytes], begin: When | None, end: When | None
) -> tuple[int, int]:
    """Write what was recorded from ``begin`` to before ``end``; return datagrams and answers.

    What the robots had answered before (services, counts, texts) is written at the beginning, as
    the statuses cannot be read without it.
    """
    writer = RawWriter(target)
    # By who asked or answered what; the last counts, so that an answer has its request's id.
    before: dict[tuple[object, object, bytes], Datagram] | None = {}
    begin_us = end_us = None
    answers = 0
    for datagram in merged(paths):
        if begin_us is None or end_us is None:
            begun_s = datagram.time_us / 1e6
            begin_us = datagram.time_us if begin is None else round(begin(begun_s) * 1e6)
            end_us = 1 << 62 if end is None else round(end(begun_s) * 1e6)
        if datagram.time_us >= end_us:
            break
        if datagram.time_us < begin_us:
            assert before is not None
            if datagram.payload[:1] != bytes([_STATUS]) and len(before) < _MOST_ANSWERS:
                key = (datagram.source, datagram.destination, datagram.payload[1:])
                before.pop(key, None)
                before[key] = datagram
            continue
        for earlier in before.values() if before else ():
            writer.add(earlier._replace(time_us=begin_us), _is_inbound(earlier))
            answers += 1
        before = None
        writer.add(datagram, _is_inbound(datagram))
    return writer.datagrams - answers, answers


def _is_inbound(datagram: Datagram) -> bool:
    if datagram.inbound is not None:
        return datagram.inbound
    return datagram.source[1] == DEFAULT_PORT
