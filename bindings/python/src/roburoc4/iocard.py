# SPDX-License-Identifier: MIT
"""The IO card: inputs by name or index, and outputs that remember their values."""

from collections.abc import Iterator, Mapping

from . import _native
from .connection import Connection
from .constants import IoType, Result, Service
from .errors import ArgumentError, finite, is_within, switch, unusable
from .records import ChannelNames, IoCardStatus

__all__ = ["AnalogOutputs", "DigitalOutputs", "Inputs"]


def decode_text(text: bytes) -> str:
    """Decode a robot's text. The encoding is not specified: UTF-8, else Latin-1."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


class Channels:
    """Names of one connection's channels: the robot's text, else the manual's name."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def count(self, io_type: IoType) -> int:
        """Return how many channels of this type the card has."""
        return _native.roburoc4_client_iocard_properties(self._connection.handle)[io_type]

    def _text(self, io_type: IoType, index: int) -> str:
        return decode_text(self._connection.description(io_type, index) or b"")

    def names(self, io_type: IoType) -> tuple[str, ...]:
        """Return a name for each channel of this type; some are empty."""
        handle = self._connection.handle
        return tuple(
            self._text(io_type, index)
            or _native.roburoc4_client_channel_name(handle, io_type, index)
            or ""
            for index in range(self.count(io_type))
        )

    def _find(self, name: str, io_type: IoType) -> int:
        texts = [
            self._text(io_type, index).casefold().encode() for index in range(self.count(io_type))
        ]
        index = _native.roburoc4_client_channel_find(
            self._connection.handle, io_type, name.casefold(), texts
        )
        if index == Result.VALUE:
            raise ArgumentError(
                f"{name!r} is ambiguous: several channels have this name; use an index",
                Result.INDEX,
            )
        return index

    def find(self, name: str, *io_types: IoType) -> tuple[IoType, int]:
        """Return type and index of the channel with this name; the error lists all names."""
        for io_type in io_types:
            index = self._find(name.replace("\0", "?"), io_type)
            if index >= 0:
                return io_type, index
        known = sorted({n for kind in io_types for n in self.names(kind) if n})
        raise ArgumentError(
            f"the robot has no channel {name!r}: it has {', '.join(known) or 'none with a name'}",
            Result.INDEX,
        )

    def index_of(self, channel: int | str, io_type: IoType) -> int:
        """Return the index of a channel that is given by index or name."""
        if isinstance(channel, str):
            return self.find(channel, io_type)[1]
        count = self.count(io_type)
        if not is_within(0, channel, count - 1) or channel != int(channel):
            kind = io_type.name.lower().replace("_", " ")
            raise ArgumentError(
                f"the robot has no {kind} {channel}: its {count} are 0 to {count - 1}"
                if count
                else f"the robot has no {kind}s",
                Result.INDEX,
            )
        return int(channel)


class Inputs:
    """Latest inputs of the IO card: ``robot.inputs["Front bumper"]``, ``robot.inputs.digital(8)``.

    Names are the robot's own texts; a channel without one has its name from the manual (5.5.1).
    The manual's names of the bumpers, game pad [A] and battery voltage always work. Case,
    punctuation and word order do not matter.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._channels = Channels(connection)

    @property
    def channels(self) -> ChannelNames:
        """Names of all channels."""
        return ChannelNames(*(self._channels.names(io_type) for io_type in IoType))

    def _status(self) -> IoCardStatus:
        return _native.latest_status(self._connection.handle, Service.IOCARD)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of all inputs that have one."""
        channels = self.channels
        return iter([n for n in (*channels.digital_inputs, *channels.analog_inputs) if n])

    def __getitem__(self, name: str) -> float | bool:
        if not isinstance(name, str):
            raise ArgumentError(
                f"inputs[{name!r}]: use inputs.digital({name!r}) or inputs.analog({name!r}), or a "
                "name",
                Result.INDEX,
            )
        io_type, index = self._channels.find(name, IoType.DIGITAL_INPUT, IoType.ANALOG_INPUT)
        return self.digital(index) if io_type is IoType.DIGITAL_INPUT else self.analog(index)

    def digital(self, channel: int | str) -> bool:
        """Return a digital input, by its index on the wire or its name."""
        index = self._channels.index_of(channel, IoType.DIGITAL_INPUT)
        return self._status().digital_inputs[index]

    def analog(self, channel: int | str) -> float:
        """Return an analog input, generally volts, by its index on the wire or its name."""
        index = self._channels.index_of(channel, IoType.ANALOG_INPUT)
        return self._status().analog_inputs[index]


class DigitalOutputs:
    """Digital outputs: ``robot.digital_outputs[3] = True``.

    A command carries all outputs, and they cannot be read back: those that were never set are sent
    as off, and reading one returns what this object has set. Output 0 is the robot's own.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._channels = Channels(connection)
        self._set: dict[int, bool] = {}

    def __len__(self) -> int:
        return self._channels.count(IoType.DIGITAL_OUTPUT)

    def __iter__(self) -> Iterator[bool]:
        return iter([self[index] for index in range(len(self))])

    def __getitem__(self, channel: int | str) -> bool:
        return self._set.get(self._channels.index_of(channel, IoType.DIGITAL_OUTPUT), False)

    def __setitem__(self, channel: int | str, on: bool) -> None:
        self.set({channel: on})

    def set(self, values: Mapping[int | str, bool]) -> None:
        """Set several outputs in one command: all, or none if one is invalid."""
        if not isinstance(values, Mapping):
            raise unusable("values", values, "values by channel, such as {3: True}")
        indices = {
            self._channels.index_of(channel, IoType.DIGITAL_OUTPUT): switch(
                f"digital_outputs[{channel!r}]", on
            )
            for channel, on in values.items()
        }
        mask = sum(1 << index for index in indices)
        wanted = sum(1 << index for index, on in indices.items() if on)
        _native.roburoc4_client_set_digital_outputs(self._connection.handle, mask, wanted)
        self._set.update(indices)


class AnalogOutputs:
    """Analog outputs, generally volts: ``robot.analog_outputs[0] = 2.5``.

    See :class:`DigitalOutputs`.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._channels = Channels(connection)
        self._set: dict[int, float] = {}

    def __len__(self) -> int:
        return self._channels.count(IoType.ANALOG_OUTPUT)

    def __iter__(self) -> Iterator[float]:
        return iter([self[index] for index in range(len(self))])

    def __getitem__(self, channel: int | str) -> float:
        return self._set.get(self._channels.index_of(channel, IoType.ANALOG_OUTPUT), 0.0)

    def __setitem__(self, channel: int | str, value: float) -> None:
        index = self._channels.index_of(channel, IoType.ANALOG_OUTPUT)
        finite(value=value)
        _native.roburoc4_client_set_analog_output(self._connection.handle, index, value)
        self._set[index] = float(value)
