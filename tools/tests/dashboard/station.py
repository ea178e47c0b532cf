# SPDX-License-Identifier: MIT
"""A dashboard in this process, so that tests see the page, the server and the robot at once."""

import contextlib
import math
import os
import socket
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from playwright.sync_api import Error, Page, expect

import roburoc4
from roburoc4_tools.dashboard.camera import Camera
from roburoc4_tools.dashboard.fleet import Fleet
from roburoc4_tools.dashboard.guard import Rules
from roburoc4_tools.dashboard.hub import Hub
from roburoc4_tools.dashboard.panel import Panel
from roburoc4_tools.dashboard.server import Place, listen, make_server

CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
FIREFOX = os.environ.get("FIREFOX", "/usr/bin/firefox-esr")
LEASE_S = 0.5
"""Longer than by default, so that pages on a loaded machine can answer in time."""
WATCHDOG_S = 1.0
"""The robot's own, which has nothing to do here: whoever stops later than this relied on it."""
PATIENCE_S = 60.0
MARGIN_S = 0.4
"""What a loaded machine may take until a page, a thread or a socket gets its turn; lease and
margin are well below the second after which the robot's own watchdog would have stopped it."""
WITHIN_S = LEASE_S + MARGIN_S

FAKE_PAD = """
window.pad = null;
window.makePad = (index = 0) => {
  window.pad = {
    id: "Test pad (STANDARD GAMEPAD)", index, connected: true, mapping: "standard",
    axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ pressed: false, value: 0 })),
  };
};
window.hold = (button, value) => { window.pad.buttons[button] = { pressed: value > 0.5, value }; };
navigator.getGamepads = () => [window.pad];
"""
A, B, LB, RB, LT, RT = 0, 1, 4, 5, 6, 7
NAME = "Chrome on Linux"
"""What a page of these browsers is called until somebody gives it a name."""

# A keyboard repeats the key that was pressed last until it is released. Playwright's keys do not
# repeat, so this does it.
REPEATS = """
window.repeats = true;
{
  let last = "";
  addEventListener("keydown", (event) => { if (event.isTrusted) last = event.code; }, true);
  addEventListener("keyup", (event) => { if (event.code === last) last = ""; }, true);
  setInterval(() => {
    if (!last || !window.repeats) return;
    dispatchEvent(new KeyboardEvent("keydown", { code: last, repeat: true }));
  }, 30);
}
"""


# Every frame that the page gets is changed into the state that is wanted.
SHOWS = """
window.wanted = null;
const listen = WebSocket.prototype.addEventListener;
const isTable = (value) => value && typeof value === "object" && !Array.isArray(value);
const merge = (one, other) => {
  const both = { ...one };
  for (const [key, value] of Object.entries(other)) {
    both[key] = isTable(value) ? merge(one[key] ?? {}, value) : value;
  }
  return both;
};
WebSocket.prototype.addEventListener = function (kind, handler) {
  listen.call(this, kind, kind !== "message" ? handler : (event) => {
    const message = JSON.parse(event.data);
    if (message.type !== "frame" || !window.wanted) return handler(event);
    return handler({ data: JSON.stringify(merge(message, window.wanted)) });
  });
};
"""


def until(condition: Callable[[], object], seconds: float = PATIENCE_S) -> None:
    """Wait until it is true; fail if it never is."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it never became true"
        time.sleep(0.002)


class Station:
    """A simulator, a robot object, and the dashboard's server in a thread."""

    def __init__(
        self,
        *,
        enable_drive: bool = True,
        lease_s: float = LEASE_S,
        panel: bool = False,
        rules: Rules | None = None,
        place: Place | None = None,
        names: Callable[[int], tuple[str, ...]] | None = None,
        robots: Sequence[str] = ("",),
        cameras: Sequence[Camera] = (),
        client: roburoc4.Settings | None = None,
        idle_s: float = math.inf,
        **settings: Any,
    ) -> None:
        self.sims = [roburoc4.Simulator(port=0, **settings) for _ in robots]
        given: roburoc4.Settings = {"lease_ms": round(lease_s * 1000), **(client or {})}
        self.robots = [roburoc4.connect(sim.address, wait=False, **given) for sim in self.sims]
        self.hubs = [
            Hub(
                robot,
                lease_s,
                (1.0, 1.0),
                enable_drive=enable_drive,
                panel=Panel(sim) if panel else None,
                name=name,
                cameras=cameras,
            )
            for name, sim, robot in zip(robots, self.sims, self.robots, strict=True)
        ]
        for hub in self.hubs:
            hub.control.idle_s = idle_s
        self.sim, self.robot, self.hub = self.sims[0], self.robots[0], self.hubs[0]
        place = place or Place()
        self._socket = listen(place)
        self.port = self._socket.getsockname()[1]
        rules = rules or Rules(None, names(self.port) if names else ())
        ready = threading.Event()
        self.server = make_server(Fleet(self.hubs), place, rules, ready.set)
        self._thread = threading.Thread(target=self.server.run, args=([self._socket],), daemon=True)
        self._thread.start()
        assert ready.wait(PATIENCE_S)
        self.scheme = "https" if place.secure else "http"
        self.url = f"{self.scheme}://127.0.0.1:{self.port}/"

    def stop_serving(self) -> None:
        """End the dashboard, and not the robot."""
        self.server.should_exit = True
        self.wait_for_end()

    def wait_for_end(self) -> None:
        """Wait until the dashboard has ended."""
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()

    def close(self) -> None:
        """End everything."""
        self.stop_serving()
        for ended in (*self.robots, *self.sims):
            ended.close()
        self._socket.close()

    # ---- commands to the robot ----

    @property
    def driven(self) -> bool:
        """Whether the last speed command was a speed."""
        state = self.sim.state
        return (state.last_linear_m_s, state.last_angular_rad_s) != (0.0, 0.0)

    def drives_on(self) -> bool:
        """Whether speeds come in, and keep coming for a few leases."""
        begun_s = time.monotonic()
        while not self.driven:
            if time.monotonic() - begun_s > 4 * LEASE_S:
                return False
            time.sleep(0.002)
        time.sleep(2 * LEASE_S)
        return self.driven

    def wait_until_driven(
        self, page: Page, hold: Callable[[], object], let_go: Callable[[], object]
    ) -> None:
        """Hold until the robot keeps driving.

        Where a stall of a loaded machine ends that, release all inputs, arm where it was disarmed,
        and try again.
        """
        end = time.monotonic() + 3 * PATIENCE_S
        hold()
        while not self.drives_on():
            assert time.monotonic() < end, "the robot never kept driving"
            let_go()
            time.sleep(LEASE_S)
            press_arm(page)
            hold()

    def wait_until_stopped(self, begun_s: float) -> float:
        """Wait for the first zero; return how long after ``begun_s`` it came."""
        until(lambda: not self.driven)
        state = self.sim.state
        assert not state.watchdog_tripped
        return state.last_command_us / 1e6 - begun_s

    def wait_for_stop_pressed(self) -> None:
        """Wait until STOP has come and the robot is stopped; a bumper or a lease stops it, too."""
        until(lambda: self.hub.control.why.startswith("STOP was pressed"))
        assert not self.robot.facts.armed
        until(lambda: not self.driven)

    def speeds_sent(self) -> int:
        """How many commands carried a speed so far."""
        return self.sim.state.nonzero_speed_commands


def stays_stopped(here: Station) -> None:
    """Fail if a speed is sent now, without anybody doing anything."""
    before = here.speeds_sent()
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before, "it came back by itself"


def ready(page: Page) -> None:
    """Wait until the page shows a robot that is ready."""
    expect(page.locator("#quality-say")).to_have_text("Link good")


def open_tab(page: Page, name: str) -> None:
    """Show one of the tabs below the map."""
    if page.locator(f"#tab-{name}").get_attribute("aria-selected") != "true":
        page.locator(f"#tab-{name}").click()


def take_control(page: Page) -> None:
    """Press the button."""
    page.get_by_role("button", name="Take control").click()
    expect(page.locator("#control")).to_have_text("Control: this page")


def arm(page: Page) -> None:
    """Take control and arm."""
    ready(page)
    take_control(page)
    press_arm(page)


def press_arm(page: Page) -> None:
    """Arm, as a person does it: again, where the page of a loaded machine was late."""
    end = time.monotonic() + PATIENCE_S
    while "Ready:" not in (page.locator("#drive-why").text_content() or ""):
        assert time.monotonic() < end, page.locator("#drive-why").text_content()
        if page.locator("#arm").is_visible():
            with contextlib.suppress(Error):  # it may be armed by now
                page.locator("#arm").click(timeout=1000)
        page.wait_for_timeout(300)


def hold_pad(page: Page, **held: float) -> None:
    """Plug a game pad in, and hold [A] and more."""
    if page.evaluate("window.pad === null"):
        page.evaluate("makePad()")
        if page.locator("#inputs").is_visible():
            expect(page.locator("#pad-text")).to_contain_text("hold [A]")
    for button, value in (
        (A, held.get("a", 1.0)),
        (RT, held.get("rt", 0.0)),
        (LT, held.get("lt", 0.0)),
    ):
        page.evaluate(f"hold({button}, {value})")
    page.evaluate(f"window.pad.axes[0] = {held.get('lj', 0.0)}")


def drive(here: Station, page: Page, **held: float) -> None:
    """Drive by game pad until the robot keeps driving: ahead, unless inputs are given."""
    here.wait_until_driven(
        page, lambda: hold_pad(page, **(held or {"rt": 1.0})), lambda: page.evaluate("hold(0, 0)")
    )


def hang(page: Page) -> None:
    """Keep the page from drawing for a while."""
    page.evaluate(
        "setTimeout(() => { const end = Date.now() + 1500; while (Date.now() < end); }, 0)"
    )


class Finger:
    """A finger on the page, and a second one that presses beside it."""

    def __init__(self, page: Page) -> None:
        self._devices = page.context.new_cdp_session(page)
        self._at = (0.0, 0.0)

    def _touch(self, kind: str, *points: tuple[float, float]) -> None:
        spots = [{"x": x, "y": y, "id": index} for index, (x, y) in enumerate(points)]
        self._devices.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": spots})

    def down(self, x: float, y: float) -> None:
        """Touch."""
        self._at = (x, y)
        self._touch("touchStart", self._at)

    def move(self, x: float, y: float) -> None:
        """Drag."""
        self._at = (x, y)
        self._touch("touchMove", self._at)

    def press_beside(self, x: float, y: float) -> None:
        """Press with a second finger while the first stays down."""
        self._touch("touchStart", self._at, (x, y))

    def up(self) -> None:
        """Lift."""
        self._touch("touchEnd")


def free_port() -> int:
    """A port that nobody uses."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])
