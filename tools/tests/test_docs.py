# SPDX-License-Identifier: MIT
"""The pages show what there is: commands, options, the names of the reference."""

import ast
import re
import shlex
from pathlib import Path

import pytest
import python_reference

from roburoc4_tools.cli.app import parser

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = [
    DOCS / name for name in ("cli.md", "dashboard.md", "ros2.md", "recording.md", "real-robot.md")
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_parser_accepts_each_command_of_a_page(page: Path) -> None:
    shell = re.findall(r"^```(?:sh|console)\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    commands = re.findall(r"^(?:\$ )?roburoc4 ([^&>|\n]*)", "\n".join(shell), re.M)
    assert commands
    for command in commands:
        _, unknown = parser().parse_known_args(shlex.split(command, comments=True))
        assert not unknown or command.startswith("sim "), command


def test_the_manual_page_has_every_command_and_no_other() -> None:
    text = (DOCS / "man" / "roburoc4.1").read_text(encoding="utf-8").replace("\\-", "-")
    (commands,) = [action for action in parser()._actions if isinstance(action.choices, dict)]
    shown = re.findall(r"^\\fBroburoc4\\fR \\fI\\,(.*)\\/\\fR$", text, re.M)
    assert shown == list(commands.choices)


def test_tools_use_only_names_of_the_reference() -> None:
    public = {"__version__", "aio", *dir(python_reference.roburoc4)}
    for module in python_reference.PARTS:
        public |= {module.__name__.partition(".")[2], *module.__all__}
    for room in ("tools/src", "ros2/src"):
        for file in (DOCS.parent / room).rglob("*.py"):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom) and re.match(r"roburoc4\b", node.module or ""):
                    assert {name.name for name in node.names} <= public, f"{file}:{node.lineno}"
