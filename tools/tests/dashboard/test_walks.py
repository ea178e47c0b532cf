# SPDX-License-Identifier: MIT
"""What an operator does, from docs/dashboard.md: with a keyboard alone, and on a phone.

Take control, drive a square, stop for an obstacle, hand over control, export the record.
"""

import csv
import math
import time
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from station import LEASE_S, PATIENCE_S, Finger, Station, press_arm, ready, until

Visit = Callable[..., Page]
Make = Callable[..., Station]
Act = Callable[[], object]

SIDE_M = 0.8
CORNER_RAD = 1.4
ROOM_M = 3.5
NEAR_M = 1.5


def room(station: Make) -> Station:
    """A robot between four walls."""
    here = station(slip=0.0)
    for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        here.sim.add_wall(*(ROOM_M * (x - y), ROOM_M * (y - x), ROOM_M * (x + y), ROOM_M * (y + x)))
    return here


def drive_until(done: Callable[[], bool], here: Station, page: Page, hold: Act, lift: Act) -> None:
    """Hold until it is done; again, where a stall of a loaded machine ended that."""
    end = time.monotonic() + 3 * PATIENCE_S
    while not done():
        assert time.monotonic() < end, page.locator("#drive-why").text_content()
        press_arm(page)
        hold()
        begun_s = time.monotonic()
        while not done() and (here.driven or time.monotonic() - begun_s < 2 * LEASE_S):
            page.wait_for_timeout(10)
        lift()
        until(lambda: not here.driven)


def drive_a_square(here: Station, page: Page, ahead: Act, left: Act, lift: Act) -> None:
    for _ in range(4):
        begun = here.robot.localization

        def side(begun: Any = begun) -> bool:
            now = here.robot.localization
            return math.hypot(now.x_m - begun.x_m, now.y_m - begun.y_m) > SIDE_M

        def corner(begun: Any = begun) -> bool:
            now = here.robot.localization
            return abs(math.remainder(now.theta_rad - begun.theta_rad, math.tau)) > CORNER_RAD

        drive_until(side, here, page, ahead, lift)
        drive_until(corner, here, page, left, lift)


def stop_for_a_wall(here: Station, page: Page, ahead: Act, stop: Act, lift: Act) -> None:
    def near() -> bool:
        return min(here.robot.telemeter.distances_m[0], 9.0) < NEAR_M

    drive_until(near, here, page, ahead, stop)
    lift()
    until(lambda: not here.robot.facts.armed)
    until(lambda: abs(here.sim.state.wheel_linear_m_s) < 0.01)
    assert not here.robot.facts.front_bumper
    expect(page.locator("#banner-text")).to_contain_text("STOP was pressed")


def check_record(path: Any) -> None:
    with open(path, encoding="utf-8", newline="") as lines:
        xs = [row["localization_x_m"] for row in csv.DictReader(lines)]
    assert max(float(x) for x in xs if x) > SIDE_M - 0.1


def tab_to(page: Page, name: str) -> None:
    """Press Tab until an element has the focus."""
    for _ in range(60):
        if page.evaluate("document.activeElement.id") == name:
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"no Tab reaches {name}")


def test_a_tour_with_only_a_keyboard(station: Make, visit: Visit) -> None:
    here = room(station)
    page, other = visit(here.url), visit(here.url)
    ready(page)
    page.keyboard.press("r")
    expect(page.locator("#recording")).to_be_visible()
    tab_to(page, "take")
    page.keyboard.press("Enter")
    expect(page.locator("#arm")).to_be_focused()
    page.keyboard.press("Enter")
    tab_to(page, "scale")
    page.keyboard.press("End")
    keyboard = page.keyboard

    def lift() -> None:
        keyboard.up("w")
        keyboard.up("a")

    drive_a_square(here, page, lambda: keyboard.down("w"), lambda: keyboard.down("a"), lift)
    stop_for_a_wall(here, page, lambda: keyboard.down("w"), lambda: keyboard.press("Space"), lift)
    ready(other)
    tab_to(other, "take")
    other.keyboard.press("Enter")
    expect(page.locator("#asked-by")).to_contain_text(" 2\u201d wants to drive")
    tab_to(page, "hand-over")
    page.keyboard.press("Enter")
    expect(other.locator("#control")).to_have_text("Control: this page")
    page.keyboard.press("e")
    tab_to(page, "record")
    page.keyboard.press("Enter")
    expect(page.locator("#recording")).to_be_hidden()
    tab_to(page, "record-csv")
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    check_record(download.value.path())


@pytest.mark.parametrize("size", [(390, 844), (844, 390)])
def test_a_tour_on_a_phone(size: tuple[int, int], station: Make, visit: Visit) -> None:
    here = room(station)
    phone = {
        "viewport": {"width": size[0], "height": size[1]},
        "has_touch": True,
        "is_mobile": True,
    }
    page, other = visit(here.url, **phone), visit(here.url, **phone)
    ready(page)
    page.locator("#tab-events").tap()
    page.locator("#record").tap()
    expect(page.locator("#recording")).to_be_visible()
    page.locator("#tab-events").tap()
    page.locator("#take").tap()
    page.locator("#arm").tap()
    box = page.locator("#scale").bounding_box()
    assert box is not None
    page.touchscreen.tap(box["x"] + box["width"] - 4, box["y"] + box["height"] / 2)
    expect(page.locator("#scale-text")).to_contain_text("1.00")
    box = page.locator("#stick").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    finger = Finger(page)

    def push(dx: float, dy: float) -> None:
        finger.down(x, y)
        finger.move(x + dx, y + dy)

    drive_a_square(here, page, lambda: push(0, -90), lambda: push(-90, 0), finger.up)
    box = page.locator("#stop").bounding_box()
    assert box is not None
    on_stop = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    stop_for_a_wall(
        here, page, lambda: push(0, -90), lambda: finger.press_beside(*on_stop), finger.up
    )
    ready(other)
    other.locator("#take").tap()
    page.locator("#hand-over").tap()
    expect(other.locator("#control")).to_have_text("Control: this page")
    page.locator("#tab-events").tap()
    page.locator("#record").tap()
    expect(page.locator("#recording")).to_be_hidden()
    with page.expect_download() as download:
        page.locator("#record-csv").tap()
    check_record(download.value.path())
