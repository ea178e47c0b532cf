# SPDX-License-Identifier: MIT
"""A progress bar on stderr, if that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Show = Callable[[float, str], None]


@contextmanager
def progress(title: str, total: float | None, unit: str = "s") -> Iterator[Show]:
    """Show how much of a total is done: call the returned function with the amount and a text."""
    if not sys.stderr.isatty():
        yield lambda _done, _text: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from .output import console

    amount = "Ctrl-C ends it"
    if total is not None:
        amount = f"{{task.completed:.2f}} of {total:.3g} {unit} in"
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(amount),
        TimeElapsedColumn(),
        console=console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(title, total=total)
        yield lambda done, text: bar.update(task, completed=done, description=text)
