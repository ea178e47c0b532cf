# SPDX-License-Identifier: MIT
"""A failure on a machine that was too busy is known as that."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
import strain
from robot_support import until


def _judged() -> type[BaseException]:
    """What a failure of a test would be reported as now."""
    try:
        explained = strain.explained()
        next(explained)
        explained.throw(AssertionError())
    except (AssertionError, strain.MachineTooBusyError) as error:
        return type(error)
    pytest.fail("the failure is lost")


def test_a_session_that_is_not_run_explains_a_failure() -> None:
    process = subprocess.Popen(
        ["sleep", "100"], start_new_session=True, preexec_fn=strain.watch_session
    )
    napper = int(Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text())
    os.kill(napper, signal.SIGSTOP)
    time.sleep(0.5)
    os.kill(napper, signal.SIGCONT)
    until(lambda: _judged() is strain.MachineTooBusyError)
    process.kill()
    process.wait()


def test_a_machine_that_runs_in_time_explains_nothing() -> None:
    def quiet() -> bool:
        strain.forget()
        return _judged() is AssertionError

    until(quiet)
