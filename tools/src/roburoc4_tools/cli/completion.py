# SPDX-License-Identifier: MIT
"""`completion`: prints scripts with which shells complete commands and options."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator

from .errors import ExitCode
from .options import Options

_BY_SHTAB = ("bash", "zsh", "tcsh")
_HOW = """\
bash: roburoc4 completion bash > ~/.local/share/bash-completion/completions/roburoc4
zsh:  roburoc4 completion zsh > DIRECTORY/_roburoc4, with a DIRECTORY of $fpath
fish: roburoc4 completion fish > ~/.config/fish/completions/roburoc4.fish
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
    parser.add_argument("shell", metavar="bash|zsh|tcsh|fish", choices=(*_BY_SHTAB, "fish"))
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Print it."""
    if options.shell == "fish":
        print("\n".join(_fish(options.parser)))
        return ExitCode.FINE
    import shtab

    print(shtab.complete(options.parser, options.shell))
    return ExitCode.FINE


def _fish(top: argparse.ArgumentParser) -> Iterator[str]:
    """Write it for fish, which shtab does not know: commands, their options, and choices."""
    (commands,) = [a for a in top._actions if isinstance(a, argparse._SubParsersAction)]
    # fish's own __fish_use_subcommand takes the value of an option before the command for one.
    yield "function __roburoc4_needs_command"
    yield f"    not __fish_seen_subcommand_from {' '.join(commands.choices)}"
    yield "end"
    needed = "complete -c roburoc4 -n __roburoc4_needs_command"
    yield f"{needed} -f"
    for choice in commands._choices_actions:
        yield f"{needed} -f -a {choice.dest} -d {_quoted(choice.help or '')}"
    yield from _fish_options(needed, (a for a in top._actions if a is not commands))
    for name, command in commands.choices.items():
        seen = f"complete -c roburoc4 -n '__fish_seen_subcommand_from {name}'"
        yield from _fish_options(seen, command._actions)


def _fish_options(when: str, actions: Iterable[argparse.Action]) -> Iterator[str]:
    for action in actions:
        flags = "".join(
            f" -l {flag[2:]}" if flag.startswith("--") else f" -s {flag[1:]}"
            for flag in action.option_strings
        )
        value = " -r" if action.option_strings and action.nargs != 0 else ""
        if action.choices:
            value += f" -f -a {_quoted(' '.join(map(str, action.choices)))}"
        if flags or action.choices:
            yield f"{when}{flags}{value} -d {_quoted(_plain(action.help))}"


def _plain(text: str | None) -> str:
    return "" if text in (None, argparse.SUPPRESS) else str(text).replace("%%", "%")


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
