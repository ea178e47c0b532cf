# SPDX-License-Identifier: MIT
"""Driving from the page: what moves the robot, and everything that stops it."""

import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect
from station import (
    LB,
    LEASE_S,
    MARGIN_S,
    NAME,
    RB,
    WITHIN_S,
    B,
    Finger,
    Station,
    arm,
    drive,
    hang,
    hold_pad,
    open_tab,
    press_arm,
    ready,
    stays_stopped,
    take_control,
    until,
)

from roburoc4_tools.dashboard.server import Place

Visit = Callable[..., Page]
Make = Callable[..., Station]
Opened = Callable[..., tuple[Station, Page]]
FIRST_S = 0.7
"""What a key has until its first repeat."""
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


# ---- what moves it ----


@pytest.mark.both
def test_a_game_pad_drives_as_in_the_manual(armed: Opened) -> None:
    here, page = armed(lease_s=1.0)
    for held, linear, angular in (
        ({"rt": 1.0}, 0.3, 0.0),
        ({"lt": 1.0}, -0.3, 0.0),
        ({"lj": -1.0}, 0.0, 0.3),
        ({"lj": 1.0}, 0.0, -0.3),
    ):
        drive(here, page, **held)
        until(
            lambda linear=linear, angular=angular: (
                here.sim.state.last_linear_m_s == pytest.approx(linear, abs=1e-3)
                and here.sim.state.last_angular_rad_s == pytest.approx(angular, abs=1e-3)
            )
        )
    expect(page.locator("#asked")).to_contain_text("by game pad")


def drive_by_keys(here: Station, page: Page, *keys: str) -> None:
    here.wait_until_driven(
        page,
        lambda: [page.keyboard.down(key) for key in keys],
        lambda: [page.keyboard.up(key) for key in keys],
    )


@pytest.mark.both
def test_keys_drive_while_they_repeat_and_letting_go_stops(armed: Opened) -> None:
    here, page = armed()
    drive_by_keys(here, page, "w", "ArrowLeft")
    assert here.sim.state.last_linear_m_s > 0
    assert here.sim.state.last_angular_rad_s > 0
    expect(page.locator("#banner-title")).to_have_text("DRIVING")
    expect(page.locator("kbd", has_text="W")).to_have_attribute("data-held", "true")
    page.keyboard.up("ArrowLeft")
    until(lambda: here.sim.state.last_angular_rad_s == 0)
    page.keyboard.up("w")
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S
    drive_by_keys(here, page, "w")
    page.evaluate("repeats = false")  # its release was lost
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S
    expect(page.locator("#drive-why")).to_contain_text("the key stopped repeating")
    page.evaluate("repeats = true")
    stays_stopped(here)
    page.keyboard.up("w")
    press_arm(page)
    page.evaluate("repeats = false")
    before = here.speeds_sent()
    page.keyboard.down("w")
    begun_s = time.monotonic()
    until(lambda: here.speeds_sent() > before)
    assert here.wait_until_stopped(begun_s) < FIRST_S + MARGIN_S


@pytest.mark.both
def test_the_stick_drives_and_letting_go_stops(armed: Opened) -> None:
    here, page = armed()
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
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S


def test_the_pad_stops_and_changes_the_speed(armed: Opened) -> None:
    here, page = armed()
    page.evaluate("makePad()")
    expect(page.locator("#pad-text")).to_contain_text("[B] STOP")
    for button, value in ((RB, "35"), (RB, "40"), (LB, "35")):
        page.evaluate(f"hold({button}, 1)")
        expect(page.locator("#scale")).to_have_value(value)
        page.evaluate(f"hold({button}, 0)")
        page.wait_for_timeout(300)
    drive(here, page)
    page.evaluate(f"hold({B}, 1)")
    here.wait_for_stop_pressed()


def test_a_finger_drives_from_where_it_touched_and_a_second_one_stops(armed: Opened) -> None:
    here, page = armed(page=PHONE)
    finger = Finger(page)

    def middle(name: str) -> tuple[float, float]:
        box = page.locator(name).bounding_box()
        assert box is not None
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    x, y = middle("#stick")

    def hold() -> None:
        finger.down(x, y)
        finger.move(x, y - 30)

    finger.down(x + 40, y - 40)
    page.wait_for_timeout(1000 * LEASE_S)
    assert here.speeds_sent() == 0, "a touch is no deflection"
    finger.up()
    here.wait_until_driven(page, hold, finger.up)
    state = here.sim.state
    assert state.last_angular_rad_s == 0
    page.evaluate("document.getElementById('stick').style.transform = 'translateY(60px)'")
    finger.move(x + 1, y - 30)  # a finger is never quite still
    page.wait_for_timeout(1000 * LEASE_S)
    assert here.sim.state.last_linear_m_s == pytest.approx(state.last_linear_m_s, abs=1e-6)
    page.evaluate("document.getElementById('stick').style.transform = ''")
    page.set_viewport_size({"width": 844, "height": 390})
    until(lambda: not here.driven)  # another size releases the stick
    stays_stopped(here)
    finger.up()
    page.set_viewport_size({"width": 390, "height": 844})
    here.wait_until_driven(page, hold, finger.up)
    finger.press_beside(*middle("#stop"))
    here.wait_for_stop_pressed()


# ---- what stops it ----


def press_enter_on_stop(page: Page) -> None:
    page.locator("#stop").focus()
    page.keyboard.press("Enter")


ENDS: dict[str, Callable[[Page], object]] = {
    "[A] is released": lambda page: page.evaluate("hold(0, 0)"),
    "the pad is unplugged": lambda page: page.evaluate("window.pad = null; 0"),
    "there is another pad": lambda page: page.evaluate("makePad(1); hold(0, 1); hold(7, 1)"),
    "the window is left": lambda page: page.evaluate("dispatchEvent(new Event('blur'))"),
    "the page has no focus": lambda page: page.evaluate("document.hasFocus = () => false; 0"),
    "the page hangs": hang,
    "STOP is clicked": lambda page: page.locator("#stop").click(),
    "STOP is pressed by key": press_enter_on_stop,
    "space is pressed": lambda page: page.keyboard.press("Space"),
    "Disarm": lambda page: page.get_by_role("button", name="Disarm", exact=True).click(),
    "Give back": lambda page: page.get_by_role("button", name="Give back").click(),
}


@pytest.mark.both
def test_everything_that_ends_driving_stops_within_the_lease(armed: Opened) -> None:
    here, page = armed()
    for what, end in ENDS.items():
        if page.locator("#take").is_visible():
            take_control(page)
        press_arm(page)
        drive(here, page)
        end(page)
        assert here.wait_until_stopped(time.monotonic()) < WITHIN_S, what
        page.evaluate("document.hasFocus = () => true; dispatchEvent(new Event('focus'))")
        stays_stopped(here)  # with whatever is still held
        page.evaluate("window.pad = null; 0")
        page.wait_for_timeout(200)
    events = page.locator("#events li", has_text="STOP was pressed")
    assert events.count() == 3, "one press of STOP is one"
    take_control(page)
    press_arm(page)
    drive(here, page)
    page.close()
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S
    until(lambda: here.hub.control.driver is None)
    assert not here.robot.facts.armed


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


HIDES = {
    "a menu": """(() => {
        const menu = new MouseEvent("contextmenu", { bubbles: true, cancelable: true });
        return !document.getElementById("map").dispatchEvent(menu);
    })()""",
    "a drag": """!document.body.dispatchEvent(
        new DragEvent("dragstart", { bubbles: true, cancelable: true }))""",
    "Command": """dispatchEvent(
        new KeyboardEvent("keydown", { code: "MetaLeft", metaKey: true }))""",
}


def test_what_may_hide_a_key_s_release_counts_as_its_release(armed: Opened) -> None:
    here, page = armed()
    held = "for (let n = 0; n < 20; n++) dispatchEvent(new KeyboardEvent('keydown', {0}))"
    page.evaluate(held.replace("{0}", "{ code: 'KeyW', repeat: true }"))
    stays_stopped(here)  # as that key was pressed elsewhere
    for what, happens in HIDES.items():
        drive_by_keys(here, page, "w")
        assert page.evaluate(happens), f"{what} would hear the key's release"
        assert here.wait_until_stopped(time.monotonic()) < WITHIN_S, what
        stays_stopped(here)
        page.keyboard.up("w")


def test_nothing_moves_it_before_it_is_armed_and_everything_was_released(watched: Opened) -> None:
    here, page = watched()
    page.keyboard.down("w")
    take_control(page)
    hold_pad(page, rt=1.0, lj=-1.0)
    expect(page.locator("#asked")).to_have_text("game pad: not sent")
    page.get_by_role("button", name="Arm", exact=True).click()
    until(lambda: here.robot.facts.armed)
    time.sleep(LEASE_S)
    page.keyboard.up("w")
    hold_pad(page, a=0.0, rt=1.0, lj=1.0)
    time.sleep(LEASE_S)
    assert here.speeds_sent() == 0
    drive(here, page)


def test_keys_that_are_typed_do_not_drive(armed: Opened) -> None:
    here, page = armed()
    open_tab(page, "events")
    page.locator("#events-text").focus()
    page.keyboard.down("w")
    stays_stopped(here)
    expect(page.locator("#events-text")).to_have_value("w")


@pytest.mark.parametrize("field", ["#events-text", "#events-level", "#scale"])
def test_space_stops_from_every_field(field: str, armed: Opened) -> None:
    here, page = armed()
    open_tab(page, "events")
    page.locator(field).focus()
    page.keyboard.press("Space")
    here.wait_for_stop_pressed()
    here.sim.set("pad_a", True)
    until(lambda: here.robot.facts.overridden)
    here.sim.set("pad_rt", 0.0)
    expect(page.locator("#banner-text")).to_contain_text("The robot moves")
    page.keyboard.press("Space")  # what is driven by another one is stopped, too
    expect(page.locator("#events li", has_text="STOP was pressed")).to_have_count(2)


def test_a_field_takes_spaces_while_nothing_can_move(watched: Opened) -> None:
    _, page = watched()
    open_tab(page, "events")
    page.locator("#events-text").focus()
    page.keyboard.type("a b")
    expect(page.locator("#events-text")).to_have_value("a b")
    expect(page.locator("#events")).not_to_contain_text("STOP was pressed")


def test_a_stop_without_connection_is_shown_and_sent_later_and_nothing_moves(
    armed: Opened, station: Make
) -> None:
    here, page = armed()
    drive(here, page)
    page.locator("#map-relocalize").click()
    here.stop_serving()
    expect(page.locator("#banner-title")).to_have_text("NO CONNECTION TO THE DASHBOARD")
    expect(page.locator("#mode")).to_have_text("UNKNOWN")
    expect(page.locator("#control")).to_have_text("Control: not known")
    expect(page.locator("#drive-why")).to_contain_text("Nothing can be driven from here")
    expect(page.locator("#knob")).not_to_have_attribute("style", "translate")
    for name in ("#relocalize", "#map-relocalize"):
        expect(page.locator(name)).to_be_hidden()
    for name in ("#arm", "#record"):
        expect(page.locator(name)).to_be_disabled()
    page.locator("#stop").click()
    expect(page.locator("#banner-title")).to_have_text("STOP NOT CONFIRMED")
    again = station(place=Place(port=here.port))
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    expect(page.locator("#events li", has_text="STOP was pressed")).to_have_count(1)
    expect(page.locator("#address")).to_have_text(again.sim.address)
    expect(page.locator("#control")).to_have_text("Control: nobody")
    assert again.speeds_sent() == 0
    assert not again.robot.facts.armed


# ---- who drives ----


def test_a_second_page_drives_with_consent_only_and_every_page_can_stop(
    station: Make, visit: Visit
) -> None:
    here = station()
    first, second = visit(here.url), visit(here.url)
    ready(first)
    ready(second)
    open_tab(first, "link")
    first.get_by_label("This page is called").fill("lab phone")
    first.keyboard.press("Tab")
    arm(first)
    expect(second.locator("#control")).to_have_text("Control: lab phone")
    expect(second.locator("#banner-title")).to_have_text("ARMED")
    hold_pad(second, rt=1.0)
    second.get_by_role("button", name="Ask for control").click()
    expect(first.locator("#asked-by")).to_contain_text(f"\u201c{NAME} 2\u201d wants to drive")
    stays_stopped(here)
    assert here.robot.facts.armed
    first.get_by_role("button", name="Keep").click()
    expect(second.locator("#drive-why")).to_have_text("lab phone keeps control")
    second.get_by_role("button", name="Ask for control").click()
    first.get_by_role("button", name="Hand over").click()
    expect(second.locator("#control")).to_have_text("Control: this page")
    assert not here.robot.facts.armed
    stays_stopped(here)
    second.evaluate("hold(0, 0)")
    press_arm(second)
    drive(here, second)
    first.keyboard.press("Space")
    here.wait_for_stop_pressed()
    expect(second.locator("#banner-text")).to_contain_text("STOP was pressed on lab phone")
    first.reload()
    ready(first)
    until(lambda: "lab phone" in [page.name for page in here.hub.pages])


@pytest.mark.parametrize("by_key", [False, True])
def test_one_press_takes_control_and_does_not_arm(by_key: bool, watched: Opened) -> None:
    here, page = watched()
    if by_key:
        page.locator("#take").focus()
        page.keyboard.down("Enter")
        expect(page.locator("#arm")).to_be_focused()
        page.keyboard.down("Enter")  # as the keyboard repeats it
        page.keyboard.up("Enter")
    else:
        page.locator("#take").dblclick()
    expect(page.locator("#control")).to_have_text("Control: this page")
    page.wait_for_timeout(500)
    assert here.hub.control.driver is not None
    assert not here.robot.facts.armed


def test_control_arm_and_drive_by_key_alone(watched: Opened) -> None:
    here, page = watched()
    page.locator("#take").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#arm")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#disarm")).to_be_focused()
    page.locator("#scale").click(position={"x": 5, "y": 10})
    value = page.locator("#scale").input_value()
    drive_by_keys(here, page, "ArrowUp")
    assert page.locator("#scale").input_value() == value, "a clicked slider keeps no arrow keys"
    page.keyboard.up("ArrowUp")
    page.locator("#scale").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#scale")).not_to_have_value(value)
