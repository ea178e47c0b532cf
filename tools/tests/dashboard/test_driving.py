# SPDX-License-Identifier: MIT
"""Driving from the page: what moves the robot, and everything that stops it."""

import contextlib
import re
import time
from collections.abc import Callable

import pytest
from page_client import Visitor
from playwright.sync_api import Page, expect
from station import (
    LEASE_S,
    NAME,
    Station,
    arm,
    drive,
    hold_pad,
    open_tab,
    ready,
    take_control,
    until,
)

from roburoc4_tools.dashboard.guard import Rules
from roburoc4_tools.dashboard.hub import MOST_PAGES
from roburoc4_tools.dashboard.server import Place

MARGIN_S = 0.4
"""What a loaded machine may take until a page, a thread or a socket gets its turn; lease and
margin are well below the second after which the robot's own watchdog would have stopped it."""
WITHIN_S = LEASE_S + MARGIN_S
FIRST_S = 0.7
"""What a key has until its first repeat."""

Visit = Callable[..., Page]
Make = Callable[..., Station]


def call(page: Page, name: str) -> None:
    """Give a page a name, as its user does."""
    ready(page)
    page.bring_to_front()  # Firefox gives keys to the front page only
    open_tab(page, "link")
    page.get_by_label("This page is called").click()
    page.keyboard.type(name)  # fill() leaves it empty in Firefox
    page.keyboard.press("Tab")


def armed(station: Make, visit: Visit) -> tuple[Station, Page]:
    """A dashboard, and a page that has taken its control and armed the robot."""
    here = station()
    page = visit(here.url)
    arm(page)
    return here, page


@pytest.mark.both
def test_a_game_pad_drives_as_in_the_manual(station: Make, visit: Visit) -> None:
    here = station(lease_s=1.0)
    page = visit(here.url)
    arm(page)
    scale = 0.3
    for held, linear, angular in (
        ({"rt": 1.0}, scale, 0.0),
        ({"lt": 1.0}, -scale, 0.0),
        ({"lj": -1.0}, 0.0, scale),
        ({"lj": 1.0}, 0.0, -scale),
    ):
        drive(here, page, **held)
        until(
            lambda linear=linear, angular=angular: (
                here.sim.state.last_linear_m_s == pytest.approx(linear, abs=1e-3)
                and here.sim.state.last_angular_rad_s == pytest.approx(angular, abs=1e-3)
            )
        )
    expect(page.locator("#asked")).to_contain_text("by game pad")


@pytest.mark.both
def test_keys_drive_and_letting_go_stops(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)

    def hold() -> None:
        page.keyboard.down("w")
        page.keyboard.down("ArrowLeft")

    def let_go() -> None:
        page.keyboard.up("w")
        page.keyboard.up("ArrowLeft")

    here.wait_until_driven(page, hold, let_go)
    assert here.sim.state.last_linear_m_s > 0
    assert here.sim.state.last_angular_rad_s > 0
    expect(page.locator("#banner-title")).to_have_text("DRIVING")
    page.keyboard.up("ArrowLeft")
    until(lambda: here.sim.state.last_angular_rad_s == 0)
    page.keyboard.up("w")
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S


def drive_by_keys(here: Station, page: Page) -> None:
    here.wait_until_driven(page, lambda: page.keyboard.down("w"), lambda: page.keyboard.up("w"))


def stays_stopped(here: Station) -> None:
    before = here.speeds_sent()
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before, "it came back by itself"


@pytest.mark.both
def test_a_key_that_stops_repeating_counts_as_released(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive_by_keys(here, page)
    page.evaluate("repeats = false")  # its release was lost
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    expect(page.locator("#drive-why")).to_contain_text("the key stopped repeating")
    page.evaluate("repeats = true")
    stays_stopped(here)
    page.keyboard.up("w")
    drive_by_keys(here, page)


def test_a_key_that_never_repeats_counts_for_a_moment_only(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.evaluate("repeats = false")
    page.keyboard.down("w")
    begun_s = time.monotonic()
    until(lambda: here.speeds_sent() > 0)
    assert here.wait_until_stopped(begun_s) < FIRST_S + MARGIN_S
    stays_stopped(here)


def test_other_keys_hold_for_a_moment_after_a_release(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)

    def hold() -> None:
        page.keyboard.down("w")
        page.keyboard.down("a")

    def let_go() -> None:
        page.keyboard.up("w")
        page.keyboard.up("a")

    here.wait_until_driven(page, hold, let_go)
    assert here.sim.state.last_linear_m_s > 0, "the first key no longer counts"
    page.keyboard.up("a")
    begun_s = time.monotonic()
    until(lambda: here.sim.state.last_angular_rad_s == 0)
    assert here.sim.state.last_linear_m_s > 0
    assert here.wait_until_stopped(begun_s) < FIRST_S + MARGIN_S
    stays_stopped(here)


def right_click(page: Page) -> None:
    page.evaluate("addEventListener('contextmenu', (event) => { window.menu = event })")
    page.locator("#map").click(button="right")
    assert page.evaluate("menu.defaultPrevented"), "a menu would hear the key's release"


def drag_a_text(page: Page) -> None:
    assert not page.evaluate(
        "document.body.dispatchEvent("
        "new DragEvent('dragstart', { bubbles: true, cancelable: true }))"
    ), "what is dragged would hear the key's release"


def press_command(page: Page) -> None:
    page.evaluate(
        "dispatchEvent(new KeyboardEvent('keydown', { code: 'MetaLeft', metaKey: true }))"
    )


@pytest.mark.both
@pytest.mark.parametrize("lose", [right_click, drag_a_text, press_command])
def test_what_may_hide_a_key_s_release_counts_as_its_release(
    lose: Callable[[Page], None], station: Make, visit: Visit
) -> None:
    here, page = armed(station, visit)
    drive_by_keys(here, page)
    lose(page)
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    stays_stopped(here)


@pytest.mark.both
def test_the_stick_drives_and_letting_go_stops(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    box = page.locator("#stick").bounding_box()
    assert box is not None
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)

    def hold() -> None:
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0], middle[1] - box["height"] / 2)

    here.wait_until_driven(page, hold, page.mouse.up)
    assert here.sim.state.last_linear_m_s == pytest.approx(0.3, abs=0.06)
    page.mouse.up()
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S


# ---- everything that stops it ----


def release_a(page: Page) -> None:
    page.evaluate("hold(0, 0)")


def unplug(page: Page) -> None:
    page.evaluate("window.pad = null")


def freeze(page: Page) -> None:
    debugger = page.context.new_cdp_session(page)
    debugger.send("Debugger.enable")
    debugger.send("Debugger.pause")


def hang(page: Page, seconds: float = 3.0) -> None:
    page.evaluate(
        "(ms) => setTimeout(() => { const end = Date.now() + ms; while (Date.now() < end); }, 0)",
        1000 * seconds,
    )


def blur(page: Page) -> None:
    page.evaluate("dispatchEvent(new Event('blur')); document.hasFocus = () => false")


def close(page: Page) -> None:
    page.close()


def press_stop(page: Page) -> None:
    page.locator("#stop").click()


def press_space(page: Page) -> None:
    page.keyboard.press("Space")


def give_up(page: Page) -> None:
    page.get_by_role("button", name="Give back").click()


def disarm(page: Page) -> None:
    page.get_by_role("button", name="Disarm", exact=True).click()


@pytest.mark.both
@pytest.mark.parametrize("end", [release_a, unplug, blur, hang, close, press_stop, press_space])
def test_it_stops_within_the_lease(
    end: Callable[[Page], None], station: Make, visit: Visit
) -> None:
    ends_driving(end, station, visit)


@pytest.mark.parametrize("end", [freeze, give_up, disarm])
def test_a_frozen_page_and_a_button_stop_within_the_lease(
    end: Callable[[Page], None], station: Make, visit: Visit
) -> None:
    ends_driving(end, station, visit)


def ends_driving(end: Callable[[Page], None], station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    end(page)
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    time.sleep(2 * LEASE_S)
    assert not here.driven, "it came back by itself"


@pytest.mark.both
def test_a_tab_that_is_really_hidden_stops_and_disarms(
    station: Make, hideable: Callable[[str], tuple[Page, Callable[[], Page]]]
) -> None:
    here = station()
    page, cover = hideable(here.url)
    arm(page)
    drive(here, page)
    other = cover()
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    until(lambda: not here.robot.facts.armed)
    assert page.evaluate("document.visibilityState") == "hidden"
    other.close()
    until(lambda: page.evaluate("document.visibilityState") == "visible")
    stays_stopped(here)


def test_a_page_that_hung_does_not_drive_on_with_a_held_button(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    hang(page, 1.5)
    until(lambda: not here.driven)
    before = here.speeds_sent()
    page.evaluate("0")  # answered once it no longer hangs
    stays_stopped(here)
    assert here.speeds_sent() == before


@pytest.mark.both
def test_one_press_of_stop_is_one(station: Make, visit: Visit) -> None:
    _, page = armed(station, visit)
    stops = page.locator("#events li", has_text="STOP was pressed")
    page.locator("#stop").click()
    expect(stops).to_have_count(1)
    page.locator("#stop").focus()
    page.keyboard.press("Enter")
    expect(stops).to_have_count(2)
    time.sleep(0.5)
    assert stops.count() == 2


@pytest.mark.both
def test_a_stop_without_connection_is_shown_and_sent_later(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    here.stop_serving()
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")
    page.locator("#stop").click()
    expect(page.locator("#banner-title")).to_have_text("STOP NOT CONFIRMED")
    station(place=Place(port=here.port))
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    expect(page.locator("#events li", has_text="STOP was pressed")).to_have_count(1)


def test_disarmed_is_shown_on_every_page(station: Make, visit: Visit) -> None:
    here = station()
    first, second = visit(here.url), visit(here.url)
    ready(second)
    expect(second.locator("#banner-title")).to_have_text("DISARMED")
    expect(second.locator("#banner")).to_have_attribute("data-level", "calm")
    arm(first)
    expect(second.locator("#banner-title")).to_have_text("ARMED")


def test_a_closed_page_disarms_and_releases_control(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.close()
    until(lambda: not here.robot.facts.armed)
    other = visit(here.url)
    expect(other.locator("#control")).to_have_text("Control: nobody")


def test_the_dashboard_s_end_stops_the_robot(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    here.stop_serving()
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")


def test_a_server_that_hangs_stops_the_robot_within_the_lease(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    step = here.hub.step
    begun_s = time.monotonic()

    def hang() -> None:
        here.hub.step = step
        time.sleep(1.5)

    here.hub.step = hang
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    time.sleep(1.5)
    assert not here.driven, "it drove on with a button that was held all the time"


def test_an_error_in_the_server_stops_the_robot_and_ends_it(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    begun_s = time.monotonic()

    def fail() -> None:
        raise RuntimeError("of this test")

    here.hub.step = fail
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    until(lambda: not here.robot.facts.armed)
    here.wait_for_end()
    assert str(here.hub.failure) == "of this test"


@pytest.mark.both
def test_a_page_comes_back_to_a_new_dashboard_and_moves_nothing(
    station: Make, visit: Visit
) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    here.stop_serving()
    again = station(place=Place(port=here.port))
    ready(page)
    expect(page.locator("#control")).to_have_text("Control: nobody")
    expect(page.locator("#address")).to_have_text(again.sim.address)
    time.sleep(2 * LEASE_S)
    assert again.speeds_sent() == 0
    assert not again.robot.facts.armed


def test_a_page_without_the_new_token_says_what_to_do(station: Make, visit: Visit) -> None:
    here = station(rules=Rules("the-token-of-before"))
    page = visit(f"{here.url}?token=the-token-of-before", forgive="403")
    ready(page)
    here.stop_serving()
    station(place=Place(port=here.port), rules=Rules("the-token-of-now"))
    expect(page.locator("#banner-text")).to_contain_text("open the link that the dashboard printed")


def test_a_page_that_is_one_too_many_says_so(station: Make, visit: Visit) -> None:
    here = station()
    with contextlib.ExitStack() as opened:
        for _ in range(MOST_PAGES):
            opened.enter_context(Visitor(here)).receive()
        page = visit(here.url)
        expect(page.locator("#banner-text")).to_contain_text("oo many pages are open")
    ready(page)


# ---- what does not move it ----


def let_go(page: Page) -> None:
    page.evaluate("hold(0, 0)")
    expect(page.locator("#pad-text")).to_contain_text("hold [A]")


@pytest.mark.both
def test_what_was_held_when_the_page_was_left_must_be_let_go(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    page.evaluate("document.hasFocus = () => false; dispatchEvent(new Event('blur'))")
    until(lambda: not here.driven)
    before = here.speeds_sent()
    page.evaluate("document.hasFocus = () => true; dispatchEvent(new Event('focus'))")
    expect(page.locator("#pad-text")).to_contain_text("let [A] go once")
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before
    let_go(page)
    drive(here, page)


def test_another_pad_must_be_let_go_first(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    page.evaluate("makePad(1); hold(0, 1); hold(7, 1)")
    until(lambda: not here.driven)
    before = here.speeds_sent()
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before
    let_go(page)
    drive(here, page)


def test_a_key_that_was_held_elsewhere_does_nothing(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.evaluate(
        "for (let count = 0; count < 20; count++)"
        " dispatchEvent(new KeyboardEvent('keydown', { code: 'KeyW', repeat: true }))"
    )
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0


def test_nothing_moves_it_before_arming(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    hold_pad(page, rt=1.0, lj=-1.0)
    page.keyboard.down("w")
    time.sleep(2 * LEASE_S)
    take_control(page)
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0


def test_inputs_must_be_released_once_after_arming(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    take_control(page)
    hold_pad(page, rt=1.0)
    page.get_by_role("button", name="Arm", exact=True).click()
    until(lambda: here.robot.facts.armed)
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0
    let_go(page)
    drive(here, page)


def test_the_pad_does_nothing_without_a(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    hold_pad(page, a=0.0, rt=1.0, lj=1.0)
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0


def test_the_page_says_where_a_browser_withholds_the_pad(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    # As on a page that came by plain HTTP from another machine.
    page.evaluate("Object.defineProperty(window, 'isSecureContext', { get: () => false })")
    take_control(page)
    expect(page.locator("#pad-text")).to_contain_text("Start with --tls-cert and --tls-key")


@pytest.mark.both
def test_a_second_page_drives_with_consent_only(station: Make, visit: Visit) -> None:
    here = station()
    first, second = visit(here.url), visit(here.url)
    call(first, "lab phone")
    call(second, "desk")
    arm(first)
    expect(second.locator("#control")).to_have_text("Control: lab phone")
    hold_pad(second, rt=1.0)
    second.get_by_role("button", name="Ask for control").click()
    expect(first.locator("#asked-by")).to_contain_text("\u201cdesk\u201d wants to drive")
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0
    assert here.robot.facts.armed
    first.get_by_role("button", name="Keep").click()
    expect(second.locator("#drive-why")).to_have_text("lab phone keeps control")
    second.get_by_role("button", name="Ask for control").click()
    first.get_by_role("button", name="Hand over").click()
    expect(second.locator("#control")).to_have_text("Control: this page")
    expect(first.locator("#control")).to_have_text("Control: desk")
    assert not here.robot.facts.armed
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == 0


def test_a_page_that_asked_gets_control_when_the_driver_is_gone(
    station: Make, visit: Visit
) -> None:
    here = station()
    first, second = visit(here.url), visit(here.url)
    arm(first)
    second.get_by_role("button", name="Ask for control").click()
    expect(second.get_by_role("button", name="Asked")).to_be_disabled()
    first.close()
    expect(second.locator("#control")).to_have_text("Control: this page")
    assert not here.robot.facts.armed


def test_every_page_can_stop(station: Make, visit: Visit) -> None:
    here = station()
    first, second = visit(here.url), visit(here.url)
    arm(first)
    drive(here, first)
    second.keyboard.press("Space")
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    assert not here.robot.facts.armed
    expect(first.locator("#banner-text")).to_contain_text(f"STOP was pressed on {NAME} 2")


def test_a_page_that_only_watches_sends_the_robot_nothing(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    page = visit(here.url)
    ready(page)
    expect(page.locator("#stop")).to_be_hidden()
    expect(page.get_by_role("button", name="Take control")).to_be_hidden()
    hold_pad(page, rt=1.0)
    page.keyboard.press("Space")
    page.keyboard.down("w")
    time.sleep(2 * LEASE_S)
    assert here.sim.state.speed_commands == 0


# ---- when the robot refuses ----


def test_override_disarms_and_is_shown(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    here.sim.set("pad_a", True)
    expect(page.locator("#banner-title")).to_have_text("OVERRIDE")
    here.sim.set("pad_a", False)
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    before = here.speeds_sent()
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before, "the old command came back"


def test_inhibited_motion_disarms_and_is_shown(station: Make, visit: Visit) -> None:
    here = station(lease_s=1.0)
    here.sim.set("estop_remote", True)
    page = visit(here.url)
    arm(page)
    here.wait_until_inhibited(page)
    expect(page.locator("#banner-text")).to_contain_text(
        "did not follow its commands: check emergency stops"
    )
    expect(page.locator("#banner-title")).to_have_text("DISARMED")  # nothing is commanded now
    expect(page.locator("#events")).to_contain_text("motion inhibited")
    assert not here.robot.facts.armed
    here.sim.set("estop_remote", False)
    here.sim.set("motor_button", True)
    time.sleep(2 * LEASE_S)
    assert not here.driven


def test_a_lost_robot_is_shown_and_comes_back_disarmed(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    drive(here, page)
    here.sim.set("power", False)
    expect(page.locator("#banner")).to_contain_text("ROBOT LOST")
    expect(page.locator("#quality-say")).to_have_text(re.compile(r"^Lost"))
    page.locator("#stop").click()  # whose zeros nobody confirms
    expect(page.locator("#banner-title")).to_have_text("STOP NOT CONFIRMED")
    expect(page.locator("#banner-text")).to_contain_text("press the robot\u2019s emergency stop")
    expect(page.locator("#banner-more")).to_have_text("ROBOT LOST")
    here.sim.set("power", True)
    ready(page)
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    before = here.speeds_sent()
    time.sleep(2 * LEASE_S)
    assert here.speeds_sent() == before
