# SPDX-License-Identifier: MIT
"""Builds changed cores, each into a small library of its own, and runs all of the core's tests
against it."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mutants import HEADERS, ROOT, Mutant, core_files

EXPOSED = ROOT / "tests" / "bytes_exposed.c"
FLAGS = ["-std=c99", "-fPIC", "-w", f"-I{ROOT}/include", f"-I{ROOT}/src"]
COMPARED, RUN = "compared", "run"
FLAGS_OF = {
    COMPARED: ["-O2"],
    RUN: ["-O1", "-fsanitize=undefined", "-fsanitize-trap=undefined"],
}
CPU_S = 20  # of the processor: by the clock, a busy machine would kill for us
MEMORY_KB = 1_000_000
SUSPECTS = 12
LIVES = "20"
FAILED = re.compile(r"^\[ +FAILED +\] ([^\s,]+)", re.MULTILINE)
PASSED = re.compile(r"^\[ +OK +\] (\S+) \((\d+) ms\)", re.MULTILINE)
STARTED = re.compile(r"^\[ RUN +\] (\S+)", re.MULTILINE)

KILLED, SURVIVED, INVALID = "killed", "survived", "does not compile"
SAME, TWIN = "same code", "same code as another"


class Suspects:
    """Tests that noticed changes of the same function or file: they are asked first."""

    def __init__(self) -> None:
        self.of_function: defaultdict[tuple[str, str], Counter[str]] = defaultdict(Counter)
        self.of_file: defaultdict[str, Counter[str]] = defaultdict(Counter)

    def add(self, file: str, function: str, test: str) -> None:
        self.of_function[file, function][test] += 1
        self.of_file[file][test] += 1

    def of(self, mutant: Mutant) -> list[str]:
        nearest = self.of_function[mutant.file, mutant.function].most_common(SUSPECTS)
        return [test for test, _ in [*nearest, *self.of_file[mutant.file].most_common(SUSPECTS)]]


@dataclass(frozen=True)
class Outcome:
    """What came of a mutant."""

    result: str
    test: str = ""  # that noticed it
    code: str = ""  # a hash of the objects that it changes


class Bench:
    """Builds and runs mutants."""

    def __init__(self, program: Path, compiler: str, work: Path) -> None:
        self.compiler, self.work = compiler, work
        work.mkdir(parents=True, exist_ok=True)
        # A program that is built anew meanwhile would be missing for a moment, and kill for us.
        self.program = Path(shutil.copy2(program, work))
        self.sources = [ROOT / f for f in core_files() if f.endswith(".c")] + [EXPOSED]
        self.lock = threading.Lock()
        self.suspects = Suspects()
        self.first_of_code: dict[str, str] = {}
        self.takes_ms: dict[str, int] = {}
        self.includes: dict[Path, str] = {}
        for kind in (COMPARED, RUN):
            (work / kind).mkdir(exist_ok=True)
        for file in self.sources:
            self.includes[file] = self.call("-MM", *FLAGS, str(file)).stdout
            for kind in (COMPARED, RUN):
                if not self.compile(file, work / kind / (file.stem + ".o"), kind):
                    sys.exit(f"mutation: {file} does not compile")

    def remember(self, results: Iterable[dict[str, object]]) -> None:
        """What earlier runs found out."""
        for r in results:
            if r["code"] and r["result"] != TWIN:
                self.first_of_code[str(r["code"])] = str(r["key"])
            if r["test"]:
                self.suspects.add(str(r["file"]), str(r["function"]), str(r["test"]))

    def fails_unchanged(self) -> bool:
        """Whether the tests fail with the core as it is; how long each takes."""
        with tempfile.TemporaryDirectory(dir=self.work) as folder:
            if not self.linked(Path(folder), set()):
                sys.exit("mutation: the core does not link")
            done = self.run(Path(folder), CPU_S)
        self.takes_ms = {test: int(ms) for test, ms in PASSED.findall(done.stdout)}
        return done.returncode != 0

    def call(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [self.compiler, *arguments], capture_output=True, text=True, check=False
        )

    def compile(self, file: Path, out: Path, kind: str) -> bool:
        """Headers beside the file come before those of the checkout."""
        arguments = [f"-I{file.parent}", *FLAGS, *FLAGS_OF[kind], "-c", "-o", str(out), str(file)]
        return self.call(*arguments).returncode == 0

    def written(self, mutant: Mutant, folder: Path) -> list[Path]:
        """Writes a mutant, and of a header all that includes it, into a folder: what to compile."""
        place = folder / Path(mutant.file).name
        place.write_text(mutant.text)
        if not mutant.file.endswith(".h"):
            return [place]
        # A quoted include looks beside the including file first: copy those too, and the other
        # headers, as one includes the other.
        others = [ROOT / header for header in HEADERS if header != mutant.file]
        for file in [*self.sources, *others, EXPOSED.with_suffix(".h")]:
            (folder / file.name).write_text(file.read_text())
        users = [file for file in self.sources if place.name in self.includes[file]]
        return [folder / file.name for file in users]

    def parses(self, file: Path) -> bool:
        """Most changes do not, and gcc says so in a tenth of the time of clang."""
        command = ["gcc", "-fsyntax-only", *FLAGS, str(file)]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def changed(self, sources: list[Path]) -> dict[Path, bytes] | None:
        """Sources whose objects differ, and these objects; None: does not compile."""
        found = {}
        for source in sources:
            out = source.with_suffix(".o")
            if not self.parses(source) or not self.compile(source, out, COMPARED):
                return None
            code = out.read_bytes()
            if code != (self.work / COMPARED / out.name).read_bytes():
                found[source] = code
        return found

    def judge(self, mutant: Mutant) -> Outcome:
        with tempfile.TemporaryDirectory(dir=self.work) as name:
            folder = Path(name)
            changed = self.changed(self.written(mutant, folder))
            if changed is None:
                return Outcome(INVALID)
            if not changed:
                return Outcome(SAME)
            whole = [mutant.file.encode()]
            whole += [part for s, code in changed.items() for part in (s.name.encode(), code)]
            code = hashlib.sha256(b"\0".join(whole)).hexdigest()[:16]
            with self.lock:
                if self.first_of_code.setdefault(code, mutant.key) != mutant.key:
                    return Outcome(TWIN, code=code)
                suspects = self.suspects.of(mutant)
            # Ten times as long as without a fault is a loop without end.
            loops_s = 2 + sum(self.takes_ms.get(test, 0) for test in suspects) // 100
            if not self.linked(folder, set(changed)):
                return Outcome(INVALID)
            done = self.run(folder, loops_s, suspects) if suspects else None
            if done is None or done.returncode == 0:
                done = self.run(folder, CPU_S)
            if done.returncode == 0:
                return Outcome(SURVIVED, code=code)
            # A test that crashed, or was stopped in a loop without end, is the last that began.
            names = FAILED.findall(done.stdout)[:1] or STARTED.findall(done.stdout)[-1:]
            with self.lock:
                for test in names:
                    self.suspects.add(mutant.file, mutant.function, test)
            return Outcome(KILLED, "".join(names), code)

    def linked(self, folder: Path, changed: set[Path]) -> bool:
        objects = []
        for file in self.sources:
            own = folder / file.name
            out = (folder if own in changed else self.work / RUN) / (file.stem + ".o")
            if own in changed and not self.compile(own, out, RUN):
                return False
            objects.append(str(out))
        library = folder / "libroburoc4_core_alone.so"
        # The core needs nothing that a compiler would add to it.
        command = ["ld", "-shared", "-o", str(library), *objects]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def run(
        self, folder: Path, cpu_s: int, tests: Iterable[str] = ()
    ) -> subprocess.CompletedProcess[str]:
        """All tests, or these, with a folder's library."""
        environment = dict(
            os.environ,
            LD_LIBRARY_PATH=str(folder),
            GTEST_FAIL_FAST="1",
            ROBUROC4_WALK_LIVES=LIVES,
        )
        if tests:
            environment["GTEST_FILTER"] = ":".join(tests)
        limits = f"ulimit -t {cpu_s} && ulimit -v {MEMORY_KB}"
        return subprocess.run(
            ["sh", "-c", f'{limits} && exec "$0"', str(self.program)],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            errors="replace",
            check=False,
        )
