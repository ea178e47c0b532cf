# SPDX-License-Identifier: MIT
"""Stick and STOP stay where a finger or an eye expects them, whatever else the page shows."""

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from station import LEASE_S, Finger, Station, arm, drive, open_tab, ready, take_control, until

Visit = Callable[..., Page]
Make = Callable[..., Station]

SIZES = [(1440, 900), (1024, 768), (1024, 600), (844, 390), (390, 844), (360, 640)]
PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 844},
    "has_touch": True,
    "is_mobile": True,
}
PUSHED_PX = 30


def middle(page: Page) -> tuple[float, float]:
    box = page.locator("#stick").bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def hold_stick(here: Station, page: Page, finger: Finger) -> float:
    """Push the stick ahead by finger until the robot is driven; return the speed."""
    x, y = middle(page)

    def hold() -> None:
        finger.down(x, y)
        finger.move(x, y - PUSHED_PX)

    here.wait_until_driven(page, hold, finger.up)
    return here.sim.state.last_linear_m_s


def test_a_stick_begins_where_it_is_touched(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, **PHONE)
    arm(page)
    x, y = middle(page)
    finger = Finger(page)
    finger.down(x + 40, y - 40)
    page.wait_for_timeout(2000 * LEASE_S)
    assert here.speeds_sent() == 0, "a touch is no deflection"
    finger.up()
    hold_stick(here, page, finger)
    assert here.sim.state.last_angular_rad_s == 0


def test_a_layout_that_moves_changes_no_speed(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, **PHONE)
    arm(page)
    finger = Finger(page)
    speed = hold_stick(here, page, finger)
    x, y = middle(page)
    page.evaluate(
        "document.getElementById('stick').style.transform = 'translateY(60px)'"
    )  # as anything might
    page.wait_for_timeout(300)
    finger.move(x + 1, y - PUSHED_PX)  # a finger is never quite still
    page.wait_for_timeout(2000 * LEASE_S)
    assert here.sim.state.last_linear_m_s == pytest.approx(speed, abs=1e-6)


def test_another_size_releases_the_stick(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, **PHONE)
    arm(page)
    hold_stick(here, page, Finger(page))
    page.set_viewport_size({"width": 844, "height": 390})
    until(lambda: not here.driven)
    page.wait_for_timeout(2000 * LEASE_S)
    assert not here.driven


def test_a_second_finger_stops_while_the_first_drives(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, **PHONE)
    arm(page)
    finger = Finger(page)
    hold_stick(here, page, finger)
    box = page.locator("#stop").bounding_box()
    assert box is not None
    finger.press_beside(box["x"] + 40, box["y"] + 20)
    here.wait_for_stop_pressed()


def boxes(page: Page) -> list[Any]:
    return [page.locator(name).bounding_box() for name in ("#stick", "#stop", "#scale")]


def resize(page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_function("(width) => innerWidth === width", arg=size[0])


def boxes_in_every_size(page: Page) -> list[Any]:
    found = []
    for size in SIZES:
        resize(page, size)
        found.append(boxes(page))
    return found


@pytest.mark.both
def test_no_warning_moves_stick_or_stop(station: Make, visit: Visit) -> None:
    here = station(battery_percent=60.0)
    page = visit(here.url)
    arm(page)
    before = boxes_in_every_size(page)
    for warn, title in (
        (lambda: here.sim.set("battery_percent", 5.0), "BATTERY"),
        (lambda: here.sim.set("front_bumper", True), "BUMPER"),
        (lambda: here.sim.set("pad_a", True), "OVERRIDE"),
        (lambda: here.sim.set("power", False), "LOST"),
    ):
        warn()
        expect(page.locator("#banner")).to_contain_text(title)
        assert boxes_in_every_size(page) == before, title


SEEN = """(name) => {
    const box = document.getElementById(name).getBoundingClientRect();
    const seen = (x, y) => document.elementFromPoint(x, y)?.closest(`#${name}`);
    return box.height >= 30 && [box.left + 8, box.left + box.width / 2, box.right - 8]
        .every((x) => [box.top + 4, box.bottom - 4].every((y) => seen(x, y)));
}"""


@pytest.mark.both
def test_stop_is_seen_whole_in_every_size(station: Make, visit: Visit) -> None:
    here = station(panel=True)
    page = visit(here.url)
    ready(page)
    places = []
    for prepare in (
        lambda: None,
        lambda: take_control(page),
        lambda: page.mouse.wheel(0, 900),
        lambda: open_tab(page, "sim"),
    ):
        prepare()
        places.append([])
        for size in SIZES:
            resize(page, size)
            places[-1].append(page.locator("#stop").bounding_box())
            assert page.evaluate(SEEN, "stop"), size
            assert places[-1][-1]["height"] >= 48
    assert places[1:] == places[:-1], "it moved"


def test_who_asks_for_control_is_answered_in_every_size(station: Make, visit: Visit) -> None:
    here = station()
    page, other = visit(here.url, has_touch=True), visit(here.url)
    arm(page)
    other.locator("#take").click()
    expect(page.locator("#asked-by")).to_be_visible()
    for size in SIZES:
        resize(page, size)
        for name in ("hand-over", "keep"):
            assert page.evaluate(SEEN, name), (size, name)


# In Firefox: test_firefox.py.
def test_a_finger_presses_stop(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, viewport={"width": 844, "height": 390}, has_touch=True)
    arm(page)
    drive(here, page)
    page.locator("#stop").tap()
    here.wait_for_stop_pressed()


@pytest.mark.both
def test_space_switches_a_check_box_and_stops_elsewhere(station: Make, visit: Visit) -> None:
    here = station(panel=True)
    page = visit(here.url)
    arm(page)
    open_tab(page, "sim")
    page.locator("#sim input[name=estop_local]").focus()
    page.keyboard.press("Space")
    until(lambda: here.sim.state.estop_local)
    page.wait_for_timeout(300)
    assert here.robot.facts.armed
    page.locator("#scale").focus()
    page.keyboard.press("Space")
    until(lambda: not here.robot.facts.armed)
