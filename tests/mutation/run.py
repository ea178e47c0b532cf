#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plant faults in the core, one at a time, and see whether a test notices.

universalmutator writes the changed sources; this program builds each into the small library of the
core alone, runs the program with all of the core's tests against it, and keeps what came out. A
change that the compiler turns into the same code is none; one that does not compile is none either;
and of several that it turns into the same other code the first stands for all. What runs has traps
for undefined behaviour, as scripts/test has: a change that a sanitizer sees is noticed.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import hashlib
import json
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

ROOT = Path(__file__).resolve().parents[2]
SURVIVORS = Path(__file__).resolve().parent / "survivors.md"
EXPOSED = ROOT / "tests" / "bytes_exposed.c"
HEADERS = ("src/bytes.h", "src/joined.h", "src/machines.h")
FLAGS = ["-std=c99", "-fPIC", "-w", f"-I{ROOT}/include", f"-I{ROOT}/src"]
COMPARED = ["-O2"]
RUN = ["-O1", "-fsanitize=undefined", "-fsanitize-trap=undefined"]
CPU_S = 20  # of the processor: by the clock, a busy machine would kill for us
MEMORY_KB = 1_000_000
SUSPECTS = 12
LIVES = "20"
PROGRESS = 1000
FUNCTION = re.compile(r"^[A-Za-z].*\(")
FAILED = re.compile(r"^\[ +FAILED +\] ([^\s,]+)", re.MULTILINE)
PASSED = re.compile(r"^\[ +OK +\] (\S+) \((\d+) ms\)", re.MULTILINE)
STARTED = re.compile(r"^\[ RUN +\] (\S+)", re.MULTILINE)

KILLED, SURVIVED, INVALID = "killed", "survived", "does not compile"
SAME, TWIN = "same code", "same code as another"


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
            self.folder_of(kind).mkdir(parents=True, exist_ok=True)
        for file in self.sources:
            self.includes[file] = self.call("-MM", *FLAGS, str(file)).stdout
            for kind in (COMPARED, RUN):
                if not self.compile(file, self.folder_of(kind) / (file.stem + ".o"), kind):
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

    def folder_of(self, kind: list[str]) -> Path:
        return self.work / ("compared" if kind is COMPARED else "run")

    def call(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [self.compiler, *arguments], capture_output=True, text=True, check=False
        )

    def compile(self, file: Path, out: Path, kind: list[str]) -> bool:
        """Headers beside the file come before those of the checkout."""
        arguments = [f"-I{file.parent}", *FLAGS, *kind, "-c", "-o", str(out), str(file)]
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
            if code != (self.folder_of(COMPARED) / out.name).read_bytes():
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
            out = (folder if own in changed else self.folder_of(RUN)) / (file.stem + ".o")
            if own in changed and not self.compile(own, out, RUN):
                return False
            objects.append(str(out))
        library = folder / "libroburoc4_core_alone.so"
        return self.call("-shared", "-o", str(library), *objects).returncode == 0

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


def explained() -> set[str]:
    """Names of survivors that survivors.md explains: what each of its rows begins with."""
    if not SURVIVORS.exists():
        return set()
    return set(re.findall(r"^\| `([0-9a-f]{10})`", SURVIVORS.read_text(), re.MULTILINE))


def report(results: list[dict[str, object]], planned: int) -> tuple[float, int]:
    """Print the score and the survivors; the score in percent, and how many are not explained."""
    counts = Counter(str(r["result"]) for r in results)
    real = counts[KILLED] + counts[SURVIVED]
    score = 100.0 * counts[KILLED] / real if real else 0.0
    known = explained()
    unexplained = sum(1 for r in results if r["result"] == SURVIVED and r["name"] not in known)
    by_file: dict[str, Counter[str]] = {}
    for r in results:
        by_file.setdefault(str(r["file"]), Counter())[str(r["result"])] += 1
    for file, c in sorted(by_file.items()):
        print(
            f"{file:22} {c[KILLED]:6} killed {c[SURVIVED]:5} survived {c[SAME]:6} same code "
            f"{c[TWIN]:6} as another {c[INVALID]:6} do not compile"
        )
    for r in sorted(
        (r for r in results if r["result"] == SURVIVED),
        key=lambda r: (str(r["file"]), int(str(r["line"]))),
    ):
        word = "explained" if r["name"] in known else "NOT EXPLAINED"
        print(
            f"survived, {word}: {r['name']} {r['file']}:{r['line']}\n"
            f"    - {r['before']}\n    + {r['after']}"
        )
    print(
        f"{len(results)} of {planned} mutants tried: {real} compiled to other code, "
        f"{counts[KILLED]} killed, {counts[SURVIVED]} survived ({unexplained} not explained): "
        f"score {score:.1f} %"
    )
    return score, unexplained


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True, help="the built core_tests")
    parser.add_argument("--compiler", default="gcc")
    parser.add_argument("--mutate", default="mutate", help="universalmutator's program")
    parser.add_argument("--work", type=Path, required=True, help="folder for what is built")
    parser.add_argument("--state", type=Path, help="file of results: what is there is not repeated")
    parser.add_argument("--retry", action="store_true", help="try those that survived again")
    parser.add_argument("--sample", type=int, help="so many, drawn by --seed (default: all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", nargs="*", help="of these files only")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--at-least", type=float, default=0.0, help="the score that is enough")
    parser.add_argument(
        "--all-explained", action="store_true", help="fail for a survivor without a reason"
    )
    parser.add_argument("--only-report", action="store_true", help="of what is in --state")
    return parser.parse_args()


def main() -> int:
    args = options()
    mutants = [m for f in args.files or core_files() for m in mutants_of(f, args.mutate)]
    # So that a change of the core draws no other sample of what it leaves alone.
    mutants.sort(key=lambda m: (hashlib.sha256(f"{args.seed} {m.name}".encode()).digest(), m.key))
    chosen = mutants[: args.sample] if args.sample else mutants
    wanted = {m.key: m for m in chosen}
    before: dict[str, dict[str, object]] = {}
    if args.state and args.state.exists():
        for line in args.state.read_text().splitlines():
            result = json.loads(line)
            if result["key"] in wanted:
                before[result["key"]] = result
    if args.retry:
        before = {key: r for key, r in before.items() if r["result"] != SURVIVED}
    results = list(before.values())
    todo = [] if args.only_report else [m for m in wanted.values() if m.key not in before]
    print(
        f"seed {args.seed}: {len(mutants)} mutants, {len(wanted)} chosen, "
        f"{len(before)} known, {len(todo)} to try",
        flush=True,
    )
    if todo:
        bench = Bench(args.program.resolve(), args.compiler, args.work.resolve())
        bench.remember(before.values())
        if bench.fails_unchanged():
            sys.exit("mutation: the tests fail without any mutant")
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            futures = {pool.submit(bench.judge, m): m for m in todo}
            for future in concurrent.futures.as_completed(futures):
                m, outcome = futures[future], future.result()
                result = {
                    "key": m.key,
                    "name": m.name,
                    "file": m.file,
                    "function": m.function,
                    "line": m.line,
                    "before": m.before,
                    "after": m.after,
                    "result": outcome.result,
                    "test": outcome.test,
                    "code": outcome.code,
                }
                results.append(result)
                if len(results) % PROGRESS == 0:
                    print(f"{len(results)} of {len(wanted)} tried", flush=True)
                if args.state:
                    with args.state.open("a") as out:
                        out.write(json.dumps(result) + "\n")
    score, unexplained = report(results, len(wanted))
    if args.all_explained and unexplained:
        print(f"mutation: test them, or say why not in {SURVIVORS.relative_to(ROOT)}")
        return 1
    return 0 if score >= args.at_least else 1


if __name__ == "__main__":
    sys.exit(main())
