# SPDX-License-Identifier: MIT
"""Telegrams for tools: bytes to typed records, and many statuses to a NumPy table."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from . import _native
from .constants import Action, Result, Service
from .errors import ArgumentError, DecodeError, is_within, unusable
from .iocard import decode_text
from .records import (
    Answer,
    AnswerBody,
    IoCardCommand,
    Telegram,
    UnknownCommand,
    UnknownStatus,
)
from .settings import service_of

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

__all__ = ["Batch", "Layout", "decode", "decode_batch", "encode_answer", "usual_answer"]

Bytes: TypeAlias = bytes | bytearray | memoryview


class Layout(NamedTuple):
    """What the bytes do not contain: the services' ids, and the IO card's channel counts."""

    iocard: int = 2
    telemeter: int = 3
    battery: int = 4
    localization: int = 5
    differential: int = 6
    analog_inputs: int = 9
    analog_outputs: int = 0
    digital_inputs: int = 22
    digital_outputs: int = 8


_USUAL = Layout()
_STATUS = 0xFF
# As plain integers: each telegram is compared with them.
_IOCARD, _DIFFERENTIAL = int(Service.IOCARD), int(Service.DIFFERENTIAL)
_GET, _QUERY = int(Action.GET), int(Action.QUERY)
_decode_status = _native.decode_status
_PROPERTIES: dict[int, Callable[[bytes], Any]] = {
    Service.DIRECTORY: _native.roburoc4_decode_directory,
    Service.NOTIFICATION: _native.roburoc4_decode_notification,
    Service.IOCARD: _native.roburoc4_decode_iocard_properties,
    Service.TELEMETER: _native.roburoc4_decode_telemeter_properties,
    Service.BATTERY: _native.roburoc4_decode_battery_properties,
    Service.LOCALIZATION: _native.roburoc4_decode_localization_properties,
    Service.DIFFERENTIAL: _native.roburoc4_decode_differential_properties,
}


def decode(
    data: Bytes, layout: Layout | None = None, sender: Literal["robot", "client"] = "robot"
) -> Telegram:
    """Decode one datagram from a robot (or, on request, from a client).

    A status becomes the record of its service, an answer an :class:`~roburoc4.protocol.Answer`,
    a client's telegram a :class:`~roburoc4.protocol.Request` or a command. Raises DecodeError for
    anything else.
    """
    try:
        if isinstance(sender, str) and sender == "robot":
            return _decode_status(data, layout) or _decode_other(
                data, _USUAL if layout is None else layout
            )
        if isinstance(sender, str) and sender == "client":
            return _decode_sent(data, _USUAL if layout is None else layout)
    except OverflowError:
        raise ArgumentError(
            f"{layout} is out of range: ids are 0 to 65535, counts 0 to 2147483647",
            Result.ARGUMENT,
        ) from None
    except (AttributeError, TypeError):
        if isinstance(layout, Layout | None):
            raise unusable("data", data, "bytes") from None
        raise unusable("layout", layout, "a Layout") from None
    raise unusable("sender", sender, '"robot" or "client"')


def encode_answer(request_id: int, action: int, service: int, error: int = 0) -> bytes:
    """Encode a robot's answer without a body: for a robot that is made of something else."""
    return _native.roburoc4_encode_answer(request_id, action, service, error)


def usual_answer(request: bytes) -> bytes | None:
    """Return what any RobuROC4 of the manual answers to a request; None if it answers nothing."""
    return _native.usual_answer(request) or None


@lru_cache(maxsize=16)
def _services(layout: Layout) -> dict[int, int]:
    """Return the service of each id; directory and notification always have their own."""
    ids = {wire_id: k + Service.IOCARD for k, wire_id in reversed([*enumerate(layout[:5])])}
    return ids | {service: service for service in range(Service.IOCARD)}


def _decode_other(data: Bytes, layout: Layout) -> Telegram:
    """Decode an answer, or a status of an unknown service."""
    data = bytes(data)
    if data[:1] == b"\xff":
        return UnknownStatus(_whole(data[3:11]), _whole(data[1:3]), data[11:])
    request_id, action, wire_id, error, payload = _native.roburoc4_decode_answer(data)
    body: AnswerBody = payload
    if request_id and not error:
        if action == _QUERY:
            body = decode_text(payload)
        elif action == _GET and (service := _services(layout).get(wire_id)) is not None:
            body = _PROPERTIES[service](data)
    return Answer(request_id, action, wire_id, error, body)


def _decode_sent(data: Bytes, layout: Layout) -> Telegram:
    """Decode what a client has sent."""
    data = bytes(memoryview(data))  # no number, of which bytes() makes zeros
    if data[:1] != b"\xff":
        return _native.roburoc4_decode_request(data)
    wire_id = _whole(data[1:3])
    service = _services(layout).get(wire_id)
    if service == _DIFFERENTIAL:
        return _native.roburoc4_decode_differential_command(data)
    if service == _IOCARD:
        counts = layout.analog_outputs, layout.digital_outputs
        return IoCardCommand(*_native.roburoc4_decode_iocard_command(data, *counts))
    _native.roburoc4_decode_iocard_command(data, 0, 0)  # raises where there is no id
    return UnknownCommand(wire_id, data[3:])


def _whole(field: bytes) -> int:
    return int.from_bytes(field, "little")


class Batch(NamedTuple):
    """Result of :func:`decode_batch`."""

    values: "npt.NDArray[np.void]"
    """One row for each valid status, in order."""
    bad: "npt.NDArray[np.intp]"
    """Indices of the items that are not such a status."""


_PACKED: dict[Service, list[tuple[Any, ...]]] = {
    Service.BATTERY: [("state", "u1"), ("remaining_percent", "u1")],
    Service.LOCALIZATION: [
        ("x_m", "<f8"),
        ("y_m", "<f8"),
        ("theta_rad", "<f8"),
        ("flags", "<u4"),
    ],
    Service.DIFFERENTIAL: [
        ("target_linear_m_s", "<f4"),
        ("current_linear_m_s", "<f4"),
        ("target_angular_rad_s", "<f4"),
        ("current_angular_rad_s", "<f4"),
    ],
}


def _columns(service: Service, layout: Layout, telemeters: int) -> list[tuple[Any, ...]]:
    """Name, wire format and shape of a status's fields; digital inputs are bits there."""
    if service is Service.IOCARD:
        blocks = (layout.digital_inputs + 7) // 8
        return [
            ("analog_inputs", "<f4", (layout.analog_inputs,)),
            ("digital_inputs", "u1", (blocks,)),
        ]
    if service is Service.TELEMETER:
        return [("distances_m", "<f4", (telemeters,))]
    return _PACKED[service]


def _cut(datagram: Bytes, size: int, service: Service) -> Bytes:
    """Return the first bytes of a longer status; for a shorter one, zeros that are no status.

    Up to three bytes after the distances are ignored; a fourth makes one telemeter more.
    """
    view = memoryview(datagram).cast("B")
    longest = size + 3 if service is Service.TELEMETER else len(view)
    return view[:size] if size <= len(view) <= longest else bytes(size)


def decode_batch(
    service: str | Service,
    data: Sequence[Bytes] | Bytes,
    layout: Layout | None = None,
    *,
    telemeters: int = 2,
) -> Batch:
    """Decode many statuses of one service into a NumPy structured array; needs NumPy.

    ``data`` is a list of datagrams, or one buffer with statuses of the manual's length, one after
    the other. Each is checked; the indices of those that are not a status of this service (or have
    another number of ``telemeters``) are reported. Fields are named as in the records.
    """
    try:
        import numpy as np
    except ImportError as error:
        raise ImportError(
            "decode_batch needs NumPy: pip install numpy, or apt install python3-numpy",
            name="numpy",
        ) from error

    which = service_of(service)
    if not isinstance(layout, Layout | None):
        raise unusable("layout", layout, "a Layout")
    layout = layout or _USUAL
    if not is_within(0, telemeters, 0xFFFF):
        raise unusable("telemeters", telemeters, "0 to 65535")
    columns = [("robot_cycles", "<u8"), *_columns(which, layout, telemeters)]
    row = np.dtype(columns).itemsize
    # A row in one piece is copied several times faster than field by field.
    wire = np.dtype([("header", "u1"), ("service", "<u2"), ("row", f"V{row}")])
    size = wire.itemsize
    if isinstance(data, bytes | bytearray | memoryview):
        total = memoryview(data).nbytes
        if total % size:
            raise DecodeError(
                f"a buffer of {total} bytes does not hold whole {which.name.lower()} statuses "
                f"of {size} bytes: give a list of datagrams",
                Result.SHORT,
            )
    else:
        try:
            if [*map(len, data)].count(size) != len(data):
                data = [one if len(one) == size else _cut(one, size, which) for one in data]
            data = b"".join(data)
        except TypeError:
            raise unusable("data", data, "bytes, or a list of them") from None
    found = np.frombuffer(data, dtype=wire)
    good = (found["header"] == _STATUS) & (found["service"] == layout[which - Service.IOCARD])
    rows = found["row"][good]
    if which is Service.IOCARD:
        octets = rows.view(np.uint8).reshape(len(rows), row)
        rest, bits = np.hsplit(octets, [8 + 4 * layout.analog_inputs])
        bits = np.unpackbits(bits, axis=1, count=layout.digital_inputs, bitorder="little")
        rows = np.hstack([rest, bits])
        columns[-1] = ("digital_inputs", "?", (layout.digital_inputs,))
    return Batch(rows.view(columns).reshape(-1), np.flatnonzero(~good))
