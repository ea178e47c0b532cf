#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The deepest path of stack through the core.

Reads the call graphs that gcc writes beside each object (-fcallgraph-info=su), joins them across
files, and looks for the longest path. From a gcc that is too old for them (AVR's) it takes frames
(-fstack-usage) and the calls in the object's machine code. The compiler's own functions and memcpy
are in neither: their stack is read from the machine code of the core linked with them. A loop in
the graph (recursion), a frame of unknown size or a function of unknown stack is an error, since
then there is no deepest path to tell. Knows ARM, RISC-V and AVR.
"""

import argparse
import pathlib
import re
import subprocess
import sys

NODE = re.compile(r'node: \{ title: "([^"]*)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"')
FRAME = re.compile(r"(\d+) bytes \(([^)]*)\)")
USAGE = re.compile(r"^[^\t]*:([^:\t]+)\t(\d+)\t(\S+)$", re.MULTILINE)
INDIRECT = "__indirect_call"
CALLING = re.compile(r"(b|bl|blx|b[a-z]{2,4}|j|jal|r?call|r?jmp)(\.[nw])?$")
AVR_RETURN_ADDRESS = 3  # bytes, where flash is larger than 128 kB


class UnknownDepthError(Exception):
    """No deepest path can be told."""


def said(*command):
    return subprocess.run(command, check=True, text=True, capture_output=True).stdout


class CallGraph:
    """The core's functions, by gcc's titles: a name, or (static functions) file:name."""

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

    def read_usage(self, objdump, nm, obj):
        """The same from frames and the object's own machine code."""
        symbols = dict(line.split()[:-3:-1] for line in said(nm, obj).splitlines())

        def title(name):
            # gcc gives copies of a function their last number after it has written the frames.
            if name not in symbols:
                name = next((s for s in symbols if s.startswith(f"{name}.")), name)
            return f"{obj.stem}.c:{name}" if symbols.get(name) == "t" else name

        for name, frame, kind in USAGE.findall(obj.with_suffix(".su").read_text(encoding="utf-8")):
            if kind == "dynamic":
                raise UnknownDepthError(f"{name}: its frame has no fixed size")
            self.frames[title(name)] = int(frame)
            self.calls.setdefault(title(name), set())
        caller = None
        for line in said(objdump, "-dr", obj).splitlines():
            head = re.match(r"[0-9a-f]+ <([^>]*)>:", line)
            call = re.search(r"R_AVR_(?:CALL|13_PCREL)\t(?:\.text\.)?([^+\s]+)", line)
            if head:
                caller = title(head.group(1))
            elif call and title(call.group(1)) != caller:
                self.calls[caller].add(title(call.group(1)))
            elif re.search(r"\te?icall", line):
                self.calls[caller].add(INDIRECT)

    def note_addresses(self, objdump, obj):
        """Functions whose address an object takes: any of them may be called indirectly."""
        here = {
            t.rsplit(":", 1)[-1]: t
            for t in self.frames
            if ":" not in t or pathlib.Path(t.rsplit(":", 1)[0]).stem == obj.stem
        }
        for line in said(objdump, "-r", obj).splitlines():
            fields = line.split()
            # With an offset it is a place within a function: a case of a switch.
            if (
                len(fields) == 3
                and fields[1].startswith("R_")
                and not re.search(r"CALL|JUMP|PLT|BRANCH|\d_PCREL", fields[1])
            ):
                title = here.get(re.sub(r"^\.text\.", "", fields[2]))
                if title is not None:
                    self.address_taken.add(title)


class MachineCode:
    """Stack of functions without a call graph, from a disassembly: whatever a function can reach is
    counted as if all of it were on the stack at once, and nothing ever taken off."""

    def __init__(self, objdump, nm, program):
        self.address = {}
        for line in said(nm, program).splitlines():
            fields = line.split()
            if len(fields) == 3 and fields[1] in "tTwW":
                self.address[fields[2]] = int(fields[0], 16) & ~1
        self.frames = {}
        self.reaches = {}
        self.by_register = {}
        listing = said(objdump, "-d", program)
        at_entry = AVR_RETURN_ADDRESS if "elf32-avr" in listing else 0
        function = None
        for line in listing.splitlines():
            head = re.match(r"([0-9a-f]+) <[^>]*>:", line)
            if head:
                function = int(head.group(1), 16)
                self.frames[function] = at_entry
                self.reaches[function] = set()
            elif function is not None and line.count("\t") >= 3:
                _, _, mnemonic, operands = line.split("\t", 3)
                self.frames[function] += self._taken(function, line, mnemonic.strip(), operands)
                target = re.search(r"<([^>+]*)", operands)
                if CALLING.match(mnemonic.strip()) and target:
                    self.reaches[function].add(target.group(1))

    def _taken(self, function, line, mnemonic, operands):
        """Bytes of stack that an instruction takes."""
        if mnemonic == "push" and operands.startswith("r"):  # AVR
            return 1
        if re.match(r"v?push|stmdb", mnemonic) and (
            mnemonic.endswith("push") or operands.startswith("sp!")
        ):
            return self._registers(operands) * (8 if "{d" in operands else 4)
        down = re.match(r"sp, ?(?:sp, ?)?(?:#|-)(\d+)", operands)
        if down and (mnemonic.startswith("sub") or "sp,sp,-" in operands):
            return int(down.group(1))
        if (mnemonic.startswith("sub") and operands.startswith("sp,")) or re.match(
            r"out\t0x3d", f"{mnemonic}\t{operands}"
        ):
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
    """title -> (bytes, path) of its deepest path."""
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
                    raise UnknownDepthError(f"{title}: calls a function that nothing names")
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
        description="The deepest path of stack through objects that "
        "were compiled with -fcallgraph-info=su or -fstack-usage."
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
        if obj.with_suffix(".ci").exists():
            graph.read(obj.with_suffix(".ci"))
        else:
            graph.read_usage(objdump, nm, obj)
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
