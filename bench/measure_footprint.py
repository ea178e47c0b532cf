# SPDX-License-Identifier: MIT
"""Bytes of text, data, bss and stack on small processors; the same messages by other codecs.

bench/measure_footprint.py --functions    list the functions of the Cortex-M0, largest first
bench/measure_footprint.py --print        print its figures, and keep none
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import figures

TARGETS = {
    "Cortex-M0": ("arm-none-eabi-", ["-mthumb", "-mcpu=cortex-m0"]),
    "Cortex-M3": ("arm-none-eabi-", ["-mthumb", "-mcpu=cortex-m3"]),
    "Cortex-M4F": (
        "arm-none-eabi-",
        ["-mthumb", "-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
    ),
    "RV32": ("riscv64-unknown-elf-", ["-march=rv32imac", "-mabi=ilp32", "--specs=picolibc.specs"]),
    "AVR": ("avr-", ["-mmcu=atmega2560"]),
}
SMALL = ["-std=c99", "-Os", "-ffunction-sections", "-fdata-sections"]
ABOUT = (
    "Bytes at -Os. *All of it* is every function of the library. *Linked* is a whole program with "
    "`--gc-sections`, less one that does nothing: what it really takes, the compiler's own "
    "functions (64-bit arithmetic, floats) included: *bare loop that drives* receives, arms, "
    "drives and reads three statuses. *Stack* is the deepest path of calls."
)
ABOUT_PEERS = (
    "Encode and decode of the five statuses and the drive command, linked with `--gc-sections`, at "
    "-Os, less a program that does nothing. Each is rebuilt here; coreSNTP, a protocol of like "
    "size, is in no package registry: its figure is its own documentation's."
)
# part of the table -> bytes aimed at, on the Cortex-M0
AIMS = {
    "codec, all of it": 2560,
    "codec of six messages, linked": 2560,
    "codec + client, all of it": 8192,
    "bare loop that drives, linked": 8192,
    "moves, all of it": 1536,
    "a client's memory": 1024,
}


def core_sources():
    names = (figures.TOP / "cmake/core_sources.txt").read_text(encoding="utf-8")
    return [figures.TOP / name for name in names.split()]


class Target:
    """One processor: compiling, linking and measuring for it."""

    def __init__(self, name, folder):
        self.name = name
        self.prefix, self.flags = TARGETS[name]
        self.folder = folder / name
        self.folder.mkdir()
        # AVR's gcc is too old for call graphs: stack_depth.py makes do with frames.
        self.frames = "-fstack-usage" if name == "AVR" else "-fcallgraph-info=su"

    def tool(self, name, *arguments):
        return figures.run(self.prefix + name, *arguments)

    def compile(self, source, *more):
        out = self.folder / (pathlib.Path(source).stem + ".o")
        self.tool(
            "gcc",
            *SMALL,
            *self.flags,
            "-I",
            figures.TOP / "include",
            *more,
            "-c",
            source,
            "-o",
            out,
        )
        return out

    def core(self):
        return [self.compile(source, self.frames) for source in core_sources()]

    def sizes(self, path):
        """text, data, bss"""
        return [int(n) for n in self.tool("size", path).splitlines()[1].split()[:3]]

    def link(self, name, objects, *more):
        """A program without start-up code and system: main() is where it begins."""
        out = self.folder / name
        self.tool("gcc", *self.flags, "-nostartfiles", *more, *objects, "-o", out)
        return out

    def linked(self, source, objects, *more):
        """Size of a program of `source` and what it uses of `objects`, less the empty program's."""
        used = ("-Wl,--gc-sections", "-Wl,--entry=main", "-Wl,-Map=" + str(self.map_of(source)))
        own = self.compile(source, *more)
        whole = self.sizes(self.link(own.stem, [own, *objects], *used))
        if "unwind" in self.linked_map(source):
            # 4 kB that none of the codecs asked for: those of C++, or of tables for exceptions.
            raise SystemExit(f"measure_footprint: {source} carries an unwinder for {self.name}")
        empty = self.compile(figures.BENCH / "size/nothing.c")
        nothing = self.sizes(self.link("nothing", [empty], *used[:2]))
        return [a - b for a, b in zip(whole, nothing, strict=True)]

    def map_of(self, source):
        return self.folder / (pathlib.Path(source).stem + ".map")

    def linked_map(self, source):
        """The linker's map without its beginning: what was left out, and why what was taken."""
        text = self.map_of(source).read_text(encoding="utf-8")
        return text.split("Linker script and memory map")[1]

    def client_bytes(self):
        probe = self.folder / "probe.c"
        probe.write_text('#include "roburoc4.h"\nroburoc4_client client;\n', encoding="utf-8")
        return self.sizes(self.compile(probe, "-fno-common"))[2]


def linked_files(target, source):
    """Bytes of a linked program by where they come from, largest first, by the linker's map."""
    text = target.linked_map(source)
    found = {}
    for size, origin in re.findall(
        r"^ \.(?:text|rodata)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+)\s+(\S+)$", text, re.MULTILINE
    ):
        library = re.search(r"(lib\w+\.a)\(", origin)
        name = library.group(1) if library else pathlib.Path(origin).stem + ".c"
        found[name] = found.get(name, 0) + int(size, 16)
    return sorted(((size, name) for name, size in found.items() if size), reverse=True)


def stack(target, objects):
    """The deepest path of stack, and the path as text."""
    program = target.link("core", objects, "-Wl,--no-gc-sections", "-Wl,--entry=0")
    done = subprocess.run(
        [
            sys.executable,
            figures.BENCH / "size/stack_depth.py",
            "--tools",
            target.prefix,
            "--program",
            program,
            *objects,
        ],
        text=True,
        capture_output=True,
        check=False,
    )
    if done.returncode != 0:
        return None, done.stderr.strip().splitlines()[-1]
    return int(done.stdout.split()[-1]), done.stdout


def functions(target, objects):
    rows = []
    for obj in objects:
        for line in target.tool("nm", "-S", "-t", "d", obj).splitlines():
            fields = line.split()
            if len(fields) == 4 and fields[2] in "TtRr":
                rows.append((int(fields[1]), obj.stem + ".c", fields[3]))
    return sorted(rows, reverse=True)


def measure_target(part, target):
    """All figures of one processor; the objects of the core."""
    objects = target.core()
    sizes = {o.stem: target.sizes(o) for o in objects}
    m0 = target.name == "Cortex-M0"

    def add(name, value, note=None):
        part.add(name, target.name, "bytes", value, aim=AIMS.get(name) if m0 else None, note=note)

    add("codec, all of it", sizes["codec"][0])
    add(
        "codec of six messages, linked",
        target.linked(figures.BENCH / "size/codec_roburoc4.c", objects)[0],
    )
    add("codec + client, all of it", sum(s[0] for s in sizes.values()))
    add(
        "bare loop that drives, linked",
        target.linked(figures.BENCH / "size/client_drive.c", objects)[0],
    )
    add("data + bss, all of it", sum(s[1] + s[2] for s in sizes.values()))
    add("moves, all of it", target.sizes(target.compile(figures.TOP / "src/move.c"))[0])
    add("a client's memory", target.client_bytes())
    depth, path = stack(target, objects)
    add("stack", depth, None if depth else path)
    return objects


def measure_peers(part, target, peers, objects):
    """The same messages by others."""
    quiet = ["-w", "-I", peers / "nanopb", "-I", peers / "mavlink"]
    size = figures.BENCH / "size"

    def add(name, subject, value, note=None):
        part.add(f"{name}, {target.name}", subject, "bytes", value, note=note)

    def add_linked(subject, *program):
        text, data, bss = target.linked(*program)
        add("codec of six messages", subject, text)
        add("its data + bss", subject, data + bss)

    add_linked("roburoc4", size / "codec_roburoc4.c", objects)
    if target.name == "AVR":
        add("codec of six messages", "nanopb", None, "needs a double of 8 bytes")
    else:
        nanopb = [target.compile(s, *quiet) for s in sorted((peers / "nanopb").glob("*.c"))]
        add_linked("nanopb", size / "codec_nanopb.c", nanopb, *quiet)
    add_linked("MAVLink", size / "codec_mavlink.c", [], "-DALL_MESSAGES", *quiet)
    add(
        "codec of the drive command alone",
        "MAVLink",
        target.linked(size / "codec_mavlink.c", [], *quiet)[0],
    )


def print_m0(target, only_functions):
    if only_functions:
        for size, file, function in functions(target, target.core()):
            print(f"{size:6}  {file:14} {function}")
        return
    part = figures.Part("footprint", "Footprint", ABOUT, [])
    measure_target(part, target)
    for result in part.results:
        aim = f"aim {result['aim']}" if "aim" in result else ""
        print(f"{result['name']:32} {result['value']:6} {aim}")


def measure_all(folder, given):
    versions = sorted({figures.first_line(p + "gcc", "--version") for p, _ in TARGETS.values()})
    part = figures.Part("footprint", "Footprint", ABOUT, versions)
    beside = figures.Part(
        "footprint_peers",
        "Footprint beside peers",
        ABOUT_PEERS,
        [*versions, *figures.pinned("nanopb", "pymavlink")],
    )
    for target_name in ("Cortex-M0",) if given.quick else TARGETS:
        target = Target(target_name, folder)
        objects = measure_target(part, target)
        if target_name == "Cortex-M0":
            part.head["functions"] = functions(target, objects)
            part.head["linked"] = linked_files(target, "client_drive.c")
            part.head["stack_path"] = stack(target, objects)[1]
        if given.peers:
            measure_peers(beside, target, given.peers, objects)
    part.write(given.out)
    if given.peers:
        beside.add("SNTP codec and client, Cortex-M", "coreSNTP", "bytes", 2048, note="not rebuilt")
        beside.write(given.out)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--peers", type=pathlib.Path, help="folder of bench/codec/generate")
    parser.add_argument("--print", action="store_true", help="print the Cortex-M0's figures only")
    parser.add_argument("--functions", action="store_true")
    parser.add_argument("--quick", action="store_true", help="Cortex-M0 only")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        if given.functions or given.print:
            print_m0(Target("Cortex-M0", pathlib.Path(name)), given.functions)
        else:
            measure_all(pathlib.Path(name), given)


if __name__ == "__main__":
    main()
