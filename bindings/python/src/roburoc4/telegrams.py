# SPDX-License-Identifier: MIT
"""Telegrams for tools: bytes to typed records, and many statuses to a NumPy table."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from . import _native
from .constants import Result, Service
from .errors import ArgumentError, DecodeError
from .records import BatteryStatus, DifferentialStatus, LocalizationStatus, Telegram
from .settings import service_of

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

__all__ = ["Batch", "Layout", "decode", "decode_batch"]

Bytes: TypeAlias = bytes | bytearray | memoryview


class Layout(NamedTuple):
    """What bytes alone do not tell: the services' ids, and the IO card's channel counts."""

    iocard: int = 2
    telemeter: int = 3
    battery: int = 4
    localization: int = 5
    differential: int = 6
    analog_inputs: int = 9
    analog_outputs: int = 0
    digital_inputs: int = 22
    digital_outputs: int = 8


_RECORDS: dict[Service, Any] = {
    Service.BATTERY: BatteryStatus,
    Service.LOCALIZATION: LocalizationStatus,
    Service.DIFFERENTIAL: DifferentialStatus,
}
_USUAL = Layout()
_STATUS = 0xFF
_native_decode = _native.decode


def decode(
    data: Bytes, layout: Layout | None = None, sender: Literal["robot", "client"] = "robot"
) -> Telegram:
    """Decode one datagram from a robot (or, on request, from a client).

    A status becomes the record of its service, an answer an :class:`~roburoc4.Answer`, a client's
    telegram a :class:`~roburoc4.Request` or a command. Raises DecodeError for anything else.
    """
    try:
        return _native_decode(data, layout, sender != "robot")
    except OverflowError:
        raise ArgumentError(
            f"{layout} is out of range: ids are 0 to 65535, counts 0 to 2147483647",
            Result.ARGUMENT,
        ) from None


class Batch(NamedTuple):
    """Result of :func:`decode_batch`."""

    values: "npt.NDArray[np.void]"
    """One row for each valid status, in order."""
    bad: "npt.NDArray[np.intp]"
    """Indices of the items that are not such a status."""


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
    formats = _native.packed_formats(service - Service.IOCARD)
    return list(zip(_RECORDS[service]._fields, formats, strict=False))[1:]


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
            'decode_batch needs NumPy: pip install "./bindings/python[numpy]" in a checkout '
            "(see docs/python.md)",
            name="numpy",
        ) from error

    which = service_of(service)
    layout = layout or _USUAL
    if not 0 <= telemeters <= 0xFFFF:
        raise ArgumentError(f"telemeters: {telemeters} is out of range", Result.ARGUMENT)
    columns = [("robot_cycles", "<u8"), *_columns(which, layout, telemeters)]
    wire = np.dtype([("header", "u1"), ("service", "<u2"), *columns])
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
        data = b"".join(one if len(one) == size else _cut(one, size, which) for one in data)
    found = np.frombuffer(data, dtype=wire)
    good = (found["header"] == _STATUS) & (found["service"] == layout[which - Service.IOCARD])
    found = found[good]
    if which is Service.IOCARD:
        columns[-1] = ("digital_inputs", "?", (layout.digital_inputs,))
    values = np.empty(len(found), dtype=columns)
    for name in values.dtype.names or ():
        values[name] = (
            np.unpackbits(
                found[name], axis=1, count=layout.digital_inputs, bitorder="little"
            ).astype(bool)
            if name == "digital_inputs"
            else found[name]
        )
    return Batch(values, np.flatnonzero(~good))
