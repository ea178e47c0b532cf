# SPDX-License-Identifier: MIT
"""Write the fields of all structs in C headers as a table for records.c.

make_fields.py OUTPUT HEADER...
"""

import re
import sys
from pathlib import Path

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
STRUCT = re.compile(r"typedef struct (\w+) \{(.*?)\} \1;", re.DOTALL)
NUMBERS = re.compile(r"\s*(?:u?int\d+_t|float|double|char)\s+([^*]+)$")


def main() -> None:
    """Write the members that are numbers or arrays of numbers; those of private structs not."""
    lines = []
    for header in sys.argv[2:]:
        for struct, body in STRUCT.findall(Path(header).read_text(encoding="utf-8")):
            declarations = (
                COMMENT.sub("", body).split(";") if "private" not in struct + body else []
            )
            for numbers in filter(None, map(NUMBERS.match, declarations)):
                for member in numbers[1].split(","):
                    name, _, count = member.strip().rstrip("]").partition("[")
                    lines.append(f"{'ARRAY' if count else 'FIELD'}({struct}, {name})\n")
    Path(sys.argv[1]).write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
