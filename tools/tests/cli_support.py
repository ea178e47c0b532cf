# SPDX-License-Identifier: MIT
"""Real processes for the tests of the command: `roburoc4`, and a robot for it to talk to."""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from robot_support import LONG_S
from strain import watch_session

import roburoc4

FOLDER = Path(sys.executable).parent
COMMAND = str(FOLDER / "roburoc4")
ALONE = "127.0.0.2"
"""Host of a robot that nobody else asks: its port may have been that of another test's."""
_BUSY = {"jitter": "ms early or late", "slow": "an answer takes"}
_STYLES = re.compile(r"\x1b\[[0-9;]*m")


def environment(robot: str | None = None) -> dict[str, str]:
    """The environment of a user's shell, with or without a robot."""
    env = {name: value for name, value in os.environ.items() if name != "ROBUROC4_ROBOT"}
    if robot is not None:
        env["ROBUROC4_ROBOT"] = robot
    return env | {"COLUMNS": "120"}


def run(*arguments: str, robot: str | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, without a terminal."""
    return subprocess.run(
        [COMMAND, *arguments],
        env=environment(robot),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )


def start(*arguments: str, robot: str | None = None) -> subprocess.Popen[str]:
    """Start a command that a test will end."""
    return subprocess.Popen(
        [COMMAND, *arguments],
        env=environment(robot),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def document(done: subprocess.CompletedProcess[str]) -> Any:
    """Read the JSON of a command that went well."""
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def one_line(text: str) -> str:
    """Check that this is an error message of one line, and return it."""
    assert text.startswith("roburoc4: "), text
    assert text.count("\n") == 1, text
    assert text.endswith("\n"), text
    return text


def last_command_is_zero(sim: roburoc4.Simulator) -> bool:
    """Whether the last speed command that the robot got was a zero."""
    state = sim.state
    return (state.last_linear_m_s, state.last_angular_rad_s) == (0.0, 0.0)


def doctor(
    *arguments: str, robot: str, verdict: str | None = None
) -> subprocess.CompletedProcess[str]:
    """Run `roburoc4 doctor`; again, while this computer is too busy for a verdict.

    Statuses and answers then come late, whatever else is wrong with the link. A `verdict` that is
    expected about time itself is not tried again.
    """
    for _ in range(10):
        done = run("doctor", *arguments, robot=robot)
        found = {name for name, text in _BUSY.items() if text in done.stdout}
        if not found or verdict in found:
            break
    return done


class Terminal:
    """A command in a terminal of its own."""

    def __init__(self, *arguments: str, robot: str | None = None) -> None:
        self.text = ""
        self._typed_s = 0.0
        pid, self._fd = pty.fork()
        if pid == 0:
            watch_session()
            env = environment(robot) | {"TERM": "xterm-256color"}
            os.execvpe(COMMAND, [COMMAND, *arguments], env)
        self._pid = pid

    def type(self, keys: str) -> None:
        """Press keys."""
        os.write(self._fd, keys.encode())

    def read(self, wait_s: float) -> bool:
        """Read what the terminal shows; False at its end."""
        if not select.select([self._fd], [], [], wait_s)[0]:
            return True
        try:
            data = os.read(self._fd, 65536)
        except OSError:  # how Linux tells the end
            return False
        self.text += _STYLES.sub("", data.decode(errors="replace"))
        return bool(data)

    def _type_again(self, keys: str) -> None:
        """Press keys once a second: a program that stalled drops those that waited."""
        if keys and time.monotonic() - self._typed_s >= 1.0:
            self._typed_s = time.monotonic()
            self.type(keys)

    def wait_for(self, pattern: str, within_s: float = LONG_S, keys: str = "") -> None:
        """Wait until this is shown, and press keys meanwhile."""
        until_s = time.monotonic() + within_s
        while not re.search(pattern, self.text):
            self._type_again(keys)
            assert time.monotonic() < until_s, f"no {pattern!r} in {self.text[-2000:]!r}"
            assert self.read(0.05), f"ended without {pattern!r}: {self.text[-2000:]!r}"

    def send_signal(self, number: signal.Signals) -> None:
        """Send a signal to the command."""
        os.kill(self._pid, number)

    def wait(self, keys: str = "") -> int:
        """Wait for its end, and press keys meanwhile; return its exit code."""
        until_s = time.monotonic() + LONG_S
        while self.read(0.05):
            self._type_again(keys)
            assert time.monotonic() < until_s, self.text[-2000:]
        os.close(self._fd)
        return os.waitstatus_to_exitcode(os.waitpid(self._pid, 0)[1])
