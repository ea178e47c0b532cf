# SPDX-License-Identifier: MIT
"""Debian's Firefox, by WebDriver BiDi: Playwright needs a Firefox of its own."""

import itertools
import json
import os
import re
import subprocess
import tempfile
import threading
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from station import FAKE_PAD, PATIENCE_S, REPEATS, until
from websockets.sync.client import ClientConnection, connect

FIREFOX = os.environ.get("FIREFOX", "/usr/bin/firefox-esr")
_PREFERENCES = """
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("app.update.enabled", false);
user_pref("dom.w3c_touch_events.enabled", 1);
"""


class Firefox:
    """A browser with tabs."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="firefox-")
        Path(self._folder.name, "user.js").write_text(_PREFERENCES, encoding="utf-8")
        self._running = subprocess.Popen(
            [FIREFOX, "--headless", "--remote-debugging-port=0", "--profile", self._folder.name],
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            env=os.environ | {"HOME": self._folder.name, "MOZ_DISABLE_CONTENT_SANDBOX": "1"},
            text=True,
        )
        assert self._running.stderr is not None
        link = next(
            found[1]
            for line in self._running.stderr
            if (found := re.search(r"BiDi listening on (ws://\S+)", line))
        )
        threading.Thread(target=self._running.stderr.read, daemon=True).start()
        self._numbers = itertools.count(1)
        connecting = connect(f"{link}/session", open_timeout=PATIENCE_S, max_size=None)
        self._socket: ClientConnection = connecting.__enter__()
        self.complaints: list[str] = []
        self.send("session.new", capabilities={})
        self.send("session.subscribe", events=["log.entryAdded"])
        self.send(
            "script.addPreloadScript", functionDeclaration=f"() => {{ {FAKE_PAD + REPEATS} }}"
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._socket.close()
        self._running.terminate()
        self._running.wait(PATIENCE_S)
        self._folder.cleanup()

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Command, and wait for the answer."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=PATIENCE_S))
            if message.get("method") == "log.entryAdded":
                entry = message["params"]
                if entry["level"] == "error":
                    self.complaints.append(entry["text"])
            if message.get("id") == number:
                assert message["type"] == "success", message
                result: dict[str, Any] = message["result"]
                return result

    def open(self, url: str, width: int = 1280, height: int = 800) -> "Tab":
        """Open a tab in front of the others."""
        tab = Tab(self, self.send("browsingContext.create", type="tab")["context"])
        tab.send("browsingContext.setViewport", viewport={"width": width, "height": height})
        tab.send("browsingContext.navigate", url=url, wait="complete")
        return tab


class Tab:
    """A page."""

    def __init__(self, browser: Firefox, context: str) -> None:
        self._browser = browser
        self._context = context

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Command something of this tab."""
        return self._browser.send(method, context=self._context, **parameters)

    def evaluate(self, expression: str) -> Any:
        """Return what a script gives: a text, a number, or whether."""
        answer = self._browser.send(
            "script.evaluate",
            expression=expression,
            target={"context": self._context},
            awaitPromise=True,
        )
        assert answer["type"] == "success", answer
        return answer["result"].get("value")

    def text(self, name: str) -> str:
        """Return the text of an element by its id."""
        return str(self.evaluate(f"document.getElementById({name!r}).textContent"))

    def wait_for(self, name: str, text: str) -> None:
        """Wait until an element has this text in it."""
        until(lambda: text in self.text(name))

    def middle(self, name: str) -> tuple[int, int]:
        """Return the middle of an element."""
        box = f"document.getElementById({name!r}).getBoundingClientRect()"
        x = self.evaluate(f"Math.round({box}.x + {box}.width / 2)")
        return x, self.evaluate(f"Math.round({box}.y + {box}.height / 2)")

    def _act(self, kind: str, actions: list[dict[str, Any]], **settings: Any) -> None:
        devices = [{"type": kind, "id": f"{kind}{settings}", "actions": actions, **settings}]
        self.send("input.performActions", actions=devices)

    def key(self, action: str, key: str) -> None:
        """Press ("keyDown") or release ("keyUp") a key."""
        self._act("key", [{"type": action, "value": key}])

    def pointer(self, kind: str, *actions: tuple[str, tuple[int, int]]) -> None:
        """Move, press and release "mouse" or "touch"."""
        steps: list[dict[str, Any]] = []
        for name, (x, y) in actions:
            if name != "pointerUp":
                steps.append({"type": "pointerMove", "x": x, "y": y})
            if name != "pointerMove":
                steps.append({"type": name, "button": 0})
        self._act("pointer", steps, parameters={"pointerType": kind})

    def click(self, name: str, kind: str = "mouse") -> None:
        """Press an element and release it."""
        at = self.middle(name)
        self.pointer(kind, ("pointerDown", at), ("pointerUp", at))

    def arm(self) -> None:
        """Take control and arm."""
        self.wait_for("quality-say", "Link good")
        self.click("take")
        self.wait_for("control", "this page")
        until(lambda: "Ready:" in self.text("drive-why") or self._press_arm())

    def _press_arm(self) -> bool:
        if self.evaluate("!document.getElementById('arm').hidden"):
            self.click("arm")
        return False
