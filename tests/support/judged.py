# SPDX-License-Identifier: MIT
"""For unittest: who waits for robots in real time judges only on a machine that keeps time.

A client that hears nothing for 300 ms stops, as it should, and so does one whose machine did not
run it for so long.
"""

import contextlib
import functools
import os
import subprocess
import unittest
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

TRIES = 3
HOPELESS_MS = 200
"""With what else takes time, a stall of this length ends a lease of 250 ms."""


@contextlib.contextmanager
def watch_stalls() -> Iterator[list[int]]:
    """What scripts/stalls, or the program STALLS, prints meanwhile."""
    program = os.environ.get("STALLS") or Path(__file__).parents[2] / "scripts/stalls"
    stalls_ms: list[int] = []
    with subprocess.Popen([program], stdout=subprocess.PIPE) as watcher:
        try:
            yield stalls_ms
        finally:
            watcher.terminate()
            stalls_ms.extend(map(int, watcher.communicate()[0].split()))


def judged(test: Callable[[Any], None]) -> Callable[[Any], None]:
    """A test that fails runs again only where this machine was measured to stall.

    Where it stalled for long in the last try, too, the test is skipped as not judged.
    """

    @functools.wraps(test)
    def tries(self: unittest.TestCase) -> None:
        for left in reversed(range(TRIES)):
            failed = None
            with watch_stalls() as stalls_ms:
                try:
                    test(self)
                except unittest.SkipTest:
                    raise
                except Exception as error:  # a pipe that closed, or an answer that did not come
                    failed = error
            if failed is None:
                return
            stall_ms = max(stalls_ms, default=0)
            if stall_ms < (1 if left else HOPELESS_MS):
                raise failed
            verdict = "begins again" if left else "not judged"
            print(f"{verdict}: this machine stalled for {stall_ms} ms; {failed!r}")
            self.doCleanups()
        self.skipTest(f"this machine stalled for {stall_ms} ms")

    return tries
