# SPDX-License-Identifier: MIT
"""The keyboard of a terminal as key events, including releases if the terminal reports them."""

from __future__ import annotations

import os
import re
import select
import signal
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Self

from .signals import Signalled

if TYPE_CHECKING:
    from collections.abc import Iterator

Action = Literal["press", "repeat", "release", "blur", "echo"]

# The keyboard protocol that kitty introduced and foot, WezTerm, Ghostty, Konsole and others
# support: distinguish keys (1), report repeats and releases (2), also of letters (8).
_ASK_RELEASES = "\x1b[>11u\x1b[?u"
_END_RELEASES = "\x1b[<u"
_ASK_DEVICE = "\x1b[c"  # every terminal answers this: no need to wait longer for the other answer
_ASK_ECHO = "\x1b[5n"
_FOCUS_ON, _FOCUS_OFF = "\x1b[?1004h", "\x1b[?1004l"
_ANSWER_S = 0.3
_ECHO_S = 0.2

_SEQUENCE = re.compile(rb"\x1b(?:\[([0-9;:?<=>]*)([@-~])|O([A-Z]))")
_LONGEST_SEQUENCE = 32
_ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_ACTIONS: dict[bytes, Action] = {b"2": "repeat", b"3": "release"}
_CTRL = 4
_CTRL_C = "\x03"


@dataclass(frozen=True)
class Key:
    """A key (`up`, `w`, ` `) and what happened to it.

    Two are not keys: `blur`, the window lost the keyboard; `echo`, the line to the terminal works.
    """

    name: str
    action: Action = "press"


class Decoder:
    """Bytes of a terminal in, keys out; incomplete sequences are kept."""

    def __init__(self) -> None:
        self._rest = b""
        self.reports_releases = False
        self.answered = False

    def forget(self) -> None:
        """Drop an incomplete sequence."""
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Key]:
        """Decode these bytes."""
        self._rest += data
        while self._rest:
            match = _SEQUENCE.match(self._rest)
            if match:
                self._rest = self._rest[match.end() :]
                key = self._sequence(*match.groups(default=b""))
                if key is not None:
                    yield key
            elif self._rest[:1] != b"\x1b":
                yield Key(chr(self._rest[0]).lower())
                self._rest = self._rest[1:]
            elif self._may_grow():
                return
            else:
                self._rest = self._rest[2:]  # Alt and a key

    def _may_grow(self) -> bool:
        return self._rest[1:2] in (b"", b"[", b"O") and len(self._rest) < _LONGEST_SEQUENCE

    def _sequence(self, parameters: bytes, final: bytes, arrow: bytes) -> Key | None:
        if final == b"u" and parameters.startswith(b"?"):
            self.reports_releases = int(b"0" + parameters[1:]) & 2 != 0
            return None
        if final == b"c":
            self.answered = True
            return None
        if final in (b"O", b"n"):
            return Key("", "blur" if final == b"O" else "echo")
        code, _, modifiers = parameters.partition(b";")
        modifier, _, event = modifiers.partition(b";")[0].partition(b":")
        action = _ACTIONS.get(event, "press")
        if final == b"u":
            return self._letter(code, modifier, action)
        name = _ARROWS.get(final or arrow)
        return Key(name, action) if name else None

    @staticmethod
    def _letter(code: bytes, modifier: bytes, action: Action) -> Key | None:
        number = code.partition(b":")[0]
        if not number.isdigit() or int(number) > 0x7F:
            return None
        if modifier.isdigit() and (int(modifier) - 1) & _CTRL:
            return Key(_CTRL_C, action) if int(number) == ord("c") else None
        return Key(chr(int(number)).lower(), action)


class Keyboard:
    """The terminal on stdin, switched to deliver each key at once, and restored at the end."""

    def __init__(self) -> None:
        self._decoder = Decoder()
        self._input = sys.stdin.fileno()
        self._early: list[Key] = []
        self._asked_s = 0.0

    def __enter__(self) -> Self:
        import termios
        import tty

        self._before = termios.tcgetattr(self._input)
        tty.setcbreak(self._input)
        self._write(_ASK_RELEASES + _ASK_DEVICE + _FOCUS_ON)
        self._early = list(self._wait_for_answer())
        return self

    def __exit__(self, *_: object) -> None:
        import termios

        self._write(_FOCUS_OFF + _END_RELEASES)
        termios.tcsetattr(self._input, termios.TCSAFLUSH, self._before)

    @property
    def reports_releases(self) -> bool:
        """Whether this terminal reports the release of a key."""
        return self._decoder.reports_releases

    def keys(self, wait_s: float) -> Iterator[Key]:
        """Yield the keys typed; wait at most this long for the first."""
        early, self._early = self._early, []
        yield from early
        yield from self._read(wait_s)

    def _read(self, wait_s: float) -> Iterator[Key]:
        if not select.select([self._input], [], [], wait_s)[0]:
            return
        try:
            data = os.read(self._input, 1024)
        except OSError:
            data = b""
        if not data:
            raise Signalled(signal.SIGHUP)  # the terminal is gone
        yield from self._decoder.feed(data)

    def forget(self) -> None:
        """Drop keys that were typed but not taken yet."""
        import termios

        termios.tcflush(self._input, termios.TCIFLUSH)
        self._decoder.forget()
        self._early = []

    def ask_echo(self, now_s: float) -> None:
        """Make the terminal send an `echo` periodically if releases depend on its line."""
        if self.reports_releases and now_s - self._asked_s >= _ECHO_S:
            self._asked_s = now_s
            self._write(_ASK_ECHO)

    def _wait_for_answer(self) -> Iterator[Key]:
        until = time.monotonic() + _ANSWER_S
        while not self._decoder.answered and (left := until - time.monotonic()) > 0.0:
            yield from self._read(left)

    @staticmethod
    def _write(text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()


def is_ctrl_c(key: Key) -> bool:
    """Return Ctrl-C as a key: a terminal that reports releases does not make it a signal."""
    return key.name == _CTRL_C and key.action == "press"
