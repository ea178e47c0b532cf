# SPDX-License-Identifier: MIT
"""Measure flash, RAM and stack on small processors, beside other codecs.

bench/measure_footprint.py --functions    list the core's functions on a Cortex-M0, largest first
bench/measure_footprint.py --print        print the Cortex-M0's figures without keeping them
"""

import argparse
import pathlib
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
}
WITHOUT = ["-DROBUROC4_NO_TEXTS", "-DROBUROC4_NO_STATISTICS"]
LESS = {
    "the same, without texts and statistics": WITHOUT,
    "and without fixed ids": [*WITHOUT, "-DROBUROC4_NO_FIXED_ID"],
}
SMALL = ["-std=c99", "-Os", "-ffunction-sections", "-fdata-sections"]
ABOUT = (
    "Bytes at -Os. *All of it* is every function of the library. *Linked* is a whole program with "
    "`--gc-sections`, less one that does nothing; it includes what the compiler adds for 64-bit "
    "numbers and floats. The *firmware* receives, arms, drives and reads three statuses."
)
ABOUT_PEERS = (
    "Linked programs at -Os on a Cortex-M0, less a program that does nothing: encode and decode "
    "the five statuses and the drive command."
)
# Aims on the Cortex-M0, in bytes.
AIMS = {
    "codec, all of it": 2560,
    "codec of six messages, linked": 2560,
    "firmware that drives, linked": 19000,
    "the same, without texts and statistics": 16500,
    "moves, all of it": 4500,
    "a metre, in a firmware that drives": 6656,
    "a client's memory": 1500,
}


def sources(name):
    names = (figures.TOP / f"cmake/{name}_sources.txt").read_text(encoding="utf-8")
    return [figures.TOP / name for name in names.split()]


class Target:
    """Compiles, links and measures for one processor."""

    def __init__(self, name, folder):
        self.name = name
        self.prefix, self.flags = TARGETS[name]
        self.folder = folder / name
        self.folder.mkdir()

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

    def core(self, *more):
        return [self.compile(source, "-fcallgraph-info=su", *more) for source in sources("core")]

    def moves(self):
        return [self.compile(source) for source in sources("move")]

    def sizes(self, path):
        """text, data, bss"""
        return [int(n) for n in self.tool("size", path).splitlines()[1].split()[:3]]

    def link(self, name, objects, *more):
        """Link a program without start-up code."""
        out = self.folder / name
        self.tool("gcc", *self.flags, "-nostartfiles", *more, *objects, "-o", out)
        return out

    def linked(self, source, objects, *more):
        """Sizes of `source` and what it uses of `objects`, less those of an empty program."""
        used = ("-Wl,--gc-sections", "-Wl,--entry=main", "-Wl,-Map=" + str(self.map_of(source)))
        own = self.compile(source, *more)
        whole = self.sizes(self.link(own.stem, [own, *objects], *used))
        if "unwind" in self.linked_map(source):
            # 4 kB for C++ exceptions that no program here uses.
            raise SystemExit(f"measure_footprint: {source} carries an unwinder for {self.name}")
        empty = self.compile(figures.BENCH / "size/nothing.c")
        nothing = self.sizes(self.link("nothing", [empty], *used[:2]))
        return [a - b for a, b in zip(whole, nothing, strict=True)]

    def map_of(self, source):
        return self.folder / (pathlib.Path(source).stem + ".map")

    def linked_map(self, source):
        """The part of the linker's map that lists what is in the program."""
        text = self.map_of(source).read_text(encoding="utf-8")
        return text.split("Linker script and memory map")[1]

    def client_bytes(self):
        probe = self.folder / "probe.c"
        probe.write_text('#include "roburoc4.h"\nroburoc4_client client;\n', encoding="utf-8")
        return self.sizes(self.compile(probe, "-fno-common"))[2]


def stack(target, objects):
    """Bytes of the deepest path of calls; or None, and why it is unknown."""
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
    return int(done.stdout.split()[-1]), None


def functions(target, objects):
    rows = []
    for obj in objects:
        for line in target.tool("nm", "-S", "-t", "d", obj).splitlines():
            fields = line.split()
            if len(fields) == 4 and fields[2] in "TtRr":
                rows.append((int(fields[1]), obj.stem + ".c", fields[3]))
    return sorted(rows, reverse=True)


def measure_target(part, target):
    """Add all figures of one processor; return the core's objects."""
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
    drives = target.linked(figures.BENCH / "size/client_drive.c", objects)[0]
    add("firmware that drives, linked", drives)
    smaller = target
    for name, options in LESS.items():
        smaller = Target(target.name, smaller.folder)
        core = smaller.core(*options)
        add(name, target.linked(figures.BENCH / "size/client_drive.c", core, *options)[0])
    add("data + bss, all of it", sum(s[1] + s[2] for s in sizes.values()))
    moves = target.moves()
    add("moves, all of it", sum(target.sizes(o)[0] for o in moves if o.stem.startswith("move")))
    by = target.linked(figures.BENCH / "size/client_drive.c", objects + moves, "-DWITH_MOVE")[0]
    add("a metre, in a firmware that drives", by - drives)
    add("a client's memory", target.client_bytes())
    depth, why_not = stack(target, objects)
    add("stack", depth, note=why_not)
    return objects


def measure_codecs(part, target, peers, objects):
    """The codec beside others for the same messages."""
    quiet = ["-w", "-I", peers / "nanopb", "-I", peers / "mavlink"]
    size = figures.BENCH / "size"
    nanopb = [target.compile(s, *quiet) for s in sorted((peers / "nanopb").glob("*.c"))]
    for subject, program in (
        ("roburoc4", (size / "codec_roburoc4.c", objects)),
        ("nanopb", (size / "codec_nanopb.c", nanopb, *quiet)),
        ("MAVLink", (size / "codec_mavlink.c", [], *quiet)),
    ):
        text, data, bss = target.linked(*program)
        part.add("six messages, flash", subject, "bytes", text + data)
        part.add("six messages, RAM", subject, "bytes", data + bss)


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
        [*versions[:1], *figures.pinned("nanopb", "pymavlink")],
    )
    for target_name in TARGETS:
        target = Target(target_name, folder)
        objects = measure_target(part, target)
        if target_name == "Cortex-M0":
            measure_codecs(beside, target, given.peers, objects)
    part.write(given.out)
    beside.write(given.out)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--peers", type=pathlib.Path, help="folder of bench/codec/generate")
    parser.add_argument("--print", action="store_true", help="print the Cortex-M0's figures")
    parser.add_argument("--functions", action="store_true")
    parser.add_argument("--quick", action="store_true", help="the same: nothing here takes long")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        if given.functions or given.print:
            print_m0(Target("Cortex-M0", pathlib.Path(name)), given.functions)
        else:
            measure_all(pathlib.Path(name), given)


if __name__ == "__main__":
    main()
