#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Find the deepest path of stack through the core, on ARM and RISC-V.

Reads the call graphs that gcc writes beside each object (-fcallgraph-info=su), joins them across
files, and looks for the longest path. The compiler's own functions and memcpy are not in these
graphs: their stack is read from the machine code of the linked program. Recursion, a frame of
unknown size or a function of unknown stack is an error, because the depth is then unknown.
"""

import argparse
import pathlib
import re
import subprocess
import sys

NODE = re.compile(r'node: \{ title: "([^"]*)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"')
FRAME = re.compile(r"(\d+) bytes \(([^)]*)\)")
INDIRECT = "__indirect_call"
CALLING = re.compile(r"(b|bl|blx|b[a-z]{2,4}|j|jal|call)(\.[nw])?$")


class UnknownDepthError(Exception):
    """The deepest path cannot be found."""


def output_of(*command):
    return subprocess.run(command, check=True, text=True, capture_output=True).stdout


class CallGraph:
    """The core's functions, by gcc's titles: NAME, or FILE:NAME for a static function."""

    def __init__(self):
        self.frames = {}  # title -> bytes
        self.calls = {}  # title -> titles
        self.address_taken = set()

    def read(self, path):
        text = path.read_text(encoding="utf-8")
        for title, label in NODE.findall(text):
            frame = FRAME.search(label)
            if frame is None:
                continue  # called here, defined elsewhere
            if frame.group(2) == "dynamic":
                raise UnknownDepthError(f"{title}: its frame has no fixed size")
            self.frames[title] = int(frame.group(1))
            self.calls.setdefault(title, set())
        for caller, callee in EDGE.findall(text):
            self.calls.setdefault(caller, set()).add(callee)

    def note_addresses(self, objdump, obj):
        """Note the functions whose address an object takes: any may be called indirectly."""
        here = {
            t.rsplit(":", 1)[-1]: t
            for t in self.frames
            if ":" not in t or pathlib.Path(t.rsplit(":", 1)[0]).stem == obj.stem
        }
        for line in output_of(objdump, "-r", obj).splitlines():
            fields = line.split()
            # An address with an offset is inside a function: a case of a switch.
            if (
                len(fields) == 3
                and fields[1].startswith("R_")
                and not re.search(r"CALL|JUMP|PLT|BRANCH|\d_PCREL", fields[1])
            ):
                title = here.get(re.sub(r"^\.text\.", "", fields[2]))
                if title is not None:
                    self.address_taken.add(title)


class MachineCode:
    """Stack of functions without a call graph, from a disassembly.

    An upper bound: everything that a function can reach is counted as if it were on the stack at
    the same time.
    """

    def __init__(self, objdump, nm, program):
        self.address = {}
        for line in output_of(nm, program).splitlines():
            fields = line.split()
            if len(fields) == 3 and fields[1] in "tTwW":
                self.address[fields[2]] = int(fields[0], 16) & ~1
        self.frames = {}
        self.reaches = {}
        self.by_register = {}
        listing = output_of(objdump, "-d", program)
        function = None
        for line in listing.splitlines():
            head = re.match(r"([0-9a-f]+) <[^>]*>:", line)
            if head:
                function = int(head.group(1), 16)
                self.frames[function] = 0
                self.reaches[function] = set()
            elif function is not None and line.count("\t") >= 3:
                _, _, mnemonic, operands = line.split("\t", 3)
                self.frames[function] += self._taken(function, line, mnemonic.strip(), operands)
                target = re.search(r"<([^>+]*)", operands)
                if CALLING.match(mnemonic.strip()) and target:
                    self.reaches[function].add(target.group(1))

    def _taken(self, function, line, mnemonic, operands):
        """Return how many bytes of stack an instruction takes."""
        if re.match(r"v?push|stmdb", mnemonic) and (
            mnemonic.endswith("push") or operands.startswith("sp!")
        ):
            return self._registers(operands) * (8 if "{d" in operands else 4)
        down = re.match(r"sp, ?(?:sp, ?)?(?:#|-)(\d+)", operands)
        if down and (mnemonic.startswith("sub") or "sp,sp,-" in operands):
            return int(down.group(1))
        if mnemonic.startswith("sub") and operands.startswith("sp,"):
            self.by_register[function] = line.strip()
            return 0
        push_one = re.search(r"\[sp, #-(\d+)\]!", operands)
        return int(push_one.group(1)) if push_one else 0

    @staticmethod
    def _registers(operands):
        count = 0
        for item in re.search(r"\{([^}]*)\}", operands).group(1).split(","):
            ends = re.findall(r"[rsd](\d+)", item)
            count += int(ends[1]) - int(ends[0]) + 1 if len(ends) == 2 else 1
        return count

    def stack(self, name):
        if name not in self.address:
            raise UnknownDepthError(f"{name}: neither a call graph nor machine code")
        seen = set()
        waiting = [self.address[name]]
        while waiting:
            at = waiting.pop()
            if at in self.by_register:
                raise UnknownDepthError(f"{name} takes stack by a register: {self.by_register[at]}")
            if at not in seen and at in self.frames:
                seen.add(at)
                waiting += [self.address[n] for n in self.reaches[at] if n in self.address]
        return sum(self.frames[at] for at in seen)


def deepest(graph, code):
    """Return title -> (bytes, path) of its deepest path."""
    known = {}
    entered = []

    def visit(title):
        if title in known:
            return known[title]
        if title in entered:
            raise UnknownDepthError(
                "recursion: " + " > ".join([*entered[entered.index(title) :], title])
            )
        if title not in graph.frames:
            known[title] = (code.stack(title), [(title, code.stack(title))])
            return known[title]
        entered.append(title)
        below = (0, [])
        for callee in sorted(graph.calls[title]):
            targets = [callee]
            if callee == INDIRECT:
                targets = sorted(graph.address_taken)
                if not targets:
                    raise UnknownDepthError(f"{title}: calls through a pointer that no object sets")
            below = max([below] + [visit(t) for t in targets], key=lambda b: b[0])
        entered.pop()
        frame = graph.frames[title]
        known[title] = (frame + below[0], [(title, frame)] + below[1])
        return known[title]

    for title in sorted(graph.frames):
        visit(title)
    return known


def short(title):
    return title.rsplit(":", 1)[-1]


def main():
    parser = argparse.ArgumentParser(
        description="Find the deepest path of stack through objects that "
        "were compiled with -fcallgraph-info=su."
    )
    parser.add_argument("--program", required=True, help="the objects linked with their helpers")
    parser.add_argument("--tools", default="", help="prefix of objdump and nm")
    parser.add_argument(
        "--entries",
        type=int,
        default=0,
        metavar="N",
        help="list the N deepest public functions too",
    )
    parser.add_argument("objects", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    objdump, nm = arguments.tools + "objdump", arguments.tools + "nm"

    graph = CallGraph()
    for obj in arguments.objects:
        graph.read(obj.with_suffix(".ci"))
    for obj in arguments.objects:
        graph.note_addresses(objdump, obj)
    known = deepest(graph, MachineCode(objdump, nm, arguments.program))

    ranking = sorted((t for t in graph.frames if ":" not in t), key=lambda t: (-known[t][0], t))
    for title in ranking[: arguments.entries]:
        print(f"  {known[title][0]:5}  {title}")
    total, path = known[ranking[0]]
    for title, frame in path:
        where = "" if title in graph.frames else "  (from its machine code)"
        print(f"  {frame:5}  {short(title)}{where}")
    indirect = sorted(t for t in graph.calls if INDIRECT in graph.calls[t])
    for title in indirect:
        print(
            f"  {short(title)} calls one of: "
            + ", ".join(sorted(short(t) for t in graph.address_taken))
        )
    print(f"  no recursion, {len(indirect)} function(s) with indirect calls")
    print(f"stack {total}")


if __name__ == "__main__":
    try:
        main()
    except UnknownDepthError as error:
        sys.exit(f"stack_depth: {error}")
