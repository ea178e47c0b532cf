# SPDX-License-Identifier: MIT
"""Write one part's figures to a file, for bench/report.py."""

import argparse
import datetime
import json
import math
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys

BENCH = pathlib.Path(__file__).resolve().parent
TOP = BENCH.parent


def run(*command, cwd=None, env=None, timeout=600):
    """Run a command and return its output; if it fails, the exception ends the program."""
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
    """Return the first line of a command's output: a tool's version."""
    return run(*command).splitlines()[0].strip()


def packaged(name):
    """Return a Debian package and its version."""
    return run("dpkg-query", "-W", "-f", "${Package} ${Version}", name)


def pinned(*names):
    """Return these packages with their versions from bench/requirements.txt."""
    text = (BENCH / "requirements.txt").read_text(encoding="utf-8")
    return [
        re.search(rf"^{name}==.*$", text, re.MULTILINE).group(0).replace("==", " ")
        for name in names
    ]


def compiler(build):
    """Return the version of a build folder's C compiler."""
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    found = re.search(r"^CMAKE_C_COMPILER:\w+=(.*)$", cache, re.MULTILINE)
    return first_line(found.group(1), "--version") + ", -O2"


def code():
    """Return the commit, with -dirty if anything but figures differs from it."""
    git = ("git", "-C", TOP)
    try:
        commit = first_line(*git, "describe", "--always", "--tags")
        kept = (":!bench/RESULTS.md",)
        changed = run(*git, "status", "--porcelain", "--untracked-files=no", "--", TOP, *kept)
    except (OSError, subprocess.CalledProcessError):
        return "no commit"  # an archive of the sources
    return commit + ("-dirty" if changed else "")


def median_interval(samples):
    """Return the median, and the ends of its 95 % interval (by order statistics)."""
    ordered = sorted(samples)
    count = len(ordered)
    # The number of samples below the median is binomial: take 1.96 deviations to each side.
    aside = 0.98 * count**0.5
    low = max(0, math.floor((count - 1) / 2 - aside))
    return statistics.median(ordered), ordered[low], ordered[count - 1 - low]


def arguments(doc):
    """Parse what scripts/bench passes to a measuring program."""
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true")
    return parser.parse_args()


def machine():
    """Return the processor, their number, and the system."""
    name = platform.machine()
    info = pathlib.Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    return f"{name}, {os.cpu_count()} processors, {platform.system()} {platform.machine()}"


class Part:
    """The figures of one part."""

    def __init__(self, part, title, about, versions):
        self.part = part
        self.head = {
            "part": part,
            "title": title,
            "about": about,
            "measured": datetime.datetime.now(datetime.UTC).date().isoformat(),
            "machine": machine(),
            "code": code(),
            "versions": versions,
            "quick": "--quick" in sys.argv,
        }
        self.results = []

    def add(self, name, subject, unit, value, **more):
        """Add one figure; `more` is low, high, aim, better, note."""
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
        """Write the figures to FOLDER/PART.json."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps({**self.head, "results": self.results}, indent=1)
        new = folder / f"{self.part}.json.new"
        new.write_text(text + "\n", encoding="utf-8")
        new.replace(folder / f"{self.part}.json")
