# SPDX-License-Identifier: MIT
"""Telegrams byte by byte, as sections 4.2 of the manual print them.

Not by the library, which tolerates what is to be found out here: a surplus byte, another header.
"""

import struct
from typing import NamedTuple

GET, QUERY, REPLACE, INSERT, DELETE = 0, 1, 2, 4, 5
DIRECTORY, NOTIFICATION = 0, 1
SERVICES = ("iocard", "telemeter", "battery", "localization", "differential")
MANUAL_ID = 1
CYCLE_S = 0.01
_HEAD = struct.Struct("<BBH")
_STATUS_HEAD = struct.Struct("<BHQ")
_DIFFERENTIAL = struct.Struct("<13f")
DIFFERENTIAL_BYTES = _DIFFERENTIAL.size
_TELEMETER = struct.Struct("<7f")
LIMITS = (
    "max_linear_m_s",
    "min_linear_m_s",
    "max_angular_rad_s",
    "min_angular_rad_s",
    "max_linear_m_s2",
    "min_linear_m_s2",
    "max_angular_rad_s2",
    "min_angular_rad_s2",
    "width_m",
)


class Answer(NamedTuple):
    """An answer; one of a single byte has no action."""

    at_s: float
    port: int
    id: int
    action: int | None
    target: int
    error: int
    payload: bytes


class Status(NamedTuple):
    """A status of any service."""

    at_s: float
    port: int
    service: int
    cycles: int
    payload: bytes
    other_port: bool


def request(number: int, action: int, target: int, payload: bytes = b"") -> bytes:
    """Encode a request."""
    return _HEAD.pack(number, action, target) + payload


def speeds(differential: int, linear_m_s: float, angular_rad_s: float) -> bytes:
    """Encode a differential command."""
    return struct.pack("<BHff", 0xFF, differential, linear_m_s, angular_rad_s)


def answer_of(at_s: float, port: int, data: bytes) -> Answer:
    """Decode an answer; the error of one that is too short is 255."""
    if len(data) < 5:
        return Answer(at_s, port, data[0] if data else 0, None, 0, 255, b"")
    number, action, target = _HEAD.unpack_from(data)
    return Answer(at_s, port, number, action, target, data[4], data[5:])


def status_of(at_s: float, port: int, data: bytes, other_port: bool) -> Status | None:
    """Decode the head of a status."""
    if len(data) < _STATUS_HEAD.size:
        return None
    _header, service, cycles = _STATUS_HEAD.unpack_from(data)
    return Status(at_s, port, service, cycles, data[_STATUS_HEAD.size :], other_port)


def service_of_properties(payload: bytes) -> str | None:
    """Return the service whose layout this is, which depends on neither type nor text."""
    fixed = {16: "iocard", 9: "battery", 28: "localization", 52: "differential"}
    if len(payload) in fixed:
        return fixed[len(payload)]
    if len(payload) >= 4 and len(payload) == 4 + 28 * int.from_bytes(payload[:4], "little"):
        return "telemeter"
    return None


class Speeds(NamedTuple):
    """What the differential service reported to a question that was sent then."""

    asked_s: float
    target: tuple[float, float]
    speed: tuple[float, float]


def speeds_of(asked_s: float, payload: bytes) -> Speeds:
    """Decode the speeds in the properties of the differential service."""
    values = _DIFFERENTIAL.unpack_from(payload)
    return Speeds(asked_s, values[:2], values[2:4])


def limits_of(payload: bytes) -> dict[str, float]:
    """Decode the limits in the same properties."""
    return dict(zip(LIMITS, _DIFFERENTIAL.unpack_from(payload)[4:], strict=True))


def telemeter_angles(payload: bytes) -> list[float]:
    """Decode where each telemeter points, in radians to the left of forward."""
    count = max(0, (len(payload) - 4) // _TELEMETER.size)
    return [_TELEMETER.unpack_from(payload, 4 + k * _TELEMETER.size)[2] for k in range(count)]


def bits_of(blocks: bytes, count: int) -> list[bool]:
    """Decode digital channels: 8 k + b is bit b of block k."""
    return [bool(blocks[k // 8] >> k % 8 & 1) for k in range(min(count, 8 * len(blocks)))]
