# SPDX-License-Identifier: MIT
"""Reads and writes the telegrams of telegrams.json by their layouts."""

import json
import struct
from pathlib import Path
from typing import Any

ENTRIES = {
    entry["name"]: entry
    for entry in json.loads(Path(__file__).with_name("telegrams.json").read_text("utf-8"))[
        "telegrams"
    ]
}
SERVICES = {"iocard": 2, "telemeter": 3, "battery": 4, "localization": 5, "differential": 6}
FORMATS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i32": "i", "f32": "f", "f64": "d"}
GET, QUERY, REPLACE, INSERT = 0, 1, 2, 4
STATUS = 0xFF

Values = dict[str, Any]


class LayoutError(Exception):
    pass


def blocks(channels: int) -> int:
    """The bytes that this many digital channels take (4.2.4.4)."""
    return (channels + 7) // 8


def _read(layout: list[Any], data: bytes, counts: dict[str, int]) -> tuple[Values, bytes]:
    values: Values = {}
    for field in layout:
        if isinstance(field, dict):
            ((name, group),) = field.items()
            values[name] = []
            while data:
                element, data = _read(group, data, counts)
                values[name].append(element)
            continue
        name, kind, *usual = field.split()
        if kind == "text":
            values[name], data = data.decode("latin-1"), b""
            continue
        count = counts.get(name, int(usual[0])) if usual else 1
        size = struct.calcsize(f"<{count}{FORMATS[kind]}")
        if len(data) < size:
            raise LayoutError(f"it ends within {name}")
        found = list(struct.unpack(f"<{count}{FORMATS[kind]}", data[:size]))
        values[name] = found if usual else found[0]
        data = data[size:]
    return values, data


def decode(name: str, data: bytes, **counts: int) -> Values:
    """The values of a telegram of exactly its layout; `counts` are lengths of its lists."""
    values, rest = _read(ENTRIES[name]["layout"], data, counts)
    if rest:
        raise LayoutError(f"{len(rest)} bytes are left over")
    return values


def _write(layout: list[Any], values: Values) -> bytes:
    data = b""
    for field in layout:
        if isinstance(field, dict):
            ((name, group),) = field.items()
            data += b"".join(_write(group, element) for element in values[name])
            continue
        name, kind, *usual = field.split()
        value = values[name]
        if kind == "text":
            data += value.encode("latin-1")
        else:
            items = value if usual else [value]
            data += struct.pack(f"<{len(items)}{FORMATS[kind]}", *items)
    return data


def encode(name: str, **values: Any) -> bytes:
    """A telegram with these values; those that are not given are the ones of telegrams.json."""
    return _write(ENTRIES[name]["layout"], {**ENTRIES[name]["values"], **values})


class Report:
    """The faults that were found, each with its name, the manual's section and the first case."""

    def __init__(self) -> None:
        self.faults: dict[str, str] = {}

    def fault(self, name: str, section: str, what: str, data: bytes = b"") -> None:
        shown = f" [{data[:48].hex(' ').upper()}]" if data else ""
        self.faults.setdefault(name, f"({section}) {what}{shown}")

    def print(self, whom: str) -> int:
        for name, text in self.faults.items():
            print(f"FAULT {name} {text}")
        print(f"{whom}: {len(self.faults) or 'no'} fault{'s' if len(self.faults) != 1 else ''}")
        return 1 if self.faults else 0
