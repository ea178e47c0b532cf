# SPDX-License-Identifier: MIT
"""The IO card: inputs by name or index, outputs that remember what was set."""

from collections.abc import Mapping
from typing import NamedTuple

from . import _native
from .constants import IoType, Result, Role
from .engine import Engine
from .errors import ArgumentError, NotKnownError
from .records import IoCardProperties, IoCardStatus

__all__ = ["AnalogOutputs", "IoCard", "IoChannels", "Outputs"]

_ROLES = {
    (IoType.ANALOG_INPUT, 2): Role.BATTERY_V,
    (IoType.DIGITAL_INPUT, 0): Role.FRONT_BUMPER,
    (IoType.DIGITAL_INPUT, 1): Role.REAR_BUMPER,
    (IoType.DIGITAL_INPUT, 8): Role.OVERRIDE,
}
_MANUAL = {
    io_type: tuple(
        name
        for index in range(64)
        if (name := _native.roburoc4_channel_name(io_type, index)) is not None
    )
    for io_type in IoType
}
_FIRST_SHIFTED = 2
"""The manual's tables skip number 02; on a card with one channel more they are literal."""


class IoChannels(NamedTuple):
    """Names of all channels: the robot's own texts, the manual's where it gave none."""

    analog_inputs: tuple[str, ...]
    analog_outputs: tuple[str, ...]
    digital_inputs: tuple[str, ...]
    digital_outputs: tuple[str, ...]


def decode_text(text: bytes) -> str:
    """Decode a robot's text, whose character set nobody told: UTF-8, else Latin-1."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def _same(name: str) -> str:
    return name.strip().casefold()


class Channels:
    """Names of one engine's channels, and what they mean."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def count(self, io_type: IoType) -> int:
        """Return how many channels of this type the card has."""
        properties: IoCardProperties = self._engine.call("iocard_properties")
        return properties[io_type]

    def _text(self, io_type: IoType, index: int) -> str | None:
        text = self._engine.description(io_type, index)
        return None if text is None else decode_text(text)

    def _manual_index(self, io_type: IoType, index: int) -> int:
        """Where the manual's channel is on this card, if its tables are right."""
        literal = self.count(io_type) == len(_MANUAL[io_type]) + 1
        return index + 1 if literal and index >= _FIRST_SHIFTED else index

    def names(self, io_type: IoType) -> tuple[str, ...]:
        """Return a name for each channel of this type; some are empty."""
        count = self.count(io_type)
        names = [""] * count
        for number, name in enumerate(_MANUAL[io_type]):
            index = self._manual_index(io_type, number)
            if index < count:
                names[index] = name
        for index in range(count):
            text = self._text(io_type, index)
            if text is not None:
                names[index] = text
        return tuple(names)

    def _said(self, name: str, io_type: IoType) -> list[int]:
        return [
            index
            for index in range(self.count(io_type))
            if _same(self._text(io_type, index) or "") == name
        ]

    def _of_manual(self, io_type: IoType, number: int, said: list[int]) -> int:
        role = _ROLES.get((io_type, number))
        if role is not None:
            try:
                return int(self._engine.call("role_index", role))
            except NotKnownError:
                pass
        if len(said) == 1:
            return said[0]
        return self._manual_index(io_type, number)

    def find(self, name: str, *io_types: IoType) -> tuple[IoType, int]:
        """Return type and index of the channel with this name, or say what is wrong with it."""
        wanted = _same(name)
        matches: list[tuple[IoType, int]] = []
        for io_type in io_types:
            said = self._said(wanted, io_type) if wanted else []
            for number, manual in enumerate(_MANUAL[io_type]):
                if wanted and _same(manual) == wanted:
                    index = self._of_manual(io_type, number, said)
                    if index < self.count(io_type):
                        return io_type, index
            matches += [(io_type, index) for index in said]
        if len(matches) == 1:
            return matches[0]
        if matches:
            places = ", ".join(f"{kind.name.lower()} {index}" for kind, index in matches)
            raise ArgumentError(
                f"{name!r} is ambiguous: the robot gives this name to {places}; use an index",
                Result.INDEX,
            )
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
        if not 0 <= channel < count:
            kind = io_type.name.lower().replace("_", " ")
            raise ArgumentError(
                f"the robot has no {kind} {channel}: its {count} are 0 to {count - 1}"
                if count
                else f"the robot has no {kind}s",
                Result.INDEX,
            )
        return channel


class IoCard:
    """Latest inputs of the IO card: ``robot.io["Front bumper"]``, ``robot.io.digital(8)``.

    The manual's names (5.5.1) always work, wherever this robot has the channel; the robot's own
    texts where they are unique. Upper and lower case are the same.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._channels = Channels(engine)

    @property
    def channels(self) -> IoChannels:
        """Names of all channels."""
        return IoChannels(*(self._channels.names(io_type) for io_type in IoType))

    def _status(self) -> IoCardStatus:
        status: IoCardStatus = self._engine.call("inputs")
        return status

    def __getitem__(self, name: str) -> float | bool:
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


class Outputs:
    """Digital outputs: ``robot.outputs[3] = True``.

    A command carries all outputs and nothing reads them back: those that were never set are sent
    as off, and reading one returns what this object has set. Output 0 is the robot's own.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._channels = Channels(engine)
        self._set: dict[int, bool] = {}

    def __len__(self) -> int:
        return self._channels.count(IoType.DIGITAL_OUTPUT)

    def __getitem__(self, channel: int | str) -> bool:
        return self._set.get(self._channels.index_of(channel, IoType.DIGITAL_OUTPUT), False)

    def __setitem__(self, channel: int | str, on: bool) -> None:
        self.set({channel: on})

    def set(self, values: Mapping[int | str, bool]) -> None:
        """Set several outputs in one command: all, or none where one cannot be."""
        indices = {
            self._channels.index_of(channel, IoType.DIGITAL_OUTPUT): bool(on)
            for channel, on in values.items()
        }
        mask = sum(1 << index for index in indices)
        self._engine.call(
            "set_digital_outputs", mask, sum(1 << index for index, on in indices.items() if on)
        )
        self._set.update(indices)


class AnalogOutputs:
    """Analog outputs, generally volts: ``robot.analog_outputs[0] = 2.5``; see :class:`Outputs`."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._channels = Channels(engine)
        self._set: dict[int, float] = {}

    def __len__(self) -> int:
        return self._channels.count(IoType.ANALOG_OUTPUT)

    def __getitem__(self, channel: int | str) -> float:
        return self._set.get(self._channels.index_of(channel, IoType.ANALOG_OUTPUT), 0.0)

    def __setitem__(self, channel: int | str, value: float) -> None:
        index = self._channels.index_of(channel, IoType.ANALOG_OUTPUT)
        self._engine.call("set_analog_output", index, value)
        self._set[index] = float(value)
