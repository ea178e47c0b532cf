# SPDX-License-Identifier: MIT
"""For pytest: a failure on a machine that was measured to be too busy is reported as that.

Such tests are run again, and listed (run_pytest in scripts/lib.sh).
"""

import threading
import time
from collections.abc import Generator

import pytest

_NAP_S = 0.01
_TOO_LATE_S = 0.1
"""The tightest promise that is tested leaves 150 ms for the machine."""


class MachineTooBusyError(Exception):
    """Not a failure: the test is to be run again. Only after several such runs it is one."""


class _Strain:
    """Takes naps in a thread of its own: how long it oversleeps shows how busy the machine is."""

    def __init__(self) -> None:
        self.worst_s = 0.0
        threading.Thread(target=self._nap, daemon=True).start()

    def _nap(self) -> None:
        while True:
            begun_s = time.monotonic()
            time.sleep(_NAP_S)
            self.worst_s = max(self.worst_s, time.monotonic() - begun_s - _NAP_S)


_strain = _Strain()


def _explained() -> Generator[None, object, object]:
    try:
        return (yield)
    except Exception as error:
        if _strain.worst_s > _TOO_LATE_S:
            raise MachineTooBusyError(
                f"a nap of {_NAP_S} s took {_strain.worst_s:.2f} s more"
            ) from error
        raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup() -> Generator[None, object, object]:
    _strain.worst_s = 0.0
    return (yield from _explained())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, object, object]:
    return (yield from _explained())
