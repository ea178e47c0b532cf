#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Change files in random places and count how many of the changes their tests notice.

universalmutator makes the changes by mutation.rules: the classical ones (a comparison, condition or
calculation turned round, a bound moved by one, a result or flag of another value, a statement
left out). One that does not compile, or that compiles to the same code, does not count. Those that
nobody noticed are printed: each is a missing test, or a change that makes no difference. Only some
are tried: the share is known to within two standard errors.
"""

from __future__ import annotations

import argparse
import difflib
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMPILE = ["gcc", "-std=c99", "-O2", "-fPIC", "-w", f"-I{ROOT}/include", "-c"]
LINK: list[str] = []
TEST_S = 60
MEMORY_BYTES = 2 << 30
RULES = Path(__file__).with_suffix(".rules")


def changes(file: Path, mutate: str) -> list[str]:
    """Each changed version of a file that universalmutator makes."""
    with tempfile.TemporaryDirectory() as folder:
        command = [mutate, str(file), "--only", RULES, "--noCheck", "--mutantDir", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=folder)
        return sorted({path.read_text() for path in Path(folder).iterdir()})


def copy_sources(sources: list[Path], folder: Path) -> None:
    for file in sources[0].parent.glob("*.[ch]"):
        shutil.copy(file, folder)


def compile_all(folder: Path, sources: list[Path]) -> dict[str, bytes] | None:
    """Compile the files in the folder; None if one does not compile."""
    objects = {}
    for source in sources:
        out = folder / (source.stem + ".o")
        done = subprocess.run(
            [*COMPILE, "-o", out, folder / source.name], capture_output=True, check=False
        )
        if done.returncode != 0:
            return None
        objects[source.name] = out.read_bytes()
    return objects


def exported(code: bytes, folder: Path) -> bytes:
    """The names that an object defines."""
    file = folder / "names.o"  # nm reads no pipe
    file.write_bytes(code)
    command = ["nm", "-gj", "--defined-only", file]
    return subprocess.run(command, capture_output=True, check=True).stdout


def pass_with(objects: dict[str, bytes], programs: list[Path], folder: Path) -> bool:
    """Whether all tests pass with a library made of these objects."""
    files = []
    for source, code in objects.items():
        files.append(folder / (source + ".o"))
        files[-1].write_bytes(code)
    library = folder / "changed.so"
    subprocess.run(["gcc", "-shared", "-o", library, *files, *LINK], check=True)
    limit = ["prlimit", f"--as={MEMORY_BYTES}"]
    preload = dict(os.environ, LD_PRELOAD=str(library))
    for program in programs:
        command = [*limit, program, "--gtest_brief=1", "--gtest_fail_fast"]
        try:
            done = subprocess.run(
                command, env=preload, capture_output=True, timeout=TEST_S, check=False
            )
        except subprocess.TimeoutExpired:
            return False
        if done.returncode != 0:
            return False
    return True


def verdict(
    programs: list[Path], sources: list[Path], sound: dict[str, bytes], file: Path, text: str
) -> str:
    """Whether the tests notice this version of a file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_sources(sources, folder)
        (folder / file.name).write_text(text)
        changed = compile_all(folder, [file] if file.suffix == ".c" else sources)
        if changed is None:
            return "invalid"
        if all(sound[source] == code for source, code in changed.items()):
            return "same"
        if any(
            exported(sound[source], folder) != exported(code, folder)
            for source, code in changed.items()
        ):
            return "invalid"  # with a renamed function, the program's own would run
        return "missed" if pass_with(sound | changed, programs, folder) else "noticed"


def difference(before: str, after: str) -> str:
    """The changed lines, as in a patch."""
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
    return "\n".join("    " + line for line in list(lines)[2:])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mutate", required=True, help="universalmutator's program")
    parser.add_argument(
        "--program",
        type=Path,
        required=True,
        action="append",
        help="tests, linked with them as a shared library; may be given again",
    )
    parser.add_argument("--compile", default="", help="more arguments to compile them with")
    parser.add_argument("--link", default="", help="what they need, to link them with")
    parser.add_argument("--sample", type=int, default=200, help="changes to try")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--at-least", type=float, default=0, help="per cent that must be noticed")
    parser.add_argument("sources", type=Path, nargs="+")
    options = parser.parse_args()

    COMPILE[1:1] = options.compile.split()
    LINK.extend(options.link.split())
    sources = [source.resolve() for source in options.sources]
    with tempfile.TemporaryDirectory() as name:
        copy_sources(sources, Path(name))
        sound = compile_all(Path(name), sources)
        if sound is None or not pass_with(sound, options.program, Path(name)):
            sys.exit("mutation: the files as they are do not compile, or fail their tests")

    mutants = [(f, text) for f in sources for text in changes(f, os.path.abspath(options.mutate))]
    random.Random(options.seed).shuffle(mutants)
    count = {"noticed": 0, "missed": 0, "invalid": 0, "same": 0}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        tried = pool.map(lambda m: verdict(options.program, sources, sound, *m), mutants)
        for (file, text), result in zip(mutants, tried, strict=True):
            count[result] += 1
            if result == "missed":
                print(f"missed: {file.relative_to(ROOT)}")
                print(difference(file.read_text(), text), flush=True)
            if count["noticed"] + count["missed"] >= options.sample:
                break
        pool.shutdown(cancel_futures=True)
    tries = count["noticed"] + count["missed"]
    share = count["noticed"] / max(tries, 1)
    doubt = 2 * math.sqrt(share * (1 - share) / max(tries, 1))
    print(f"{tries} of {len(mutants)} changes tried: {share:.1%} ± {doubt:.1%} noticed")
    return 0 if share >= options.at_least / 100 else 1


if __name__ == "__main__":
    sys.exit(main())
