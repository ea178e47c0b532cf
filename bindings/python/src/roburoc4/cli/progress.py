# SPDX-License-Identifier: MIT
"""A progress bar on stderr, where that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Show = Callable[[float, str], None]


@contextmanager
def progress(title: str, total_s: float | None) -> Iterator[Show]:
    """Show how much of a time is over: call what this gives with the elapsed time and a text."""
    if not sys.stderr.isatty():
        yield lambda _elapsed_s, _text: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from .output import console

    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn(f"of {total_s:.0f} s" if total_s is not None else "Ctrl-C ends it"),
        console=console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(title, total=total_s)
        yield lambda elapsed_s, text: bar.update(task, completed=elapsed_s, description=text)
