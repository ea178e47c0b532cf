# SPDX-License-Identifier: MIT
"""A page without a browser, which sends whatever a test wants, and a proxy that can stall."""

import json
import select
import socket
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from station import PATIENCE_S, Station
from websockets.sync.client import ClientConnection, connect


class Visitor:
    """A WebSocket that answers frames when a test tells it to."""

    def __init__(
        self,
        station: Station | None = None,
        *,
        port: int = 0,
        path: str = "/socket",
        **settings: Any,
    ) -> None:
        port = station.port if station and not port else port
        settings = {"origin": f"http://127.0.0.1:{port}"} | settings
        connecting = connect(f"ws://127.0.0.1:{port}{path}", open_timeout=PATIENCE_S, **settings)
        self.socket: ClientConnection = connecting.__enter__()
        self.tick = 0
        self.frame: dict[str, Any] = {}
        self.refusals: list[str] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.socket.close()

    def say(self, kind: str, **rest: Any) -> None:
        self.socket.send(json.dumps({"type": kind, **rest}))

    def receive(self) -> dict[str, Any]:
        """Wait for the next message."""
        message: dict[str, Any] = json.loads(self.socket.recv(timeout=PATIENCE_S))
        if message["type"] == "frame":
            self.frame, self.tick = message, message["tick"]
        if message["type"] == "refused":
            self.refusals.append(message["text"])
        return message

    def draw(self, forward: float | None = None, **inputs: float) -> None:
        """Wait for a frame, and answer it."""
        while self.receive()["type"] != "frame":
            pass
        self.answer(self.tick, forward, **inputs)

    def answer(self, tick: int, forward: float | None, **inputs: float) -> None:
        """Answer the frame of a tick."""
        if forward is None:
            self.say("drawn", tick=tick)
        else:
            given = {"forward": forward, "left": 0.0, "scale": 1.0} | inputs
            self.say("drawn", tick=tick, input=given)

    def draw_for(self, seconds: float, forward: float | None = None) -> None:
        """Answer frames for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.draw(forward)

    def drive(self, driven: Callable[[], bool], forward: float = 0.4) -> None:
        """Drive. Where a stall of this machine ends that, release all inputs and try again."""
        end = time.monotonic() + PATIENCE_S
        while not driven():
            assert time.monotonic() < end, self.frame["why"]
            if not self.frame["facts"]["armed"]:
                self.arm()
            self.draw_for(0.2, 0.0)
            self.draw_for(0.5, forward)

    def arm(self) -> None:
        """Take control and arm, inputs off."""
        end = time.monotonic() + PATIENCE_S
        self.say("take")
        while not self.frame.get("facts", {}).get("armed"):
            assert time.monotonic() < end, self.refusals
            self.draw(0.0)
            self.say("arm", tick=self.tick)
        self.draw_for(0.2, 0.0)


class Proxy:
    """Carries bytes between page and dashboard, until it stalls; then it keeps them for later."""

    def __init__(self) -> None:
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listening.getsockname()[1]
        self.flows = threading.Event()
        self.flows.set()
        self.connections = 0
        self._dead: list[threading.Event] = []
        self._to = 0
        self._ended = False
        self._threads: list[threading.Thread] = []

    def serve(self, port: int) -> None:
        """Begin to forward to this port."""
        self._to = port
        self._start(self._accept)

    def _start(self, target: Any, *arguments: Any) -> None:
        thread = threading.Thread(target=target, args=arguments, daemon=True)
        self._threads.append(thread)
        thread.start()

    def kill(self) -> None:
        """Carry nothing more on the connections that are open; new ones work."""
        self._dead.append(self.flows)
        self.flows.clear()
        self.flows = threading.Event()
        self.flows.set()

    def _accept(self) -> None:
        while not self._ended:
            if select.select([self._listening], [], [], 0.05)[0]:
                near = self._listening.accept()[0]
                far = socket.create_connection(("127.0.0.1", self._to))
                self._start(self._carry, near, far, self.flows)
                self._start(self._carry, far, near, self.flows)
                self.connections += 1

    def _carry(self, source: socket.socket, sink: socket.socket, flows: threading.Event) -> None:
        try:
            while not self._ended:
                if not select.select([source], [], [], 0.05)[0]:
                    continue
                flows.wait()
                data = source.recv(65536)
                flows.wait()
                if not data:
                    break
                sink.sendall(data)
        except (OSError, ValueError):  # the other direction has ended it
            pass
        finally:
            source.close()
            sink.close()

    def close(self) -> None:
        self._ended = True
        for flows in (*self._dead, self.flows):
            flows.set()
        for thread in self._threads:
            thread.join(PATIENCE_S)
        self._listening.close()
