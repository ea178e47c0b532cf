# SPDX-License-Identifier: MIT
"""A program as its users start it."""

import os
import signal
import subprocess
from pathlib import Path

from .waiting import until

# Where the tests run in the background or with nohup, these are ignored, and would be by programs.
_AS_IN_A_TERMINAL = ("env", "--default-signal=INT,HUP")


class Program:
    """A running program; its output goes to a file, so that no pipe can block it."""

    def __init__(self, log: Path, *command: str | Path, environment: dict[str, str] | None = None):
        self.command = [str(part) for part in command]
        self.log = log
        with log.open("wb") as output:
            self.process = subprocess.Popen(
                [*_AS_IN_A_TERMINAL, *self.command],
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **(environment or {})},
            )

    @property
    def output(self) -> str:
        return self.log.read_text(errors="replace")

    @property
    def running(self) -> bool:
        return self.process.poll() is None

    def signal(self, number: signal.Signals) -> None:
        self.process.send_signal(number)

    def says(self, text: str, seconds: float = 10.0) -> None:
        """Wait until it has said so."""

        def said() -> bool:
            assert text in self.output or self.running, (
                f"{self.command} ended with {self.process.returncode}, "
                f"without saying {text!r}:\n{self.output}"
            )
            return text in self.output

        until(said, f"{self.command[0]} says {text!r}", seconds)

    def ends(self, seconds: float = 10.0) -> int:
        """Wait for the end; the exit status, negative for a signal."""
        return self.process.wait(seconds)

    def end(self) -> None:
        """End it, however it feels about that."""
        if self.running:
            self.process.send_signal(signal.SIGCONT)
            self.process.terminate()
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self.process.stdin is not None:
            self.process.stdin.close()
