# SPDX-License-Identifier: MIT
"""The open pages, and the clock by which they get new frames.

A page answers each frame that it has drawn, and gets no new one while several answers are missing.
So nothing queues up for a slow page, no page gets more frames than its screen shows, and hidden
pages, which draw nothing, cost next to nothing.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from roburoc4 import __version__
from roburoc4.robot import Robot

from .camera import Camera
from .control import Control, Viewer, limits_of
from .frames import Frames
from .going import ENDED, Going
from .history import History, Notice
from .panel import Panel
from .recorder import Recorder
from .ticks import Ticks

FRAME_S = 1 / 30
IDLE_S = 0.2
"""Time between steps while no page draws: for history and events."""
_AWAKE_S = 1.0
"""A page that has drawn nothing for this long is hidden, or frozen."""
MOST_PAGES = 32
_UNANSWERED = 3


def encode(document: object) -> str:
    """Make compact JSON; NaN would be our own mistake."""
    return json.dumps(document, separators=(",", ":"), allow_nan=False)


class Page(Viewer):
    """An open page, and the frames that it has not drawn yet."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.outbox: asyncio.Queue[str] = asyncio.Queue(maxsize=64)
        self.seen_event = 0
        self._owed: list[int] = []

    @property
    def ready(self) -> bool:
        """Whether it may get another frame."""
        return len(self._owed) < _UNANSWERED and self.outbox.qsize() < _UNANSWERED

    def draws(self, now_s: float) -> bool:
        """Whether it draws what it gets, as far as is known."""
        return self.ready or now_s - self.heard_s < _AWAKE_S

    def send(self, kind: str, document: dict[str, Any]) -> bool:
        """Send it anything but a frame; false if it accepts nothing any more."""
        if self.outbox.full():
            return False
        self.outbox.put_nowait(encode({"type": kind, **document}))
        return True

    def show(self, tick: int, text: str) -> None:
        """Send it a frame."""
        self.sent_tick = tick
        self._owed.append(tick)
        self.outbox.put_nowait(text)

    def answer(self, tick: int, now_s: float) -> None:
        """Note that it has drawn the frame with this tick."""
        if tick in self._owed:
            self._owed = [owed for owed in self._owed if owed > tick]
            self.heard_s = now_s


class Hub:
    """One robot, and the pages that show it."""

    def __init__(
        self,
        robot: Robot,
        lease_s: float,
        ceilings: tuple[float, float],
        *,
        enable_drive: bool,
        panel: Panel | None = None,
        name: str = "",
        cameras: Sequence[Camera] = (),
    ) -> None:
        self.robot = robot
        self.panel = panel
        self.name = name
        self.cameras = tuple(cameras)
        self.recorder = Recorder(robot)
        self.numbers: Iterator[int] = itertools.count(1)
        self.look_around: Callable[[], list[dict[str, Any]]] = list
        """Returns all robots in short, if there are several."""
        self.ticks = Ticks()
        self.control = Control(robot, self.ticks, lease_s, offered=enable_drive)
        self.pages: set[Page] = set()
        self.failure: BaseException | None = None
        """Why no more frames are made."""
        self._ceilings = ceilings
        self._history = History()
        self._frames = Frames(robot, self._history)
        self._latest: dict[str, Any] = {}
        self._driver: Viewer | None = None
        self._under_way: list[tuple[str, Going]] = []

    @property
    def now_s(self) -> float:
        """Time on the robot object's clock, on which leases run."""
        return self.robot.now_s

    # ---- pages ----

    def join(self) -> Page:
        """Add a page, and send everything that it needs at first."""
        page = Page(next(self.numbers))
        page.sent_tick = self.ticks.last
        page.heard_s = self.now_s
        page.seen_event = self._history.last_event
        page.send("hello", self._hello(page))
        if self._frames.known:
            page.send("about", self._about())
        self.pages.add(page)
        return page

    def path_of_recording(self, form: str) -> str | None:
        """Return the path of a recording: all datagrams since the start, or the button's."""
        if form != "pcapng":
            return self.recorder.path(form)
        capture = self.robot.recorder
        return None if capture is None else capture.path

    def part(self, page: Page) -> None:
        """Remove a page; if it drove, the robot is stopped."""
        self.pages.discard(page)
        self.control.leave(page, "the driver's page was closed, or its connection broke")

    def _hello(self, page: Page) -> dict[str, Any]:
        history = self._history
        return {
            "page": page.number,
            "version": __version__,
            "address": self.robot.address,
            "name": self.name,
            "captured": self.robot.recorder is not None,
            "cameras": [{"name": camera.name} for camera in self.cameras],
            "enable_drive": self.control.offered,
            "simulated": self.panel is not None,
            "speeds": history.speeds.columns(),
            "battery": history.battery.columns(),
            "path": history.path.columns(),
            "events": [notice._asdict() for notice in history.events],
        }

    def _about(self) -> dict[str, Any]:
        limits = self.control.limits
        return {
            **self._frames.known,
            "full_linear_m_s": limits.linear_m_s,
            "full_angular_rad_s": limits.angular_rad_s,
        }

    # ---- steps ----

    async def beat(self) -> None:
        """Read the robot and show it, repeatedly."""
        loop = asyncio.get_running_loop()
        due_s = loop.time()
        while True:
            self.step()
            now_s = self.now_s
            pause_s = FRAME_S if any(page.draws(now_s) for page in self.pages) else IDLE_S
            due_s = max(due_s + pause_s, loop.time())
            await asyncio.sleep(due_s - loop.time())

    def step(self) -> None:
        """Read the robot once, and send frames."""
        now_s, time_s = self.now_s, time.time()
        self.control.watch(now_s)
        frame = self._frames.take(now_s, time_s)
        self._latest = frame
        self.recorder.step()
        self._note_driver(time_s)
        self._note_moves(time_s)
        if self._frames.about(now_s) is not None:
            self.control.limits = limits_of(self.robot, *self._ceilings)
            self._to_all(lambda page: page.send("about", self._about()))
        ready = [page for page in self.pages if page.ready]
        if not ready:
            return
        tick = self.ticks.issue(now_s)
        frame |= {
            "type": "frame",
            "tick": tick,
            "pages": len(self.pages),
            **self._people(now_s),
            "why": self.control.why,
            "must_let_go": self.control.must_let_go,
            "going": None if self.control.going is None else self.control.going.place,
            "going_m_s": None if self.control.going is None else self.control.going.speed,
            "recording": self.recorder.now,
            "fleet": self.look_around(),
            "sim": None if self.panel is None else self.panel.now(),
        }
        text = encode(frame)
        for page in ready:
            self._tell_events(page)
            page.show(tick, text)

    @property
    def recorded(self) -> bool:
        """Whether this is no robot, but a recording that is replayed."""
        return bool(self._frames.known.get("recorded"))

    @property
    def in_short(self) -> dict[str, Any]:
        """The robot as shown on pages of other robots."""
        frame = self._latest
        if not frame:
            return {"name": self.name, "state": "idle", "armed": False, "pose": None}
        facts = frame["facts"]
        names = ("other_commander", "inhibited", "overridden", "front_bumper", "rear_bumper")
        return {
            "name": self.name,
            "state": frame["state"],
            "armed": facts["armed"],
            "pose": frame["pose"],
            "going": None if self.control.going is None else self.control.going.place,
            "battery": frame["battery"] and frame["battery"]["percent"],
            "alarm": any(facts[name] for name in names)
            or (facts["stop_unconfirmed"] and facts["at_rest"] is not True)
            or bool(frame["battery"] and frame["battery"]["state"] == "critical"),
        }

    def forget_trail(self) -> None:
        """Restart the robot's trail, on all pages and on those that open later."""
        self._history.path.clear()
        self._to_all(lambda page: page.send("trail", {"path": self._history.path.columns()}))

    def _to_all(self, tell: Callable[[Page], object]) -> None:
        for page in self.pages:
            tell(page)

    def _people(self, now_s: float) -> dict[str, Any]:
        driver, asker = self.control.driver, self.control.asker
        return {
            "driver": None if driver is None else driver.number,
            "driver_name": None if driver is None else driver.name,
            "asker": None if asker is None else asker.number,
            "asker_name": None if asker is None else asker.name,
            "relievable": self._frames.at_rest is True and self.control.is_idle(now_s),
        }

    def relieve(self, page: Page) -> None:
        """Give this page control instead of a driver that drives nothing."""
        self.control.relieve(page, self.now_s, at_rest=self._frames.at_rest is True)

    def _note_driver(self, time_s: float) -> None:
        driver = self.control.driver
        if driver is not self._driver:
            text = "nobody has control" if driver is None else f"{driver.name} took control"
            self._history.note(time_s, "plain", text)
            self._driver = driver

    def _note_moves(self, time_s: float) -> None:
        """Note which moves to a place have begun and ended."""
        begun, self.control.begun = self.control.begun, []
        for move in begun:
            place = f"x {move.place[0]:.2f} m, y {move.place[1]:.2f} m"
            self._history.note(time_s, "plain", f"the robot goes to {place} by itself")
            self._under_way.append((place, move))
        for place, move in self._under_way:
            if move.on:
                continue
            level = "weak" if move.why not in ("", ENDED) else "plain"
            text = f"did not arrive at {place}: {move.why}" if move.why else f"arrived at {place}"
            self._history.note(time_s, level, f"the robot {text}")
        self._under_way = [entry for entry in self._under_way if entry[1].on]

    def note(self, level: str, text: str) -> None:
        """Add to the list of events on all pages."""
        self._history.note(time.time(), level, text)

    def _tell_events(self, page: Page) -> None:
        news: list[Notice] = []
        for notice in reversed(self._history.events):
            if notice.number <= page.seen_event:
                break
            news.append(notice)
        if news:
            page.seen_event = news[0].number
            page.send("events", {"events": [notice._asdict() for notice in reversed(news)]})
