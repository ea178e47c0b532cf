# SPDX-License-Identifier: MIT
"""Inputs that are late, old, repeated or invented: none of them moves the robot."""

import contextlib
import time
from collections.abc import Callable, Iterator

import pytest
from page_client import Proxy, Visitor
from playwright.sync_api import Page, expect
from station import LEASE_S, Station, arm, drive, ready, until
from test_driving import WITHIN_S
from websockets.exceptions import ConnectionClosed

from roburoc4_tools.dashboard.app import _hear
from roburoc4_tools.dashboard.fleet import Fleet
from roburoc4_tools.dashboard.hub import MOST_PAGES
from roburoc4_tools.dashboard.messages import BadMessageError, Messages

Make = Callable[..., Station]


@pytest.fixture
def proxy() -> Iterator[Proxy]:
    running = Proxy()
    yield running
    running.close()


@pytest.fixture
def behind(station: Make, proxy: Proxy) -> Station:
    """A dashboard that pages reach through a proxy."""
    here = station(names=lambda _: (f"127.0.0.1:{proxy.port}",))
    proxy.serve(here.port)
    return here


def test_what_a_stalled_socket_delivers_late_is_ignored(behind: Station, proxy: Proxy) -> None:
    with Visitor(behind, port=proxy.port) as driver:
        driver.arm()
        driver.drive(lambda: behind.driven)
        begun_s = time.monotonic()
        proxy.flows.clear()
        for _ in range(20):  # a page that keeps answering the last frame it saw
            driver.answer(driver.tick, 0.4)
            time.sleep(0.02)
        assert behind.wait_until_stopped(begun_s) < WITHIN_S
        time.sleep(LEASE_S)
        before, dropped = behind.speeds_sent(), behind.hub.control.dropped
        proxy.flows.set()
        until(lambda: behind.hub.control.dropped >= dropped + 15)
        assert behind.speeds_sent() == before


def test_a_browser_behind_a_stalled_socket_stops_the_robot(
    behind: Station, proxy: Proxy, visit: Callable[..., Page]
) -> None:
    page = visit(f"http://127.0.0.1:{proxy.port}/")
    arm(page)
    drive(behind, page)
    begun_s = time.monotonic()
    proxy.flows.clear()
    assert behind.wait_until_stopped(begun_s) < WITHIN_S
    time.sleep(2 * LEASE_S)
    before = behind.speeds_sent()
    proxy.flows.set()
    time.sleep(4 * LEASE_S)
    assert behind.speeds_sent() == before, "it drove on with a button that was held all the time"


def test_stop_does_not_wait_for_a_dead_connection(
    behind: Station, proxy: Proxy, visit: Callable[..., Page]
) -> None:
    page = visit(f"http://127.0.0.1:{proxy.port}/")
    ready(page)
    proxy.kill()
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")
    with Visitor(behind) as driver:
        driver.arm()
        page.locator("#stop").click()
        until(lambda: "STOP was pressed" in behind.hub.control.why)
        assert not behind.robot.facts.armed


def test_stop_does_not_wait_for_a_connection_that_does_not_open(
    behind: Station, proxy: Proxy, visit: Callable[..., Page]
) -> None:
    page = visit(f"http://127.0.0.1:{proxy.port}/")
    ready(page)
    proxy.flows.clear()
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")
    before = proxy.connections
    page.locator("#stop").click()
    until(lambda: proxy.connections > before)
    proxy.kill()
    until(lambda: "STOP was pressed" in behind.hub.control.why)


def test_ticks_that_were_never_sent_are_ignored(station: Make) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        before = here.speeds_sent()
        for tick in (driver.tick + 1, driver.tick + 1000, 0, -1, 10**30):
            driver.answer(tick, 1.0)
        driver.draw_for(0.3)
        assert here.speeds_sent() == before
        assert here.hub.control.dropped >= 5


def test_ticks_of_another_connection_are_ignored(station: Make) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        old = driver.tick
    until(lambda: here.hub.control.driver is None)
    with Visitor(here) as driver:
        driver.say("take")
        driver.say("arm", tick=old)
        driver.answer(old, 1.0)
        driver.draw_for(0.3)
        assert not here.robot.facts.armed
        assert here.speeds_sent() == 0


@pytest.mark.parametrize(
    "inputs",
    [
        {"forward": 1.01},
        {"forward": 1e300},
        {"forward": "1"},
        {"forward": True},
        {"left": -2.0},
        {"left": None},
        {"scale": 0.0},
        {"scale": 1.5},
        {"scale": []},
    ],
)
def test_an_input_out_of_range_ends_the_connection_and_the_drive(
    inputs: dict[str, object], station: Make
) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.draw_for(0.2, 0.4)
        whole = {"forward": 0.0, "left": 0.0, "scale": 1.0} | inputs
        driver.say("drawn", tick=driver.tick, input=whole)
        until(lambda: here.hub.control.driver is None)
        until(lambda: not here.driven)
        assert not here.robot.facts.armed


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "1",
        '{"type":"fly"}',
        '{"type":"drawn"}',
        '{"type":"drawn","tick":true}',
        '{"type":"drawn","tick":1,"input":7}',
        '{"type":"drawn","tick":1,"input":{"forward":NaN,"left":0,"scale":1}}',
        '{"type":"arm","tick":"1"}',
        "[" * 1900,
        "x" * 3000,
        "x" * 100_000,
        '{"type":"faults","faults":{"' + 200 * "x" + '":"1"}}',
    ],
)
def test_nonsense_ends_the_connection_and_nothing_else(
    text: str, station: Make, caplog: pytest.LogCaptureFixture
) -> None:
    here = station(panel=True)
    with Visitor(here) as other, Visitor(here) as visitor:
        visitor.socket.send(text)
        until(lambda: len(here.hub.pages) == 1)
        other.draw_for(0.2)
        with pytest.raises(ConnectionClosed):
            while True:
                visitor.receive()
    assert not caplog.records


class Gone:
    """A page that is gone when it is told that it is."""

    async def receive_text(self) -> str:
        return "nonsense"

    async def close(self, code: int, reason: str) -> None:
        assert (code, reason) == (1008, "not JSON")
        raise RuntimeError("a close message has been sent")


def test_nonsense_of_a_page_that_is_gone_raises_nothing(station: Make) -> None:
    here = station()
    page = here.hub.join()
    messages = Messages(Fleet([here.hub]), here.hub, page)
    with pytest.raises(StopIteration):  # it ends without an exception of its own
        _hear(messages, Gone()).send(None)  # type: ignore[arg-type]
    assert page not in here.hub.pages


def test_a_page_whose_end_was_found_while_sending_raises_nothing(station: Make) -> None:
    class Ended(Gone):
        async def receive_text(self) -> str:
            raise RuntimeError("WebSocket is not connected")

    here = station()
    messages = Messages(Fleet([here.hub]), here.hub, here.hub.join())
    with pytest.raises(StopIteration):
        _hear(messages, Ended()).send(None)  # type: ignore[arg-type]


@pytest.mark.parametrize("goal", [{"x_m": 2000.0}, {"clearance_m": -1.0}, {"y_m": -1001.0}])
def test_a_place_that_cannot_be_costs_neither_connection_nor_control(
    goal: dict[str, float], station: Make
) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.refusals.clear()  # of arming, on a loaded machine
        driver.say("go", tick=driver.tick, **{"x_m": 1.0, "y_m": 0.0, "scale": 0.5} | goal)
        while not driver.refusals:
            driver.draw(0.0)
        assert here.hub.control.driver is not None
        assert here.hub.control.begun == []
        assert "going to a place was refused" in here.hub._history.events[-1].text


@pytest.mark.parametrize("line", ["pad \ud800", "estop l\u00f6cal press", "\ud800"])
def test_a_panel_line_of_other_letters_is_refused(
    line: str, station: Make, caplog: pytest.LogCaptureFixture
) -> None:
    here = station(panel=True)
    with Visitor(here) as visitor:
        visitor.say("panel", line=line)
        until(lambda: visitor.receive()["type"] == "refused")
        visitor.draw_for(0.2)
    assert not caplog.records


def test_a_page_whose_outbox_is_full_is_not_kept(station: Make) -> None:
    here = station()
    page = here.hub.join()
    with pytest.raises(BadMessageError, match="outbox is full"):
        for _ in range(100):
            Messages(Fleet([here.hub]), here.hub, page).receive('{"type":"clear"}')
    here.hub.part(page)


def test_pages_that_draw_nothing_cost_little(station: Make) -> None:
    here = station()
    beats = []
    step = here.hub.step
    with Visitor(here) as silent:
        here.hub.step = lambda: (beats.append(time.monotonic()), step())[1]
        time.sleep(2.0)
        beats.clear()
        time.sleep(2.0)
        idle = len(beats)
        assert idle < 20
        silent.draw_for(0.5)
        beats.clear()
        silent.draw_for(2.0)
        assert len(beats) > 2 * idle


def test_a_flood_ends_the_connection(station: Make) -> None:
    here = station()
    with Visitor(here) as visitor, pytest.raises(ConnectionClosed):
        for _ in range(100_000):
            visitor.say("drawn", tick=1)
    until(lambda: not here.hub.pages)


def test_no_more_pages_than_can_be_served_are_let_in(station: Make) -> None:
    here = station()
    with contextlib.ExitStack() as opened:
        for _ in range(MOST_PAGES):
            opened.enter_context(Visitor(here)).receive()
        with Visitor(here) as late, pytest.raises(ConnectionClosed, match="too many pages"):
            late.receive()
        assert len(here.hub.pages) == MOST_PAGES


def test_a_page_that_answers_nothing_costs_others_nothing(
    station: Make,
) -> None:
    here = station()
    with Visitor(here) as silent, Visitor(here) as other:
        other.draw_for(1.0)
        seen = 0
        silent.socket.recv(timeout=5)  # hello
        while True:
            try:
                seen += '"type":"frame"' in str(silent.socket.recv(timeout=0.3))
            except TimeoutError:
                break
        assert 1 <= seen <= 3
        assert other.frame["pages"] == 2


def test_only_the_driver_drives_arms_and_disarms(station: Make) -> None:
    here = station()
    with Visitor(here) as driver, Visitor(here) as other:
        driver.arm()
        place = {"x_m": 1.0, "y_m": 0.0, "theta_rad": 0.0, "scale": 1.0}
        for kind in ("arm", "disarm", "go", "relocalize", "keep"):
            other.draw()
            other.say(kind, tick=other.tick, **place)
            until(lambda: other.receive()["type"] == "refused")
        other.draw_for(0.3, 1.0)
        driver.draw_for(0.3, 0.0)
        assert here.robot.facts.armed
        assert here.speeds_sent() == 0


def test_a_driver_that_releases_control_still_gets_frames(
    station: Make,
) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.refusals.clear()
        for _ in range(3):  # as many as a page may leave unanswered
            while driver.receive()["type"] != "frame":
                pass
        driver.say("leave")
        for back in (2, 1, 0):
            driver.answer(driver.tick - back, 0.4)
        driver.draw_for(0.5)
        assert driver.refusals == []
        assert here.speeds_sent() == 0


def test_without_enable_drive_no_message_sends_a_command(station: Make) -> None:
    here = station(enable_drive=False)
    with Visitor(here) as visitor:
        place = {"x_m": 1.0, "y_m": 0.0, "theta_rad": 0.0, "scale": 1.0}
        for kind in ("take", "arm", "stop", "disarm", "leave", "go", "relocalize"):
            visitor.draw()
            visitor.say(kind, tick=visitor.tick, **place)
        visitor.draw(1.0)
        visitor.draw_for(0.3)
        assert len(visitor.refusals) >= 6
        assert here.sim.state.speed_commands == 0


def test_without_a_simulator_there_is_no_panel(station: Make) -> None:
    here = station()
    with Visitor(here) as visitor:
        visitor.draw()
        visitor.say("panel", line="power off")
        until(lambda: visitor.receive()["type"] == "refused")
        assert here.sim.state.powered
