# SPDX-License-Identifier: MIT
"""The changes of the core that universalmutator knows."""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ("src/bytes.h", "src/joined.h", "src/machines.h")
FUNCTION = re.compile(r"^[A-Za-z].*\(")


@dataclass(frozen=True)
class Mutant:
    """One planted fault: a file's whole new text."""

    file: str
    text: str
    name: str  # stays the same when the file changes elsewhere
    function: str
    line: int
    before: str
    after: str

    @property
    def key(self) -> str:
        """The same only for the same change of the same text of the file."""
        return hashlib.sha256((self.file + "\0" + self.text).encode()).hexdigest()[:16]


def mutant(file: str, lines: list[str], text: str) -> Mutant:
    """The one run of lines in which a text differs from the file's."""
    changed = text.splitlines()
    shorter = min(len(lines), len(changed))
    head = next((i for i in range(shorter) if lines[i] != changed[i]), shorter)
    tail = 0
    while tail < shorter - head and lines[-1 - tail] == changed[-1 - tail]:
        tail += 1
    before = " ".join(lines[head : len(lines) - tail]).strip()
    after = " ".join(changed[head : len(changed) - tail]).strip()
    function = next((line for line in reversed(lines[:head]) if FUNCTION.match(line)), "")
    around = [lines[max(head - 1, 0)], *lines[len(lines) - tail :][:1]]
    name = hashlib.sha256("\0".join([file, function, before, after, *around]).encode())
    return Mutant(file, text, name.hexdigest()[:10], function, head + 1, before, after)


def core_files() -> list[str]:
    """The core's sources as CMakeLists.txt lists them, and its private headers."""
    text = (ROOT / "CMakeLists.txt").read_text()
    listed = re.search(r"set\(core_sources\s+([^)]*)\)", text)
    if listed is None:
        sys.exit("mutation: CMakeLists.txt has no list core_sources")
    return listed.group(1).split() + list(HEADERS)


def mutants_of(file: str, mutate: str) -> list[Mutant]:
    """All changes that universalmutator knows for one file."""
    source = (ROOT / file).read_text()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [mutate, str(ROOT / file), "c", "--noCheck", "--mutantDir", folder],
            check=True,
            stdout=subprocess.DEVNULL,
            cwd=folder,
        )
        texts = {path.read_text() for path in Path(folder).iterdir()}
    lines = source.splitlines()
    found = [mutant(file, lines, text) for text in texts]
    return [m for m in found if m.before != m.after]
