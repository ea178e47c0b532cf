# SPDX-License-Identifier: MIT
"""The real world: UDP sockets, a clock, and people at a terminal."""

from __future__ import annotations

import select
import socket
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from ..terminal.deadman import DeadMan
from ..terminal.keyboard import is_ctrl_c
from .world import Datagram, World

if TYPE_CHECKING:
    from ..terminal.keyboard import Keyboard

_LONGEST = 2048
_TICK_S = 0.002
HOLD = " "


class TerminalWorld(World):
    """A robot at an address, and a keyboard whose space bar lets it move."""

    def __init__(self, host: str, port: int, keyboard: Keyboard) -> None:
        self._robot = (host, port)
        self._keyboard = keyboard
        self._dead_man = DeadMan(keyboard.reports_releases)
        self._sockets: dict[int, socket.socket] = {}
        self._local: dict[int, int] = {}
        self._early: list[Datagram] = []
        self._interrupted = False
        self._typed = ""
        self._count: list[tuple[float, str]] = []

    @property
    def now_s(self) -> float:
        """Return the time of the monotonic clock."""
        return time.monotonic()

    def send(self, port: int, data: bytes) -> None:
        """Send at once, or drop it."""
        if port not in self._sockets:
            self.reopen(port)
        with suppress(OSError):  # what cannot be sent at once is dropped
            self._sockets[port].sendto(data, self._robot)

    def close(self, port: int) -> None:
        """Close a port."""
        self._sockets.pop(port).close()

    def reopen(self, port: int) -> None:
        """Bind it again."""
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.setblocking(False)
        opened.bind(("", self._local.get(port, 0)))
        self._local[port] = opened.getsockname()[1]
        self._sockets[port] = opened

    def wait(self, seconds: float) -> list[Datagram]:
        """Let time pass; return what arrived."""
        end_s = self.now_s + seconds
        while (left_s := end_s - self.now_s) > 0:
            select.select(list(self._sockets.values()), [], [], min(left_s, _TICK_S))
            self._look()
        heard, self._early = self._early, []
        return heard

    def _look(self) -> None:
        """Take what is there: datagrams, keys until one interrupts, and the time of a countdown."""
        for port, opened in self._sockets.items():
            with suppress(BlockingIOError, ConnectionError):
                while True:
                    data, sender = opened.recvfrom(_LONGEST)
                    if sender[0] == self._robot[0]:
                        other = sender[1] != self._robot[1]
                        self._early.append(Datagram(self.now_s, port, data, other))
        if not self._interrupted:
            self._interrupted = True  # unless the keys are taken without an exception
            self._take_keys()
            self._interrupted = False
        while self._count and self._count[0][0] <= self.now_s:
            self.say(self._count.pop(0)[1])

    def _take_keys(self) -> None:
        self._keyboard.ask_echo(self.now_s)
        for key in self._keyboard.keys(0.0):
            if is_ctrl_c(key):
                raise KeyboardInterrupt
            self._dead_man.feed(key, self.now_s)
            if key.action == "press" and len(key.name) == 1:
                self._typed += key.name

    def say(self, text: str) -> None:
        """Print a line for the people."""
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def _line(self) -> str:
        """Return the next line that is typed; the robot is heard meanwhile."""
        self._count.clear()  # what ended early, such as by letting the key go
        self._typed = ""
        while not {"\n", "\r"} & set(self._typed):
            select.select(list(self._sockets.values()), [], [], _TICK_S)
            self._look()
        line = self._typed.replace("\r", "\n").partition("\n")[0]
        self._typed = ""
        self._dead_man.let_go()
        return line.strip()

    def please(self, key: str, text: str) -> None:
        """Ask, and wait for Enter."""
        self.say(f"  {text} Then press Enter.")
        self._line()

    def ask(self, key: str, text: str) -> str:
        """Ask, and wait for a line."""
        self.say(f"  {text} (Type it, then press Enter.)")
        while not (answer := self._line()):
            pass
        return answer

    def countdown(self, key: str, text: str, seconds: float) -> None:
        """Begin to count; wait() goes on with it."""
        self.say(f"  {text}")
        zero_s = self.now_s + seconds
        whole = int(seconds / 0.5)
        self._count = [(zero_s - 0.5 * k, f"  {k}") for k in range(whole, 0, -1)]
        self._count.append((zero_s, "  0 - now"))

    def hold(self, text: str) -> None:
        """Wait until the space bar is pressed anew."""
        if self.held():
            self.say("  Let the space bar go first.")
            self._until_held(False)
        self.say(f"  {text}")
        self._until_held(True)

    def _until_held(self, wanted: bool) -> None:
        while self.held() != wanted:
            select.select(list(self._sockets.values()), [], [], _TICK_S)

    def held(self) -> bool:
        """Return whether the space bar is held now."""
        self._look()
        return not self._interrupted and HOLD in self._dead_man.held(self.now_s)
