# SPDX-License-Identifier: MIT
"""What a page may say. Nothing in it is believed: types, ranges and order are looked at here."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from .hub import Hub, Page
from .panel import Panel, PanelError
from .seat import Input, SeatError

MOST_CHARACTERS = 2000
_LONGEST_REASON = 100
_BURST = 200.0
_RATE_HZ = 120.0


class BadTalkError(Exception):
    """Not what our page would say: the connection ends, with this text, which is short and ours."""


class Talk:
    """The conversation with one page."""

    def __init__(self, hub: Hub, page: Page) -> None:
        self._hub = hub
        self._page = page
        self._allowance = _BURST
        self._counted_s = hub.now_s
        self._handlers: dict[str, Callable[[dict[str, Any]], None]] = {
            "drawn": self._drawn,
            "take": lambda _: hub.seat.take(page),
            "leave": lambda _: hub.seat.leave(page, ""),
            "arm": self._arm,
            "disarm": lambda said: hub.seat.disarm(
                page, _text(said, "why", optional=True)[:_LONGEST_REASON]
            ),
            "stop": self._stop,
            "panel": lambda said: self._panel.obey(_text(said, "line")),
            "box": self._box,
            "move": self._move,
            "clear": lambda _: self._panel.clear(),
            "faults": self._faults,
        }

    def hear(self, text: str) -> None:
        """Do what a page says; raises BadTalkError where it is nonsense."""
        self._count()
        said = _parse(text)
        handler = self._handlers.get(str(said.get("type")))
        if handler is None:
            raise BadTalkError("unknown type")
        try:
            handler(said)
        except (SeatError, PanelError) as error:
            if not self._page.say("refused", {"text": str(error), "what": said["type"]}):
                raise BadTalkError("it takes no answers") from None

    def _count(self) -> None:
        now_s = self._hub.now_s
        self._allowance = min(_BURST, self._allowance + _RATE_HZ * (now_s - self._counted_s)) - 1.0
        self._counted_s = now_s
        if self._allowance < 0.0:
            raise BadTalkError("too much")

    def _drawn(self, said: dict[str, Any]) -> None:
        """Take an answer to a picture; the driver's says what the hands did, seeing it."""
        tick, now_s = _tick(said), self._hub.now_s
        self._page.answer(tick, now_s)
        hands = said.get("hands")
        if hands is not None:
            if not isinstance(hands, dict):
                raise BadTalkError("hands is an object")
            self._drive(tick, hands, now_s)

    def _drive(self, tick: int, hands: dict[str, Any], now_s: float) -> None:
        try:
            wanted = Input(
                tick, _number(hands, "forward"), _number(hands, "left"), _number(hands, "scale")
            )
        except ValueError as error:
            raise BadTalkError(str(error)) from None
        # A page that has just given up the seat, or lost it, may not know yet.
        if self._hub.seat.driver is self._page:
            self._hub.seat.drive(self._page, wanted, now_s)

    def _arm(self, said: dict[str, Any]) -> None:
        self._hub.seat.arm(self._page, _tick(said), self._hub.now_s)

    def _stop(self, _said: dict[str, Any]) -> None:
        self._hub.seat.stop(self._page)
        self._hub.note("bad", f"STOP was pressed on page {self._page.number}")

    # ---- the simulator ----

    @property
    def _panel(self) -> Panel:
        if self._hub.panel is None:
            raise PanelError("this is no simulator")
        return self._hub.panel

    def _box(self, said: dict[str, Any]) -> None:
        names = ("x_m", "y_m", "size_x_m", "size_y_m")
        self._panel.add_box(*(_number(said, name) for name in names))

    def _move(self, said: dict[str, Any]) -> None:
        index = said.get("index")
        if not isinstance(index, int):
            raise BadTalkError("index is an integer")
        self._panel.move_box(index, _number(said, "x_m"), _number(said, "y_m"))

    def _faults(self, said: dict[str, Any]) -> None:
        wanted = said.get("faults")
        if not isinstance(wanted, dict):
            raise BadTalkError("faults is an object")
        self._panel.set_faults({name: _number(wanted, name, "a fault") for name in wanted})


def _parse(text: str) -> dict[str, Any]:
    if len(text) > MOST_CHARACTERS:
        raise BadTalkError("too long")
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        raise BadTalkError("not JSON") from None
    if not isinstance(said, dict):
        raise BadTalkError("not an object")
    return said


def _tick(said: dict[str, Any]) -> int:
    tick = said.get("tick")
    if not isinstance(tick, int) or isinstance(tick, bool):
        raise BadTalkError("tick is an integer")
    return tick


def _number(said: dict[str, Any], name: str, what: str = "") -> float:
    value = said.get(name)
    if not isinstance(value, int | float) or isinstance(value, bool) or not abs(value) < 1e9:
        raise BadTalkError(f"{what or name} is a number")
    return float(value)


def _text(said: dict[str, Any], name: str, *, optional: bool = False) -> str:
    value = said.get(name, "" if optional else None)
    if not isinstance(value, str):
        raise BadTalkError(f"{name} is a text")
    return value
