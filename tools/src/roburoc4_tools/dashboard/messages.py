# SPDX-License-Identifier: MIT
"""Messages from a page. None is trusted: types, ranges and order are checked here."""

from __future__ import annotations

import asyncio
import json
import threading
from collections.abc import Callable
from typing import Any

from roburoc4.errors import RobotError

from .control import ControlError, Input
from .fleet import Fleet
from .going import Goal
from .hub import Hub, Page
from .panel import Panel, PanelError
from .recorder import RecordError

MOST_CHARACTERS = 2000
_LONGEST_REASON = 100
LONGEST_NAME = 30
FARTHEST_M = 1000.0
MOST_CLEARANCE_M = 5.0
_BURST = 200.0
_RATE_HZ = 120.0


class BadMessageError(Exception):
    """A message that our page would not send: the connection ends, with this short text of ours."""


class Messages:
    """The messages of one page."""

    def __init__(self, fleet: Fleet, hub: Hub, page: Page) -> None:
        self._fleet = fleet
        self._hub = hub
        self._page = page
        self._allowance = _BURST
        self._counted_s = hub.now_s
        self._handlers: dict[str, Callable[[dict[str, Any]], None]] = {
            "drawn": self._drawn,
            "take": lambda _: hub.control.ask(page),
            "relieve": lambda _: hub.relieve(page),
            "name": self._name,
            "keep": self._keep,
            "leave": lambda _: hub.control.leave(page, ""),
            "arm": self._arm,
            "disarm": lambda message: hub.control.disarm(
                page, _text(message, "why", optional=True)[:_LONGEST_REASON]
            ),
            "stop": self._stop,
            "forget_trail": lambda _: hub.forget_trail(),
            "relocalize": self._relocalize,
            "go": self._go,
            "record": lambda _: hub.recorder.start(),
            "record_end": lambda _: hub.recorder.stop(),
            "panel": lambda message: self._panel.obey(_text(message, "line")),
            "box": self._box,
            "move": self._move,
            "clear": lambda _: self._panel.clear(),
            "faults": self._faults,
        }

    def receive(self, text: str) -> None:
        """Do what a message asks for; raises BadMessageError if it is invalid."""
        self._count()
        message = _parse(text)
        handler = self._handlers.get(str(message.get("type")))
        if handler is None:
            raise BadMessageError("unknown type")
        try:
            handler(message)
        except (ControlError, PanelError, RecordError) as error:
            if message["type"] == "go":
                self._hub.note("weak", f"going to a place was refused: {error}")
            if not self._refuse(str(error), str(message["type"])):
                raise BadMessageError("its outbox is full") from None

    def _refuse(self, text: str, what: str) -> bool:
        return self._page.send("refused", {"text": text, "what": what})

    def end(self) -> None:
        """Remove the page at once: it sent something that our page never sends."""
        self._hub.part(self._page)

    def _count(self) -> None:
        now_s = self._hub.now_s
        self._allowance = min(_BURST, self._allowance + _RATE_HZ * (now_s - self._counted_s)) - 1.0
        self._counted_s = now_s
        if self._allowance < 0.0:
            raise BadMessageError("too much")

    def _drawn(self, message: dict[str, Any]) -> None:
        """Record that a frame was drawn; the driver's page adds its inputs at that moment."""
        tick, now_s = _tick(message), self._hub.now_s
        self._page.answer(tick, now_s)
        inputs = message.get("input")
        if inputs is not None:
            if not isinstance(inputs, dict):
                raise BadMessageError("input is an object")
            self._drive(tick, inputs, now_s)

    def _drive(self, tick: int, inputs: dict[str, Any], now_s: float) -> None:
        try:
            wanted = Input(
                tick,
                _number(inputs, "forward"),
                _number(inputs, "left"),
                _number(inputs, "scale"),
                inputs.get("going") is True,
            )
        except ValueError as error:
            raise BadMessageError(str(error)) from None
        # A page that has just released or lost control may not know that yet.
        if self._hub.control.driver is self._page:
            self._hub.control.drive(self._page, wanted, now_s)

    def _arm(self, message: dict[str, Any]) -> None:
        if self._hub.recorded:
            raise ControlError("a recording is replayed: nothing can be driven")
        self._hub.control.arm(self._page, _tick(message), self._hub.now_s)

    def _keep(self, _message: dict[str, Any]) -> None:
        asker = self._hub.control.keep(self._page)
        if isinstance(asker, Page):
            text = f"{self._page.name} keeps control"
            asker.send("refused", {"text": text, "what": "take"})

    def _name(self, message: dict[str, Any]) -> None:
        name = " ".join(_text(message, "name").split())
        if not (0 < len(name) <= LONGEST_NAME and name.isprintable()):
            raise BadMessageError(f"a name has 1 to {LONGEST_NAME} characters")
        self._fleet.rename(self._page, name)

    def _stop(self, _message: dict[str, Any]) -> None:
        self._fleet.stop(self._page)
        if not self._page.send("stopped", {}):
            raise BadMessageError("its outbox is full")

    def _go(self, message: dict[str, Any]) -> None:
        goal = Goal(*(_number(message, name) for name in ("x_m", "y_m", "scale")))
        if message.get("clearance_m") is not None:
            goal = goal._replace(clearance_m=_number(message, "clearance_m"))
        if not 0.0 < goal.scale <= 1.0:
            raise BadMessageError("scale is above 0 and up to 1")
        if max(abs(goal.x_m), abs(goal.y_m)) > FARTHEST_M:
            raise ControlError(f"x and y are at most {FARTHEST_M:g} m")
        if not 0.0 <= (goal.clearance_m or 0.0) <= MOST_CLEARANCE_M:
            raise ControlError(f"the clearance is 0 to {MOST_CLEARANCE_M:g} m")
        self._hub.control.go(self._page, _tick(message), goal, self._hub.now_s)

    def _relocalize(self, message: dict[str, Any]) -> None:
        pose = [_number(message, name) for name in ("x_m", "y_m", "theta_rad")]
        self._hub.control.check_driver(self._page)
        loop = asyncio.get_running_loop()

        def relocalize() -> None:
            try:
                self._hub.robot.relocalize(*pose)
            except RobotError as error:
                loop.call_soon_threadsafe(self._refuse, str(error), "relocalize")

        # It waits for the robot's answer.
        threading.Thread(target=relocalize, daemon=True).start()

    # ---- the simulator ----

    @property
    def _panel(self) -> Panel:
        if self._hub.panel is None:
            raise PanelError("this is not a simulator")
        return self._hub.panel

    def _box(self, message: dict[str, Any]) -> None:
        names = ("x_m", "y_m", "size_x_m", "size_y_m")
        self._panel.add_box(*(_number(message, name) for name in names))

    def _move(self, message: dict[str, Any]) -> None:
        index = message.get("index")
        if not isinstance(index, int):
            raise BadMessageError("index is an integer")
        self._panel.move_box(index, _number(message, "x_m"), _number(message, "y_m"))

    def _faults(self, message: dict[str, Any]) -> None:
        wanted = message.get("faults")
        if not isinstance(wanted, dict):
            raise BadMessageError("faults is an object")
        self._panel.set_faults({name: _number(wanted, name, "a fault") for name in wanted})


def _parse(text: str) -> dict[str, Any]:
    if len(text) > MOST_CHARACTERS:
        raise BadMessageError("too long")
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        raise BadMessageError("not JSON") from None
    if not isinstance(message, dict):
        raise BadMessageError("not an object")
    return message


def _tick(message: dict[str, Any]) -> int:
    tick = message.get("tick")
    if not isinstance(tick, int) or isinstance(tick, bool):
        raise BadMessageError("tick is an integer")
    return tick


def _number(message: dict[str, Any], name: str, what: str = "") -> float:
    value = message.get(name)
    if not isinstance(value, int | float) or isinstance(value, bool) or not abs(value) < 1e9:
        raise BadMessageError(f"{what or name} is a number")
    return float(value)


def _text(message: dict[str, Any], name: str, *, optional: bool = False) -> str:
    value = message.get(name, "" if optional else None)
    if not isinstance(value, str):
        raise BadMessageError(f"{name} is a text")
    return value
