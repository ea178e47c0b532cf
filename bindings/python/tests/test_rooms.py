# SPDX-License-Identifier: MIT
"""The library is the lowest of the Python rooms, and small."""

import re
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[3]
ROOMS = {
    "bindings/python/src": {"roburoc4"},
    "tools/src": {"roburoc4", "roburoc4_tools", "roburoc4_lcm"},
    "ros2/src": {"roburoc4", "roburoc4_tools", "roburoc4_ros2"},
}
pytestmark = pytest.mark.skipif(not (TOP / "tools/src").exists(), reason="an sdist has one room")


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_what_is_below_it_and_public(room: str) -> None:
    for file in (TOP / room).rglob("*.py"):
        for line in file.read_text(encoding="utf-8").splitlines():
            if found := re.match(
                r"\s*(?:from|import) (roburoc4\w*)((?:\.\w+)*)(?: import (.*))?", line
            ):
                package, modules, names = found.groups()
                assert package in ROOMS[room], f"{file}: {line}"
                if room != "bindings/python/src" and package == "roburoc4":
                    assert not re.search(
                        r"\._|(^|[ ,(])_(?!_version__)", f"{modules} {names or ''}"
                    ), line


def test_the_library_stays_small() -> None:
    files = (TOP / "bindings/python/src").rglob("*.py*")
    assert sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files) <= 6500
