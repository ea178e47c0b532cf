#!/usr/bin/env python3
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
    "Cortex-M4F": ("arm-none-eabi-", ["-mthumb", "-mcpu=cortex-m4", "-mfloat-abi=hard",
                                      "-mfpu=fpv4-sp-d16"]),
    "RV32": ("riscv64-unknown-elf-", ["-march=rv32imac", "-mabi=ilp32", "--specs=picolibc.specs"]),
    "AVR": ("avr-", ["-mmcu=atmega2560"]),
}
SMALL = ["-std=c99", "-Os", "-ffunction-sections", "-fdata-sections"]
ABOUT = (
    "Bytes at -Os. *All of it* is every function of the library. *Linked* is a whole program with "
    "`--gc-sections`, less one that does nothing: what it really takes, the compiler's own "
    "functions (64-bit arithmetic, floats) included: *bare loop that drives* receives, arms, drives "
    "and reads three statuses.")
ABOUT_PEERS = (
    "Encode and decode of the five statuses and the drive command, linked with `--gc-sections`, at "
    "-Os, less a program that does nothing. Each is rebuilt here; coreSNTP, a protocol of like size, "
    "is in no package registry: its figure is its own documentation's.")
# part of the table -> bytes aimed at, on the Cortex-M0
AIMS = {"codec, all of it": 2560, "codec + client, all of it": 8192,
        "bare loop that drives, linked": 8192, "a client's memory": 1024}


def core_sources():
    text = (figures.TOP / "CMakeLists.txt").read_text(encoding="utf-8")
    block = re.search(r"^set\(core_sources(.*?)\)", text, re.M | re.S).group(1)
    return [figures.TOP / name for name in block.split()]


class Target:
    """One processor: compiling, linking and measuring for it."""

    def __init__(self, name, folder):
        self.name = name
        self.prefix, self.flags = TARGETS[name]
        self.folder = folder / name
        self.folder.mkdir()

    def tool(self, name, *arguments):
        return figures.run(self.prefix + name, *arguments)

    def compile(self, source, *more):
        out = self.folder / (pathlib.Path(source).stem + ".o")
        self.tool("gcc", *SMALL, *self.flags, "-I", figures.TOP / "include", *more, "-c", source,
                  "-o", out)
        return out

    def sizes(self, path):
        """text, data, bss"""
        return [int(n) for n in self.tool("size", path).splitlines()[1].split()[:3]]

    def linked(self, source, objects, *more):
        """Size of a program of `source` and what it uses of `objects`, less the empty program's."""
        def link(name, objs):
            out = self.folder / name
            # No start-up code and no system: main() is where it begins.
            self.tool("gcc", *self.flags, "-nostartfiles", "-Wl,--gc-sections", "-Wl,--entry=main",
                      *objs, "-o", out)
            return self.sizes(out)
        own = self.compile(source, *more)
        nothing = link("nothing", [self.compile(figures.BENCH / "size/nothing.c")])
        return [a - b for a, b in zip(link(own.stem, [own, *objects]), nothing)]

    def client_bytes(self):
        probe = self.folder / "probe.c"
        probe.write_text('#include "roburoc4.h"\nroburoc4_client client;\n', encoding="utf-8")
        return self.sizes(self.compile(probe, "-fno-common"))[2]


def stack(target, sources):
    """The deepest path of stack, by gcc's call graphs (ARM), and the path as text."""
    objects = [target.compile(s, "-fcallgraph-info=su") for s in sources]
    program = target.folder / "core"
    target.tool("gcc", *target.flags, "-nostartfiles", "-Wl,--entry=0", *objects, "-o", program)
    done = subprocess.run(
        [sys.executable, figures.BENCH / "size/stack_depth.py", "--tools", target.prefix,
         "--program", program, *objects], text=True, capture_output=True, check=False)
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


def measure_target(part, target, sources):
    objects = [target.compile(s) for s in sources]
    sizes = {o.stem: target.sizes(o) for o in objects}
    text = sum(s[0] for s in sizes.values())
    m0 = target.name == "Cortex-M0"

    def add(name, value, note=None):
        part.add(name, target.name, "bytes", value, aim=AIMS.get(name) if m0 else None, note=note)

    add("codec, all of it", sizes["codec"][0])
    add("codec + client, all of it", text)
    add("data + bss, all of it", sum(s[1] + s[2] for s in sizes.values()))
    add("codec of six messages, linked",
        target.linked(figures.BENCH / "size/codec_roburoc4.c", objects)[0])
    add("bare loop that drives, linked",
        target.linked(figures.BENCH / "size/client_drive.c", objects)[0])
    add("a client's memory", target.client_bytes())
    if target.prefix.startswith("arm"):
        depth, _ = stack(target, sources)
        add("deepest stack", depth)
    else:
        add("deepest stack", None, "no call graph from this compiler")
    return objects


def measure_peers(part, target, peers):
    """The same messages by others, on one processor."""
    quiet = ["-w", "-I", peers / "nanopb", "-I", peers / "mavlink"]
    nanopb = [target.compile(s, *quiet) for s in sorted((peers / "nanopb").glob("*.c"))]
    size = figures.BENCH / "size"

    def add(name, subject, value, note=None):
        part.add(name, subject, "bytes", value, note=note)

    name = "codec of six messages, Cortex-M0"
    add(name, "roburoc4", target.linked(size / "codec_roburoc4.c", [
        target.compile(s) for s in core_sources()])[0])
    add(name, "nanopb", target.linked(size / "codec_nanopb.cpp", nanopb, *quiet)[0])
    add(name, "MAVLink", target.linked(size / "codec_mavlink.cpp", [], "-DALL_MESSAGES", *quiet)[0])
    add("codec of the drive command alone, Cortex-M0", "MAVLink",
        target.linked(size / "codec_mavlink.cpp", [], *quiet)[0])
    add("SNTP codec and client, Cortex-M, as documented", "coreSNTP", 2048, "not rebuilt")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--peers", type=pathlib.Path, help="folder of bench/codec/generate")
    parser.add_argument("--print", action="store_true", help="print the Cortex-M0's figures only")
    parser.add_argument("--functions", action="store_true")
    parser.add_argument("--quick", action="store_true", help="Cortex-M0 only")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if given.functions:
            target = Target("Cortex-M0", folder)
            for size, file, function in functions(target, map(target.compile, core_sources())):
                print(f"{size:6}  {file:14} {function}")
            return
        if given.print:
            part = figures.Part("footprint", "Footprint", ABOUT, [])
            measure_target(part, Target("Cortex-M0", folder), core_sources())
            for result in part.results:
                aim = f"aim {result['aim']}" if "aim" in result else ""
                print(f"{result['name']:32} {result['value']:6} {aim}")
            return
        versions = sorted({figures.first_line(p + "gcc", "--version") for p, _ in TARGETS.values()})
        part = figures.Part("footprint", "Footprint", ABOUT, versions)
        for target_name in TARGETS:
            if given.quick and target_name != "Cortex-M0":
                continue
            target = Target(target_name, folder)
            objects = measure_target(part, target, core_sources())
            if target_name == "Cortex-M0":
                table = functions(target, objects)
                part.head["functions"] = table
                part.head["stack_path"] = stack(target, core_sources())[1]
        part.write(given.out)
        if given.peers:
            (folder / "peers").mkdir()
            beside = figures.Part("footprint_peers", "Footprint beside peers", ABOUT_PEERS, [])
            measure_peers(beside, Target("Cortex-M0", folder / "peers"), given.peers)
            beside.write(given.out)


if __name__ == "__main__":
    main()
