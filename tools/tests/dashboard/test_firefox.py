# SPDX-License-Identifier: MIT
"""Fingers in Firefox, by WebDriver BiDi: there, a tap of Playwright does nothing at all."""

import itertools
import json
import os
import re
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from station import FIREFOX, LEASE_S, PATIENCE_S, Station, until
from websockets.sync.client import ClientConnection, connect

WITHIN_S = LEASE_S + 0.4


class Tab:
    """A page in Firefox."""

    def __init__(self, socket: ClientConnection, url: str) -> None:
        self._socket = socket
        self._numbers = itertools.count(1)
        self.send("session.new", capabilities={})
        self._context = self.send("browsingContext.create", type="tab")["context"]
        self._here = {"context": self._context}
        size = {"width": 390, "height": 844}
        self.send("browsingContext.setViewport", **self._here, viewport=size)
        self.send("browsingContext.navigate", **self._here, url=url, wait="complete")

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command, and wait for the answer."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while (answer := json.loads(self._socket.recv(timeout=PATIENCE_S))).get("id") != number:
            pass
        assert answer["type"] == "success", answer
        result: dict[str, Any] = answer["result"]
        return result

    def evaluate(self, expression: str) -> Any:
        """Return the value of a script."""
        answer = self.send(
            "script.evaluate", expression=expression, target=self._here, awaitPromise=False
        )
        return answer["result"].get("value")

    def text(self, name: str) -> str:
        """Return the text of an element."""
        return str(self.evaluate(f"document.getElementById({name!r}).textContent"))

    def middle(self, name: str) -> tuple[int, int]:
        """Return the middle of an element."""
        box = f"document.getElementById({name!r}).getBoundingClientRect()"
        x = self.evaluate(f"Math.round({box}.x + {box}.width / 2)")
        return x, self.evaluate(f"Math.round({box}.y + {box}.height / 2)")

    def touch(self, *actions: dict[str, Any], finger: str = "first") -> None:
        """Touch, drag and lift."""
        pointer = {"type": "pointer", "id": finger, "parameters": {"pointerType": "touch"}}
        self.send("input.performActions", **self._here, actions=[pointer | {"actions": actions}])

    def press(self, name: str, *, finger: str = "first") -> None:
        """Touch an element."""
        self.touch(move(*self.middle(name)), DOWN, finger=finger)

    def tap(self, name: str) -> None:
        """Touch an element, and lift."""
        self.press(name)
        self.touch(UP)


DOWN, UP = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}


def move(x: int, y: int) -> dict[str, Any]:
    return {"type": "pointerMove", "x": x, "y": y}


@pytest.fixture
def here(station: Callable[..., Station]) -> Station:
    return station()


@pytest.fixture
def tab(here: Station, tmp_path: Path) -> Iterator[Tab]:
    """The dashboard's page in a Firefox that has just been started."""
    command = [FIREFOX, "--headless", "--remote-debugging-port=0", "--profile", str(tmp_path)]
    running = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        env=os.environ | {"HOME": str(tmp_path), "MOZ_DISABLE_CONTENT_SANDBOX": "1"},
        text=True,
    )
    try:
        assert running.stderr is not None
        lines = (re.search(r"BiDi listening on (ws://\S+)", line) for line in running.stderr)
        link = next(found[1] for found in lines if found)
        threading.Thread(target=running.stderr.read, daemon=True).start()
        with connect(f"{link}/session", open_timeout=PATIENCE_S, max_size=None) as socket:
            yield Tab(socket, here.url)
    finally:
        running.terminate()
        running.wait(PATIENCE_S)


def arm(tab: Tab) -> None:
    end = time.monotonic() + PATIENCE_S
    while "Ready:" not in tab.text("drive-why"):
        assert time.monotonic() < end, tab.text("drive-why")
        if not tab.evaluate("document.getElementById('arm').hidden"):
            tab.tap("arm")
        time.sleep(0.3)


def drive_by_stick(here: Station, tab: Tab) -> None:
    """Take control, arm, and push the stick ahead until the robot keeps driving."""
    until(lambda: tab.text("quality-say") == "Link good")
    tab.tap("take")
    until(lambda: "this page" in tab.text("control"))
    arm(tab)
    x, y = tab.middle("stick")
    tab.touch(move(x, y), DOWN, move(x, y - 40))
    end = time.monotonic() + 3 * PATIENCE_S
    while not here.drives_on():  # a stall of a loaded machine ended it
        assert time.monotonic() < end, tab.text("drive-why")
        tab.touch(UP)
        time.sleep(LEASE_S)
        arm(tab)
        tab.touch(move(x, y), DOWN, move(x, y - 40))


def test_the_stick_drives_by_touch(here: Station, tab: Tab) -> None:
    drive_by_stick(here, tab)
    assert here.sim.state.last_linear_m_s > 0
    tab.touch(UP)
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S


def test_a_second_finger_stops_in_firefox(here: Station, tab: Tab) -> None:
    drive_by_stick(here, tab)
    tab.press("stop", finger="second")
    here.wait_for_stop_pressed()
