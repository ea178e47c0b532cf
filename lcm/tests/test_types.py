# SPDX-License-Identifier: MIT
"""C and Python agree about each type."""

import random
import string
import struct
import subprocess
from typing import Any

import pytest
import roburoc4_lcm
from rig import Programs

TYPES = [
    name.removesuffix(".lcm")
    for name in sorted(path.name for path in (Programs.checkout() / "lcm" / "types").glob("*.lcm"))
]
INTEGERS = {"int8_t": 7, "int16_t": 15, "int32_t": 31, "int64_t": 63}


def single(luck: random.Random) -> float:
    """A number that a 32-bit float holds."""
    return float(struct.unpack("f", struct.pack("f", luck.uniform(-1e6, 1e6)))[0])


def value_of(luck: random.Random, kind: str) -> Any:
    if kind in INTEGERS:
        return luck.randint(-(2 ** INTEGERS[kind]), 2 ** INTEGERS[kind] - 1)
    if kind == "boolean":
        return luck.random() < 0.5
    if kind == "string":
        return "".join(luck.choices(string.printable + "äß☂", k=luck.randrange(20)))
    if kind in ("float", "double"):
        return single(luck)
    return message_of(luck, kind.removeprefix("roburoc4_lcm."))


def message_of(luck: random.Random, name: str) -> Any:
    """A message of this type with values that a mistake is unlikely to produce."""
    kind = getattr(roburoc4_lcm, name)
    message = kind()
    counts = {dimension[0] for dimension in kind.__dimensions__ if dimension}
    for field, type_name, dimension in zip(
        kind.__slots__, kind.__typenames__, kind.__dimensions__, strict=True
    ):
        if dimension:
            count = getattr(message, dimension[0])
            setattr(message, field, [value_of(luck, type_name) for _ in range(count)])
        elif field in counts:
            setattr(message, field, luck.randrange(6))
        else:
            setattr(message, field, value_of(luck, type_name))
    return message


def values(message: Any) -> Any:
    """All of its values, with structs and lists taken apart."""
    if hasattr(message, "__slots__"):
        return {field: values(getattr(message, field)) for field in message.__slots__}
    if isinstance(message, list | tuple):
        return [values(element) for element in message]
    return message


@pytest.mark.parametrize("name", TYPES)
def test_c_reads_what_python_writes_and_python_what_c_writes(programs: Programs, name: str) -> None:
    luck = random.Random(name)
    for _ in range(20):
        message = message_of(luck, name)
        echo = subprocess.run(
            [programs("types_echo"), name], input=message.encode(), capture_output=True, check=True
        )
        assert echo.stdout == message.encode()
        assert values(type(message).decode(echo.stdout)) == values(message)


def test_fingerprints_are_equal_in_c_and_python(programs: Programs) -> None:
    said = subprocess.run([programs("types_echo")], capture_output=True, text=True, check=True)
    of_c = dict(line.split() for line in said.stdout.splitlines())
    of_python = {
        name: getattr(roburoc4_lcm, name)._get_packed_fingerprint().hex() for name in TYPES
    }
    assert of_c == of_python
