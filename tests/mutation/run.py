#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plant faults in the core, one at a time, and see whether a test notices.

universalmutator writes the changed sources; this program builds each into the small library of the
core alone, runs the program with all of the core's tests against it, and keeps what came out. A
change that the compiler turns into the same code is none; one that does not compile is none either.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SURVIVORS = Path(__file__).resolve().parent / "survivors.md"
EXPOSED = ROOT / "tests" / "bytes_exposed.c"
HEADERS = ("src/bytes.h", "src/joined.h", "src/machines.h")
FLAGS = ["-std=c99", "-O1", "-fPIC", "-w", f"-I{ROOT}/include", f"-I{ROOT}/src"]
CPU_S = 20  # of the processor: by the clock, a busy machine would kill for us
LIVES = "20"
FUNCTION = re.compile(r"^[A-Za-z].*\(")

KILLED, SURVIVED, SAME, INVALID = "killed", "survived", "same code", "does not compile"


@dataclass(frozen=True)
class Mutant:
    """One planted fault: a file's whole new text."""

    file: str
    text: str
    name: str  # stays the same when the file changes elsewhere
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
    return Mutant(file, text, name.hexdigest()[:10], head + 1, before, after)


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


class Bench:
    """Builds and runs mutants."""

    def __init__(self, program: Path, compiler: str, work: Path) -> None:
        self.program, self.compiler, self.work = program, compiler, work
        self.sources = [f for f in core_files() if f.endswith(".c")]
        work.mkdir(parents=True, exist_ok=True)
        for file in [*(ROOT / s for s in self.sources), EXPOSED]:
            if not self.compile(file, self.object_of(file)):
                sys.exit(f"mutation: {file} does not compile")

    def object_of(self, file: Path) -> Path:
        return self.work / (file.stem + ".o")

    def compile(self, file: Path, out: Path, first: Path | None = None) -> bool:
        """`first`: a folder whose headers come before those of the checkout."""
        include = [] if first is None else [f"-I{first}"]
        command = [self.compiler, *include, *FLAGS, "-c", "-o", str(out), str(file)]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def build(self, mutant: Mutant, folder: Path) -> dict[Path, Path] | None:
        """Objects that differ, by the object in whose place they come; None: does not compile."""
        place = folder / Path(mutant.file).name
        place.write_text(mutant.text)
        sources = [place]
        if mutant.file.endswith(".h"):
            # A quoted include looks beside the including file first: copy those too, and the
            # other headers, as one includes the other.
            sources = []
            others = [ROOT / header for header in HEADERS if header != mutant.file]
            exposed = [EXPOSED, EXPOSED.with_suffix(".h")]
            for file in [*(ROOT / s for s in self.sources), *exposed, *others]:
                (folder / file.name).write_text(file.read_text())
                if file.suffix == ".c":
                    sources.append(folder / file.name)
        changed = {}
        for source in sources:
            out = folder / (source.stem + ".o")
            if not self.compile(source, out, folder):
                return None
            if out.read_bytes() != self.object_of(source).read_bytes():
                changed[self.object_of(source)] = out
        return changed

    def judge(self, mutant: Mutant) -> str:
        with tempfile.TemporaryDirectory(dir=self.work) as name:
            folder = Path(name)
            changed = self.build(mutant, folder)
            if changed is None:
                return INVALID
            if not changed:
                return SAME
            objects = [self.object_of(ROOT / s) for s in self.sources] + [self.object_of(EXPOSED)]
            library = folder / "libroburoc4_core_alone.so"
            link = [self.compiler, "-shared", "-o", str(library)]
            link += [str(changed.get(o, o)) for o in objects]
            if subprocess.run(link, capture_output=True, check=False).returncode != 0:
                return INVALID
            return self.run(folder)

    def run(self, folder: Path) -> str:
        environment = dict(
            os.environ,
            LD_LIBRARY_PATH=str(folder),
            GTEST_FAIL_FAST="1",
            GTEST_BRIEF="1",
            ROBUROC4_WALK_LIVES=LIVES,
        )
        done = subprocess.run(
            ["sh", "-c", f'ulimit -t {CPU_S}; exec "$0"', str(self.program)],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=False,
        )
        # A loop without end is noticed too.
        return SURVIVED if done.returncode == 0 else KILLED


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
            f"{c[INVALID]:6} do not compile"
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
        if bench.run(args.program.resolve().parent) != SURVIVED:
            sys.exit("mutation: the tests fail without any mutant")
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            futures = {pool.submit(bench.judge, m): m for m in todo}
            for future in concurrent.futures.as_completed(futures):
                m = futures[future]
                result = {
                    "key": m.key,
                    "name": m.name,
                    "file": m.file,
                    "line": m.line,
                    "before": m.before,
                    "after": m.after,
                    "result": future.result(),
                }
                results.append(result)
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
