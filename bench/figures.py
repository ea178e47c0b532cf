# SPDX-License-Identifier: MIT
"""One part's figures, and the file that keeps them (the format is in bench/README.md)."""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

BENCH = pathlib.Path(__file__).resolve().parent
TOP = BENCH.parent


def run(*command, cwd=None, env=None, timeout=600):
    """Output of a command; its errors are shown, and end the program, where it fails."""
    return subprocess.run(
        [str(word) for word in command],
        check=True,
        text=True,
        stdout=subprocess.PIPE,
        cwd=cwd,
        env=env,
        timeout=timeout,
    ).stdout


def first_line(*command):
    """First line that a tool says of itself."""
    return run(*command).splitlines()[0].strip()


def arguments(doc):
    """What scripts/bench gives to a measuring program of a build folder."""
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true")
    return parser.parse_args()


def machine():
    """Processor, how many, system."""
    name = platform.machine()
    info = pathlib.Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    return f"{name}, {os.cpu_count()} processors, {platform.system()} {platform.machine()}"


class Part:
    """What one part measured."""

    def __init__(self, part, title, about, versions):
        self.part = part
        self.head = {
            "part": part,
            "title": title,
            "about": about,
            "measured": datetime.datetime.now(datetime.UTC).date().isoformat(),
            "machine": machine(),
            "versions": versions,
            "quick": "--quick" in sys.argv,
        }
        self.results = []

    def add(self, name, subject, unit, value, **more):
        """One figure; `more` is low, high, aim, better, note."""
        self.results.append(
            {
                "name": name,
                "subject": subject,
                "unit": unit,
                "value": value,
                **{k: v for k, v in more.items() if v is not None},
            }
        )

    def write(self, folder):
        """Leave the figures in FOLDER/PART.json."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps({**self.head, "results": self.results}, indent=1)
        new = folder / f"{self.part}.json.new"
        new.write_text(text + "\n", encoding="utf-8")
        new.replace(folder / f"{self.part}.json")
