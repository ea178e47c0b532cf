# SPDX-License-Identifier: MIT
"""For pytest: a failure on a machine that was measured to be too busy is reported as that.

Such tests are run again, and listed (run_pytest in scripts/lib.sh). Where the machine stalls for
about a lease in the last try, too, it cannot judge them: they are skipped as "not judged", and
counted.
"""

import mmap
import os
import threading
import time
from collections.abc import Generator

import pytest

_NAP_S = 0.01
_TOO_LATE_S = 0.05
"""The tightest promise that is tested leaves three times as long for the machine."""
_HOPELESS_S = 0.2
"""With what else takes time, a stall of this length ends a lease of 250 ms."""
_TRIES = 3
"""As many as --reruns allows in scripts/lib.sh and ros2/tests/fastdds/pytest.ini."""


class MachineTooBusyError(Exception):
    """Not a failure: the test is to be run again. Only after several such runs it is one."""


_worst_s = memoryview(mmap.mmap(-1, 8)).cast("d")
"""How much longer than asked the worst nap took; shared with processes that this one forks."""


def _nap() -> None:
    begun_s = time.monotonic()
    time.sleep(_NAP_S)
    _worst_s[0] = max(_worst_s[0], time.monotonic() - begun_s - _NAP_S)


def _nap_on() -> None:
    while True:
        _nap()


threading.Thread(target=_nap_on, daemon=True).start()


def watch_session() -> None:
    """Take naps in a forked process, too, until the caller's process ends.

    For the first process of a session: Linux (autogroup) may not run a session for seconds on a
    machine where others run.
    """
    parent = os.getpid()
    if os.fork():
        return
    os.setpgid(0, 0)  # keys of the terminal are not for this process
    os.closerange(0, 65536)
    while os.getppid() == parent:
        _nap()
    os._exit(0)


def forget() -> None:
    """Begin to judge anew."""
    _worst_s[0] = 0.0


def worst_s() -> float:
    """How much longer than asked the worst nap took since then."""
    return _worst_s[0]


def explained(item: pytest.Item) -> Generator[None, object, object]:
    """Raise MachineTooBusyError for a failure on a machine that was; skip it after the last try."""
    try:
        return (yield)
    except (Exception, pytest.fail.Exception) as error:  # the latter: pytest.raises() saw nothing
        late_s = worst_s()
        if late_s <= _TOO_LATE_S:
            raise
        late = f"a nap of {_NAP_S} s took {late_s:.2f} s more"
        if late_s > _HOPELESS_S and getattr(item, "execution_count", 1) >= _TRIES:
            pytest.skip(f"not judged: {late}")
        raise MachineTooBusyError(late) from error


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    forget()
    return (yield from explained(item))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    return (yield from explained(item))
