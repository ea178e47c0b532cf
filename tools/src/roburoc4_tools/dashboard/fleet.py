# SPDX-License-Identifier: MIT
"""The robots of one dashboard: each page shows one of them in full, and the others in short."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

from .hub import Hub, Page


class Fleet:
    """Robots by name, in the order in which they were given."""

    def __init__(self, hubs: Sequence[Hub]) -> None:
        self.hubs = list(hubs)
        numbers = itertools.count(1)
        for hub in self.hubs:
            hub.numbers = numbers
            hub.look_around = self.now if len(self.hubs) > 1 else list

    def find(self, name: str) -> Hub | None:
        """Return the robot with this name; without a name, the first."""
        if not name:
            return self.hubs[0]
        return next((hub for hub in self.hubs if hub.name == name), None)

    def now(self) -> list[dict[str, Any]]:
        """Return all robots in short."""
        return [hub.in_short for hub in self.hubs]

    def stop(self, page: Page) -> None:
        """Stop and disarm all robots."""
        for hub in self.hubs:
            hub.control.stop(page)
            hub.note("bad", f"STOP was pressed on {page.name}")

    def rename(self, page: Page, name: str) -> None:
        """Call a page as its user wishes; with a number if another one has that name."""
        taken = {other.name for hub in self.hubs for other in hub.pages if other is not page}
        names = itertools.chain((name,), (f"{name} {number}" for number in itertools.count(2)))
        page.name = next(free for free in names if free not in taken)

    @property
    def failure(self) -> BaseException | None:
        """Why no more frames are made."""
        return next((hub.failure for hub in self.hubs if hub.failure is not None), None)

    def close(self) -> None:
        """Stop and disarm all robots that are driven from here."""
        for hub in self.hubs:
            hub.control.close()
