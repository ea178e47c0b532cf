#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Demand that the tests reach all of the core.

check.py COVERAGE.json UNREACHABLE.md: lines and branches, from gcovr; what was not reached must be
in the table, and what is in the table must not have been reached.
check.py --mcdc MCDC.json: modified condition/decision coverage, from llvm-cov export.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FUNCTION = re.compile(r"^[A-Za-z].*?(\w+)\([^;]*$")


def function_at(lines: list[str], number: int) -> str:
    """Name of the function that a line (counted from 1) stands in."""
    for text in reversed(lines[:number]):
        if match := FUNCTION.match(text):
            return match.group(1)
    return "?"


def listed(table: str) -> set[tuple[str, str, str]]:
    """Rows of unreachable.md: file, text, function."""
    rows = re.findall(r"^\| (\S+) \| `(.+?)` in `(\w+)` \|", Path(table).read_text(), re.MULTILINE)
    return {(file, text, function) for file, text, function in rows}


def check_lines(coverage: str, table: str) -> int:
    lines = branches = 0
    missed = set()
    for file in json.loads(Path(coverage).read_text())["files"]:
        source = (ROOT / file["file"]).read_text().splitlines()
        for line in file["lines"]:
            lines += 1
            branches += len(line["branches"])
            if line["count"] == 0 or any(b["count"] == 0 for b in line["branches"]):
                number = line["line_number"]
                text = source[number - 1].strip()
                missed.add((file["file"], text, function_at(source, number)))
    allowed = listed(table)
    for file, text, function in sorted(missed - allowed):
        print(f"not reached: {file}, {function}(): {text}")
    for file, text, function in sorted(allowed - missed):
        print(f"reached, though {table} says that it cannot be: {file}, {function}(): {text}")
    if lines < 1000:
        print(f"only {lines} lines were looked at: the core is larger")
        return 1
    print(
        f"{lines} lines and {branches} branches of the core: all reached but "
        f"{len(missed & allowed)} lines that cannot be"
    )
    return 1 if missed != allowed else 0


def check_mcdc(coverage: str) -> int:
    total = covered = 0
    for file in json.loads(Path(coverage).read_text())["data"][0]["files"]:
        mcdc = file["summary"]["mcdc"]
        total += mcdc["count"]
        covered += mcdc["covered"]
        if mcdc["covered"] != mcdc["count"]:
            print(f"{file['filename']}: {mcdc['covered']} of {mcdc['count']} conditions")
    print(f"MC/DC: {covered} of {total} conditions of the core decide alone")
    return 1 if covered != total or total < 100 else 0


def main() -> int:
    match sys.argv[1:]:
        case ["--mcdc", coverage]:
            return check_mcdc(coverage)
        case [coverage, table]:
            return check_lines(coverage, table)
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
