#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Turn the numbered deviations of deviations.md into cppcheck's list of suppressions.

suppressions.py DEVIATIONS.md: for each rule and file of the table a line "misra-c2012-RULE:FILE".
"""

import re
import sys
from pathlib import Path

ROW = re.compile(r"^\| D(\d+) \| ([\d.]+) \| (.+?) \| (.{20,}) \|$", re.MULTILINE)


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    rows = ROW.findall(Path(sys.argv[1]).read_text())
    if [int(number) for number, *_ in rows] != list(range(1, len(rows) + 1)) or not rows:
        print(
            "the deviations are not numbered D1, D2, ..., or a reason is missing", file=sys.stderr
        )
        return 1
    for _, rule, files, _ in rows:
        for file in ["*"] if files == "all" else files.replace("`", "").split(", "):
            print(f"misra-c2012-{rule}:{file}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
