# SPDX-License-Identifier: MIT
"""`completion`: prints scripts with which shells complete commands and options."""

from __future__ import annotations

import argparse

from .errors import ExitCode
from .options import Options


class CompletionOptions(Options):
    """Options of `completion`."""

    shell: str
    parser: argparse.ArgumentParser


_HOW = """\
bash: roburoc4 completion bash > ~/.local/share/bash-completion/completions/roburoc4
zsh:  roburoc4 completion zsh > DIRECTORY/_roburoc4, with a DIRECTORY of $fpath
tcsh: roburoc4 completion tcsh > FILE, and "source FILE" in ~/.tcshrc
"""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "completion",
        help="print the completion script of a shell",
        description="Print a script that lets a shell complete commands and options.",
        epilog=_HOW,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", metavar="bash|zsh|tcsh", choices=("bash", "zsh", "tcsh"))
    parser.set_defaults(run=run)


def run(options: CompletionOptions) -> int:
    """Print it."""
    import shtab

    print(shtab.complete(options.parser, options.shell))
    return ExitCode.FINE
