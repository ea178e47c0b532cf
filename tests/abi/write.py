# SPDX-License-Identifier: MIT
"""Write released.inc: the public functions, structs and constants of a release, as C asserts.

write.py RELEASE OUTPUT (scripts/abi calls it); needs clang, which knows 32 and 64 bits.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(sys.argv[1])
HEADERS = ("codec", "", "move", "robot_file", "udp", "record", "pump", "sim")
LIVING = ("VERSION", "PROTOCOL_REVISION")  # a later library may have other ones
COUNTS = ("ROBUROC4_COUNTERS", "ROBUROC4_UDP_COUNTERS")  # or more
FREE = ("private_", "reserved")  # fields that are not public, or will get another name and type
INCLUDES = "".join(f'#include "roburoc4{"_" * bool(h)}{h}.h"\n' for h in HEADERS)
TARGETS = ("x86_64-linux-gnu", "armv7-linux-gnueabihf", "i386-linux-gnu")
CLANG = ["clang", "-x", "c", "-ffreestanding", "-DROBUROC4_API=API", "-DROBUROC4_SIM_API=API"]


def clang(text: str, *arguments: str) -> str:
    """Return clang's output for this text after the public headers."""
    command = [*CLANG, f"-I{ROOT}/include", *arguments, "-o", "-", "-"]
    return subprocess.run(
        command, input=INCLUDES + text, capture_output=True, text=True, check=True
    ).stdout


def values(expressions: list[str]) -> list[tuple[int, ...]]:
    """Return the value of each expression on each of the targets."""
    text = f"const int table[] = {{{','.join(f'(int)({e})' for e in expressions)}}};"
    columns = []
    for target in TARGETS:
        assembly = clang(text, "-S", "-DAPI=", f"--target={target}")
        column: list[int] = []
        for kind, word in re.findall(r"\.(long|zero)\s+(-?\d+)", assembly.split("table:")[1]):
            column += [int(word)] if kind == "long" else [0] * (int(word) // 4)
        columns.append([n - (1 << 32) if n >> 31 else n for n in column[: len(expressions)]])
    return list(zip(*columns, strict=True))


def number(found: tuple[int, ...]) -> str:
    """Return C for a number that may depend on the target."""
    return str(found[0]) if len(set(found)) == 1 else f"ON{found}"


def fields(body: str) -> list[tuple[str, str]]:
    """Return name and pointer type of each public field."""
    found = []
    for declaration in filter(None, (d.strip() for d in body.split(";"))):
        first, *others = declaration.split(",")
        base, declarator = re.fullmatch(
            r"(.*?[\w ]+?)((?:\*| )\s*\*?\w+(?:\[[^]]*\])*)", first
        ).groups()
        for text in (declarator, *others):
            stars, name, dimensions = re.fullmatch(
                r"\s*(\**)\s*(\w+)((?:\[[^]]*\])*)", text
            ).groups()
            if not name.startswith(FREE):
                pointer = f"(*){dimensions}" if dimensions else "*"
                found.append((name, f"{' '.join(base.split())} {stars}{pointer}"))
    return found


def main() -> None:
    """Write the file."""
    text = " ".join(clang("", "-E", "-P").split())
    functions = re.findall(r"\bAPI ([^;{}]*?)(roburoc4_\w+)\(([^;]*)\);", text)
    structs = re.findall(r"typedef (?:struct|union) (roburoc4_(?!private)\w+) {([^}]*)}", text)
    names = re.findall(
        rf"#define (ROBUROC4_(?!{'|'.join(LIVING)})\w+)[ \t]+(?![ \t]*\")[^\s\\]",
        "".join(
            (ROOT / f"include/roburoc4{'_' * bool(h)}{h}.h").read_text("utf-8") for h in HEADERS
        ),
    )
    names = [name for name in names if not name.endswith(("_API", "_MUST_CHECK"))]
    lines = ["/* Written by scripts/abi. */\n"]
    lines += [
        f"FUNCTION({name}, {' '.join(result.split())}, ({arguments}))"
        for result, name, arguments in sorted(functions, key=lambda f: f[1])
    ]
    rows = []
    for name, body in [*structs, ("roburoc4_client", "")]:
        grows = body.strip().startswith("uint32_t size;")
        rows.append(("GROWS" if grows else "FROZEN", name, f"sizeof({name})"))
        rows += [
            (f"FIELD({name}, {field}, {kind}", None, f"__builtin_offsetof({name}, {field})")
            for field, kind in fields(body)
        ]
    rows += [("AT_LEAST" if name in COUNTS else "CONSTANT", name, name) for name in names]
    for (kind, name, _), pair in zip(rows, values([row[2] for row in rows]), strict=True):
        lines.append(
            f"{kind}, {number(pair)})" if name is None else f"{kind}({name}, {number(pair)})"
        )
    Path(sys.argv[2]).write_text("\n".join(lines) + "\n", "utf-8")


main()
