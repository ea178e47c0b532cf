# SPDX-License-Identifier: MIT
"""One part's figures, and the file that keeps them (the format is in bench/README.md)."""

import argparse
import datetime
import hashlib
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


def packaged(name):
    """A Debian package and its version."""
    return run("dpkg-query", "-W", "-f", "${Package} ${Version}", name)


def pinned(*names):
    """What is compared with, as bench/requirements.txt has it."""
    text = (BENCH / "requirements.txt").read_text(encoding="utf-8")
    return [
        re.search(rf"^{name}==.*$", text, re.MULTILINE).group(0).replace("==", " ")
        for name in names
    ]


def compiler(build):
    """The C compiler of a build folder."""
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    found = re.search(r"^CMAKE_C_COMPILER:\w+=(.*)$", cache, re.MULTILINE)
    return first_line(found.group(1), "--version") + ", -O2"


def code():
    """Which code this is: the commit, and whether anything but figures differs from it."""
    git = ("git", "-C", TOP)
    try:
        commit = first_line(*git, "describe", "--always", "--tags")
        kept = (":!bench/results", ":!bench/RESULTS.md", ":!docs/images")
        changed = run(*git, "status", "--porcelain", "--untracked-files=no", "--", TOP, *kept)
    except (OSError, subprocess.CalledProcessError):
        return "no commit"  # an archive of the sources
    return commit + ("-dirty" if changed else "")


def source():
    """A checksum of src/ and include/: of what figures are, whatever is committed when."""
    digest = hashlib.sha256()
    for path in sorted(p for folder in ("src", "include") for p in (TOP / folder).rglob("*.[ch]")):
        digest.update(path.relative_to(TOP).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def median_interval(samples):
    """Median, and the ends of its 95 % interval, by the order of the samples."""
    ordered = sorted(samples)
    count = len(ordered)
    # How many lie below the median is binomial: 1.96 deviations of it to each side.
    aside = 0.98 * count**0.5
    low = max(0, math.floor((count - 1) / 2 - aside))
    return statistics.median(ordered), ordered[low], ordered[count - 1 - low]


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
            "code": code(),
            "source": source(),
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
