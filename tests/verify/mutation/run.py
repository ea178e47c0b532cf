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
import sys
from collections import Counter
from pathlib import Path

from mutants import ROOT, core_files, mutants_of
from trial import INVALID, KILLED, SAME, SURVIVED, TWIN, Bench

SURVIVORS = Path(__file__).resolve().parent / "survivors.md"
PROGRESS = 1000


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
    parser.add_argument("--compiler", default="clang", help="a clang: gcc has other traps")
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
