# SPDX-License-Identifier: MIT
"""Pages without a browser: none that is late, old, wrong or invented moves the robot."""

import contextlib
import time
from collections.abc import Callable, Iterator

import pytest
from page_client import Proxy, Visitor
from playwright.sync_api import Page, expect
from station import LEASE_S, WITHIN_S, Station, arm, drive, ready, stays_stopped, until
from websockets.exceptions import ConnectionClosed

from roburoc4_tools.dashboard.fleet import Fleet
from roburoc4_tools.dashboard.hub import MOST_PAGES
from roburoc4_tools.dashboard.messages import BadMessageError, Messages

Make = Callable[..., Station]
PLACE = {"x_m": 1.0, "y_m": 0.0, "theta_rad": 0.0, "scale": 1.0}


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


def test_a_browser_behind_a_dead_connection_stops_the_robot_and_can_still_stop_it(
    behind: Station, proxy: Proxy, visit: Callable[..., Page]
) -> None:
    page = visit(f"http://127.0.0.1:{proxy.port}/")
    arm(page)
    drive(behind, page)
    begun_s = time.monotonic()
    proxy.flows.clear()
    assert behind.wait_until_stopped(begun_s) < WITHIN_S
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")
    before, speeds = proxy.connections, behind.speeds_sent()
    page.locator("#stop").click()
    until(lambda: proxy.connections > before)  # and this one does not open
    proxy.kill()
    until(lambda: "STOP was pressed" in behind.hub.control.why)
    assert behind.speeds_sent() == speeds, "it drove on with a button that was held all the time"


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
        behind.wait_for_stop_pressed()


def test_a_server_that_hangs_stops_the_robot_within_the_lease(station: Make) -> None:
    here = station()
    step = here.hub.step

    def hang() -> None:
        here.hub.step = step
        time.sleep(1.5)

    with Visitor(here) as driver:
        driver.arm()
        driver.drive(lambda: here.driven)
        begun_s = time.monotonic()
        here.hub.step = hang
        assert here.wait_until_stopped(begun_s) < WITHIN_S
        before = here.speeds_sent()
        driver.draw_for(2.0, 0.4)
        assert here.speeds_sent() == before, "it drove on with what was held all the time"


def test_an_error_in_the_server_stops_all_robots_and_ends_it(station: Make) -> None:
    here = station(robots=("RED", "BLUE"))

    def fail() -> None:
        raise RuntimeError("of this test")

    with Visitor(here, path="/socket?robot=BLUE") as driver:
        driver.arm()
        here.hub.step = fail
        here.wait_for_end()
    assert not here.robots[1].facts.armed
    assert str(here.hub.failure) == "of this test"


def test_an_old_answer_is_no_sign_of_life(station: Make) -> None:
    here = station()
    with Visitor(here) as page:
        page.draw()
        page.draw()
        (one,) = here.hub.pages
        until(lambda: page.tick not in one._owed)
        heard_s = one.heard_s
        page.answer(page.tick, None)
        page.answer(page.tick + 1000, None)
        page.say("name", name="it has come")
        until(lambda: one.name == "it has come")
        assert one.heard_s == heard_s


NONSENSE = (
    "",
    "{",
    "[]",
    '{"type":"fly"}',
    '{"type":"drawn"}',
    '{"type":"drawn","tick":true}',
    '{"type":"drawn","tick":1,"input":7}',
    '{"type":"drawn","tick":1,"input":{"forward":NaN,"left":0,"scale":1}}',
    '{"type":"go","tick":1,"x_m":NaN,"y_m":0,"scale":1}',
    '{"type":"drawn","tick":1,"input":{"forward":1.01,"left":0,"scale":1}}',
    '{"type":"drawn","tick":1,"input":{"forward":true,"left":0,"scale":1}}',
    '{"type":"drawn","tick":1,"input":{"forward":0,"left":-2,"scale":1}}',
    '{"type":"drawn","tick":1,"input":{"forward":0,"left":0,"scale":0}}',
    "[" * 1900,
    "x" * 3000,
    "x" * 100_000,
    '{"type":"faults","faults":{"' + 200 * "x" + '":"1"}}',
)


def test_nonsense_ends_the_connection_and_nothing_else(
    station: Make, caplog: pytest.LogCaptureFixture
) -> None:
    here = station(panel=True)
    with Visitor(here) as other:
        other.draw()
        for text in NONSENSE:
            with Visitor(here) as visitor:
                visitor.socket.send(text)
                with pytest.raises(ConnectionClosed, match=r"1008|1009"):
                    while True:
                        visitor.receive()
        other.draw_for(0.2)
    assert not caplog.records


def test_nonsense_of_the_driver_disarms(station: Make) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.answer(driver.tick, 1.01)
        until(lambda: here.hub.control.driver is None)
        assert not here.robot.facts.armed


def test_a_page_whose_outbox_is_full_is_not_kept(station: Make) -> None:
    here = station()
    page = here.hub.join()
    with pytest.raises(BadMessageError, match="outbox is full"):
        for _ in range(100):
            Messages(Fleet([here.hub]), here.hub, page).receive('{"type":"clear"}')
    here.hub.part(page)


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


def test_pages_that_draw_nothing_cost_little_and_queue_nothing(station: Make) -> None:
    here = station()
    with Visitor(here) as silent:
        time.sleep(1.5)
        before = here.hub.ticks.last
        time.sleep(1.0)
        assert here.hub.ticks.last == before
        assert before <= 4
        with Visitor(here) as other:
            other.draw_for(0.5)
            assert other.frame["pages"] == 2
        assert here.hub.ticks.last > before + 5
        silent.socket.recv()  # hello, before frames
        frames = 0
        with contextlib.suppress(TimeoutError):
            while True:
                frames += '"type":"frame"' in str(silent.socket.recv(timeout=0.3))
        assert frames <= 3


def test_only_the_driver_drives_arms_and_disarms_with_ticks_that_were_sent(station: Make) -> None:
    here = station()
    with Visitor(here) as driver, Visitor(here) as other:
        driver.arm()
        for kind in ("arm", "disarm", "go", "relocalize", "keep"):
            other.draw()
            other.say(kind, tick=other.tick, **PLACE)
            until(lambda: other.receive()["type"] == "refused")
        other.draw_for(0.3, 1.0)
        driver.draw_for(0.3, 0.0)
        dropped = here.hub.control.dropped
        for tick in (driver.tick + 1, driver.tick + 1000, 0, -1, 10**30):
            driver.answer(tick, 1.0)
        until(lambda: driver.draw(0.0) or here.hub.control.dropped >= dropped + 5)
        assert here.robot.facts.armed
        assert here.speeds_sent() == 0
    until(lambda: here.hub.control.driver is None)
    assert not here.robot.facts.armed, "a closed page disarms"


def test_a_driver_that_releases_control_still_gets_frames(station: Make) -> None:
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
        for kind in ("take", "arm", "stop", "disarm", "leave", "go", "relocalize", "relieve"):
            visitor.draw()
            visitor.say(kind, tick=visitor.tick, **PLACE)
        visitor.say("panel", line="power off")
        visitor.draw(1.0)
        visitor.draw_for(0.3)
        assert len(visitor.refusals) >= 8
        assert here.sim.state.speed_commands == 0
        assert here.sim.state.powered, "it is not known to be a simulator"


def test_a_refusal_costs_neither_connection_nor_control(station: Make) -> None:
    here = station(panel=True)
    with Visitor(here) as driver:
        driver.arm()
        here.sim.set("battery_percent", 50.0)
        for kind, message in (
            ("go", PLACE | {"x_m": 2000.0}),
            ("go", PLACE | {"clearance_m": -1.0}),
            ("go", PLACE | {"y_m": -1001.0}),
            ("panel", {"line": "pad \ud800"}),
            ("panel", {"line": "estop l\u00f6cal press"}),
        ):
            driver.refusals.clear()
            driver.say(kind, tick=driver.tick, **message)
            while not driver.refusals:
                driver.draw(0.0)
        assert here.hub.control.driver is not None
        assert here.hub.control.begun == []
        assert "going to a place was refused" in here.hub._history.events[-1].text


# ---- what the robot does, as pages are told ----


def told(page: Visitor, name: str) -> bool:
    """Whether a fact of the robot is told by now."""
    page.draw()
    return page.frame["facts"][name] is True


@pytest.mark.parametrize(
    ("trouble", "fact", "why"),
    [("pad_a", "overridden", "held [A]"), ("estop_remote", "", "did not follow its commands")],
)
def test_trouble_while_driving_disarms_and_says_why(
    trouble: str, fact: str, why: str, station: Make
) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.drive(lambda: here.driven)
        here.sim.set(trouble, True)
        until(lambda: driver.draw(0.4) or not here.robot.facts.armed)
        until(lambda: driver.draw(0.4) or why in driver.frame["why"])
        assert not fact or told(driver, fact)
        here.sim.set(trouble, False)
        here.sim.set("motor_button", True)
        before = here.speeds_sent()
        driver.draw_for(1.0, 0.4)
        assert here.speeds_sent() == before, "the old command came back"


def test_a_stop_that_was_not_confirmed_is_told_until_the_robot_stands(station: Make) -> None:
    here = station()
    with Visitor(here) as page:
        page.draw_for(0.3)
        here.sim.set("pad_a", True)
        until(lambda: told(page, "overridden"))
        here.sim.set("pad_rt", 0.0)
        until(lambda: here.sim.state.wheel_linear_m_s > 0.5)
        until(lambda: page.draw() or page.frame["facts"]["at_rest"] is False)
        page.say("stop")  # which the robot ignores now
        until(lambda: told(page, "stop_unconfirmed"))
        here.sim.set("pad_a", False)
        here.sim.set("pad_rt", 1.0)
        until(lambda: told(page, "at_rest"))
        assert not told(page, "stop_unconfirmed")
        here.sim.set("power", False)
        until(lambda: page.draw() or page.frame["state"] == "lost")
        assert page.frame["facts"]["at_rest"] is None, "a lost robot may move"


def test_a_robot_that_brakes_is_not_at_rest(station: Make) -> None:
    here = station()
    with Visitor(here) as driver:
        driver.arm()
        driver.drive(lambda: here.sim.state.wheel_linear_m_s > 0.3, 1.0)
        driver.say("stop")
        while not told(driver, "at_rest"):
            pass
        assert abs(driver.frame["speeds"][1]) < 0.03


def test_an_idle_driver_is_relieved_while_the_robot_stands(station: Make) -> None:
    here = station(idle_s=0.0)
    with Visitor(here) as driver, Visitor(here) as other:
        driver.arm()
        until(lambda: other.draw() or other.frame["relievable"])
        here.sim.set("pad_a", True)
        here.sim.set("pad_lj_x", 1.0)
        until(lambda: other.draw() or other.frame["facts"]["at_rest"] is False)
        assert not other.frame["relievable"]
        other.say("relieve")
        until(lambda: other.receive()["type"] == "refused")
        here.sim.set("pad_a", False)
        until(lambda: other.draw() or other.frame["relievable"])
        other.say("relieve")
        until(lambda: other.draw() or other.frame["driver"] != driver.frame["driver"])
        stays_stopped(here)
        assert not here.robot.facts.armed


def test_what_else_may_be_wrong_is_told_and_noted(station: Make) -> None:
    here = station()
    with Visitor(here) as page:
        page.draw_for(0.3)
        for name, values, fact, texts in (
            ("charger", (True, False), "charger", ("was plugged in", "was unplugged")),
            ("localization_flags", (82, 18), "pose_error", ("reports an error", "works again")),
            ("rear_bumper", (True, False), "rear_bumper", ("was pressed", "was released")),
        ):
            for value, text, on in zip(values, texts, (True, False), strict=True):
                here.sim.set(name, value)
                until(lambda fact=fact, on=on: told(page, fact) is on)
                assert text in here.hub._history.events[-1].text
    numbers = [event.number for event in here.hub._history.events]
    assert numbers == sorted(set(numbers))
