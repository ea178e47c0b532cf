# SPDX-License-Identifier: MIT
"""Sphinx's settings for the documentation site. scripts/docs builds it."""

import os
import re
import subprocess
from pathlib import Path

from sphinx.application import Sphinx

TOP = Path(__file__).resolve().parents[2]

project = "roburoc4"
author = "The roburoc4 maintainers"
copyright = author  # noqa: A001, the name that Sphinx reads
release = ".".join(
    re.findall(
        r"#define ROBUROC4_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)",
        (TOP / "include/roburoc4.h").read_text(),
    )
)

extensions = ["breathe", "myst_parser", "sphinx_copybutton"]
include_patterns = [
    "index.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "bench/README.md",
    "bench/RESULTS.md",
    "docs/*.md",
    "docs/reference/*.md",
    "ros2/tests/fastdds/README.md",
    "tests/*/README.md",
]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_title = f"roburoc4 {release}"
html_show_copyright = False
html_copy_source = False
myst_heading_anchors = 4
suppress_warnings = ["misc.highlighting_failure"]

breathe_projects = {"roburoc4": os.environ.get("ROBUROC4_DOXYGEN_XML", "")}
breathe_default_project = "roburoc4"
breathe_domain_by_extension = {"h": "c"}


def matlab_reference() -> str:
    """The help texts of the toolbox: the first comment of each file and method."""
    parts = ["# MATLAB reference\n"]
    folder = TOP / "bindings/matlab/toolbox/+roburoc4"
    for file in sorted(folder.glob("*.m")):
        if file.stem == "Contents":
            continue
        parts.append(f"## roburoc4.{file.stem}\n")
        for name, text in help_texts(file.read_text()):
            if name != file.stem:
                parts.append(f"### {file.stem}.{name}\n")
            parts.append(f"```text\n{text}\n```\n")
    return "\n".join(parts)


def help_texts(source: str) -> list[tuple[str, str]]:
    """Name and text of each class, function and public method that has a help text."""
    found = []
    name, public, lines = "", True, source.splitlines()
    for number, line in enumerate(lines):
        if block := re.match(r"\s*methods\b(.*)", line):
            public = "private" not in block[1] and "Hidden" not in block[1]
        head = re.match(r"\s*(?:classdef|function)\b[^%]*?(\w+)(?:\s*<.*|\s*\(.*\))?\s*$", line)
        if head is None or not public:
            continue
        name = head[1]
        text = []
        for comment in lines[number + 1 :]:
            if not (body := re.match(r"\s*%(.*)", comment)):
                break
            text.append(body[1].removeprefix(" "))
        if text and not text[0].startswith("SPDX"):
            found.append((name, "\n".join(text).strip()))
    return found


def lcm_reference() -> str:
    parts = [
        "# LCM types\n",
        "The files that `lcm-gen` reads, with channel, units and meaning of every field.\n",
    ]
    for file in sorted((TOP / "lcm/types").glob("*.lcm")):
        parts.append(f"## {file.stem}\n\n```c\n{file.read_text()}```\n")
    return "\n".join(parts)


def manual_pages() -> str:
    parts = ["# Manual pages\n", "What `man` shows where the programs are installed.\n"]
    for file in sorted((TOP / "docs/man").glob("*.1")):
        ragged = re.sub(r"(?m)^\.TH .*$", r"\g<0>\n.ad l\n.nh", file.read_text())
        command = ["groff", "-man", "-Tascii", "-P-cbou", "-rLL=92n"]
        text = subprocess.run(
            command, input=ragged, capture_output=True, text=True, check=True
        ).stdout
        parts.append(f"## {file.stem}\n\n```text\n{text.strip()}\n```\n")
    return "\n".join(parts)


def write_references(app: Sphinx) -> None:
    folder = app.srcdir / "docs" / "reference"
    (folder / "matlab.md").write_text(matlab_reference())
    (folder / "lcm.md").write_text(lcm_reference())
    (folder / "man.md").write_text(manual_pages())


def mend_links(app: Sphinx, page: str, content: list[str]) -> None:
    """README.md is index.md here; a link to a folder becomes plain text, as folders have no page. A
    file's name becomes the page's title."""

    def mend(link: re.Match[str]) -> str:
        text, path, anchor = link.groups()
        target = ((app.srcdir / page).parent / path).resolve()
        if text.endswith(".md"):
            text = ""
        if target == app.srcdir / "README.md":
            index = os.path.relpath(app.srcdir / "index.md", (app.srcdir / page).parent)
            return f"[{text}]({index}{anchor})"
        return text if target.is_dir() else f"[{text}]({path}{anchor})"

    content[0] = re.sub(r"(?<!!)\[([^]]+)\]\(([\w./+-]+)((?:#[\w-]+)?)\)", mend, content[0])


def setup(app: Sphinx) -> None:
    app.connect("builder-inited", write_references)
    app.connect("source-read", mend_links)
