# SPDX-License-Identifier: MIT
"""Stick and STOP stay where a finger or an eye expects them, whatever else the page shows."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, Playwright, expect
from station import (
    CHROMIUM,
    LEASE_S,
    SHOWS,
    Finger,
    Station,
    arm,
    drive,
    open_tab,
    press_arm,
    ready,
    take_control,
    until,
)

Visit = Callable[..., Page]
Make = Callable[..., Station]

SMALL = [(720, 450), (683, 384), (667, 375), (512, 384), (320, 568)]
"""A laptop at 200 % zoom, and small phones."""
SIZES = [(1440, 900), (1024, 768), (1024, 600), (844, 390), (390, 844), (360, 640), *SMALL]
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


APART = """(name) => {
    const box = document.getElementById(name).getBoundingClientRect();
    const over = (other) => Math.min(box.right, other.right) > Math.max(box.left, other.left) + 1
        && Math.min(box.bottom, other.bottom) > Math.max(box.top, other.top) + 1;
    return [...document.querySelectorAll("#stop, #stick, #map, .speed, #scale, #banner, #take, "
        + "#arm, #disarm, #leave, .tabs")]
        .filter((node) => node.id !== name && node.checkVisibility())
        .filter((node) => over(node.getBoundingClientRect()))
        .map((node) => node.id || node.className);
}"""
READABLE = """(node) => {
    const box = node.getBoundingClientRect();
    const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    return node.scrollWidth <= node.clientWidth + 1 || top === node;
}"""
TOO_SMALL = """() => [...document.querySelectorAll("button, input, select, summary, a")]
    .filter((node) => node.checkVisibility({ visibilityProperty: true }))
    .map((node) => (node.type === "checkbox" ? node.closest("label") : node))
    .map((node) => [node.id || node.textContent, node.getBoundingClientRect()])
    .filter(([, box]) => box.width < 43.5 || box.height < 43.5)
    .map(([name, box]) => `${name}: ${box.width} by ${box.height}`)
"""
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


@pytest.mark.parametrize("touch", [False, True])
def test_everything_that_drives_is_whole_in_every_small_size(
    touch: bool, station: Make, visit: Visit
) -> None:
    here = station(panel=True, battery_percent=3.0)
    page = visit(here.url, has_touch=touch, is_mobile=touch)
    arm(page)
    for width, height in [*SMALL, (390, 844), (844, 390)]:
        resize(page, (width, height))
        for name in ("#stop", "#stick", "#map", "#disarm", "#banner", "#scale", "#name", "#mode"):
            expect(page.locator(name)).to_be_in_viewport(ratio=0.99)
        for name in ("stop", "stick", "scale"):
            assert page.evaluate(APART, name) == [], (name, width, height)
        for value in page.locator(".speed .value").all():
            assert value.evaluate(READABLE), (width, height)
        chart = page.locator("#map").bounding_box()
        assert chart is not None
        assert chart["height"] >= height / 3 - 1, (width, height)
        assert chart["width"] >= width / 3 - 1, (width, height)
        assert page.evaluate("document.documentElement.scrollWidth") <= width


WORST: dict[str, dict[str, Any]] = {
    "alarms": {
        "facts": {"other_commander": True, "inhibited": True, "pose_error": True, "at_rest": False},
        "speeds": [-1.0, -1.28, 0.2, -0.35],
        "battery": {"state": "critical"},
    },
    "others": {
        "driver": 99,
        "driver_name": "phone of the laboratory, Anna",
        "recording": {"on": True, "seconds": 1, "statuses": 1, "lost": 0, "why": "", "forms": []},
    },
}
WITHIN = """() => {
    const inside = (box, room) => box.left >= room.left - 1 && box.right <= room.right + 1
        && box.top >= room.top - 1 && box.bottom <= room.bottom + 1;
    const screen = new DOMRect(0, 0, innerWidth, innerHeight);
    const seen = (node) => node.checkVisibility() && node.getBoundingClientRect().width > 1;
    const text = (node) => {
        const range = document.createRange();
        range.selectNodeContents(node);
        return range.getBoundingClientRect();
    };
    return [
        ...[...document.querySelectorAll(".top :is(h1, .tag, .mode, .chip), .speed *")].filter(seen)
            .filter((node) => !inside(node.getBoundingClientRect(), screen)),
        ...[...document.querySelectorAll(".drive button, #stop, .mode, .tag, .banner strong")]
            .filter(seen).filter((node) => !inside(text(node), node.closest("button, .top, .banner")
                .getBoundingClientRect())),
        ...[...document.querySelectorAll(".top > *, .top :is(.tag, .mode, .chip)")].filter(seen)
            .filter((node) => !inside(node.getBoundingClientRect(),
                document.querySelector(".top").getBoundingClientRect())),
        ...[document.querySelector("#banner-text > :last-child")].filter((node) => node.textContent)
            .filter((node) => !inside(text(node), document.getElementById("banner")
                .getBoundingClientRect())),
    ].map((node) => node.id || node.className || node.textContent);
}"""


@pytest.mark.parametrize("touch", [False, True])
def test_nothing_that_tells_is_cut_off_in_any_size(
    touch: bool, station: Make, visit: Visit
) -> None:
    here = station(robots=("RED", "BLUE"))
    page = visit(here.url, init=SHOWS, has_touch=touch, is_mobile=touch)
    ready(page)
    take_control(page)
    for name, frame in WORST.items():
        page.evaluate("(frame) => { window.wanted = frame; }", frame)
        if name == "alarms":
            expect(page.locator("#banner-title")).to_have_text("ANOTHER COMMANDER")
        else:
            expect(page.locator("#control")).to_contain_text("Anna")
        for size in SIZES:
            resize(page, size)
            page.wait_for_timeout(50)  # the banner is fitted when it has its size
            assert page.evaluate(WITHIN) == [], (name, size)


@pytest.mark.parametrize("touch", [False, True])
def test_whoever_chooses_a_place_sees_the_map_and_all_fields(
    touch: bool, station: Make, visit: Visit
) -> None:
    here = station(panel=True, lease_s=1.0)
    page = visit(here.url, init=SHOWS, has_touch=touch, is_mobile=touch)
    ready(page)
    take_control(page)
    page.evaluate("window.wanted = { facts: { armed: true }, why: '' }; 0")
    for what in ("go", "relocalize"):
        for size in SMALL:
            resize(page, size)
            page.locator(f"#map-{what}").click()
            for name in ("set", "cancel", "x", "y", "warning"):
                expect(page.locator(f"#relocalize-{name}")).to_be_in_viewport(ratio=0.99)
            chart = page.locator("#map").bounding_box()
            form = page.locator("#relocalize").bounding_box()
            assert chart is not None
            assert form is not None
            assert form["y"] - chart["y"] >= 60, (what, size)
            page.locator("#relocalize-cancel").click()


def test_no_tab_is_cut_off_at_its_side(station: Make, visit: Visit) -> None:
    page = visit(station(panel=True).url)
    ready(page)
    for size in SMALL:
        resize(page, size)
        for tab in ("plots", "events", "io", "link", "sim"):
            open_tab(page, tab)
            wide, room = page.locator(f"#panel-{tab}").evaluate(
                "(node) => [node.scrollWidth, node.clientWidth]"
            )
            assert wide <= room + 1, (size, tab)  # both are rounded


def test_targets_are_large_enough_for_fingers(station: Make, visit: Visit) -> None:
    here = station(panel=True, robots=("RED", "BLUE"))
    page = visit(here.url, has_touch=True, is_mobile=True)
    arm(page)
    for size in ((320, 568), (667, 375), (390, 844)):
        resize(page, size)
        for tab in ("plots", "events", "link", "sim", ""):
            if tab:
                open_tab(page, tab)
            else:
                page.locator("#tab-sim").click()
                page.locator("#map-relocalize").click()
            assert page.evaluate(TOO_SMALL) == [], (size, tab)
        page.keyboard.press("Escape")  # so that the next size begins with the map


def test_letters_grow_with_the_browser_s(playwright: Playwright, station: Make) -> None:
    here = station(panel=True)
    browser = playwright.chromium.launch(
        executable_path=CHROMIUM, args=["--no-sandbox", "--blink-settings=defaultFontSize=24"]
    )
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.goto(here.url)
    ready(page)
    size = page.locator("#banner-text").evaluate("(node) => getComputedStyle(node).fontSize")
    assert float(size.removesuffix("px")) == pytest.approx(14 * 1.5)
    for name in ("#stop", "#stick", "#map", "#take", "#banner", "#scale", "#name", "#mode"):
        expect(page.locator(name)).to_be_in_viewport(ratio=0.99)
    page.set_viewport_size({"width": 683, "height": 384})
    for name in ("#stop", "#stick", "#map", "#take", "#name", "#mode"):
        expect(page.locator(name)).to_be_in_viewport(ratio=0.99)
    browser.close()


def test_a_phone_that_stands_shows_the_whole_hint(station: Make, visit: Visit) -> None:
    page = visit(station().url, viewport={"width": 375, "height": 667}, has_touch=True)
    ready(page)
    take_control(page)
    expect(page.locator("#drive-why")).to_contain_text("Is the way clear")
    shown = "(node) => node.scrollHeight <= node.clientHeight + 1"
    assert page.locator("#drive-why").evaluate(shown)


CUT_OFF = """() => {
    const banner = document.getElementById("banner");
    // Another alarm, of a loaded machine, makes the names short again.
    if (innerWidth < 400 && !banner.classList.contains("names")) banner.click();
    const room = banner.getBoundingClientRect();
    return [...document.querySelectorAll("#banner-more li")].filter((node) => {
        const box = node.getBoundingClientRect();
        return box.top < room.top || box.bottom > room.bottom
            || node.scrollWidth > node.clientWidth + 1
            || parseFloat(getComputedStyle(node).fontSize) <= 8;
    }).map((node) => node.textContent);
}"""


@pytest.mark.parametrize("size", [*SMALL, (390, 844)])
def test_a_phone_shows_the_whole_hint_and_the_names_of_all_alarms(
    size: tuple[int, int], station: Make, visit: Visit
) -> None:
    here = station(battery_percent=3.0)
    page = visit(
        here.url, viewport={"width": size[0], "height": size[1]}, has_touch=True, is_mobile=True
    )
    ready(page)
    page.evaluate("makePad(); 0")
    whole = "(node) => !node.checkVisibility() || node.scrollHeight <= node.clientHeight + 1"
    take_control(page)
    expect(page.locator("#drive-why")).to_contain_text("Is the way clear")
    assert page.locator("#drive-why").evaluate(whole)
    press_arm(page)
    expect(page.locator("#drive-why")).to_contain_text("hold [A]")
    for name in ("#drive-why", "#pad-text"):
        assert page.locator(name).evaluate(whole), name
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
    here.sim.set("charger", True)
    expect(page.locator("#banner-more li")).to_have_text(["CHARGER PLUGGED IN", "BATTERY LOW"])
    if size[0] < 400:
        page.locator("#banner").tap()
    assert page.evaluate(CUT_OFF) == []


WHOLE = "(node) => node.checkVisibility() && node.scrollHeight <= node.clientHeight + 1"


@pytest.mark.parametrize("size", [*SMALL, (390, 844)])
def test_a_phone_shows_who_has_control_and_what_that_means_in_whole_sentences(
    size: tuple[int, int], station: Make, visit: Visit
) -> None:
    here = station(panel=True)
    page = visit(
        here.url,
        init=SHOWS,
        viewport={"width": size[0], "height": size[1]},
        has_touch=True,
        is_mobile=True,
    )
    ready(page)
    chip, why = page.locator("#control"), page.locator("#drive-why")
    if size != (512, 384):  # there it has no room beside the simulator's address
        expect(chip.locator("span").first).to_be_visible()
    assert chip.locator("span").last.evaluate("(node) => node.scrollWidth <= node.clientWidth")
    other = {"driver": 99, "driver_name": "Chrome on phone 2"}
    for frame, text in (
        (other, "STOP works"),
        ({**other, "relievable": True}, "drives nothing"),
    ):
        page.evaluate("(frame) => { window.wanted = frame; }", frame)
        expect(why).to_contain_text(text)
        assert why.evaluate(WHOLE), text
    page.evaluate("window.wanted = null; 0")
    take_control(page)
    page.evaluate("window.wanted = { facts: { armed: true }, going: [3, 0], going_m_s: 0.3 }; 0")
    expect(why).to_contain_text("leaving this page")
    assert why.evaluate(WHOLE)


def test_every_tab_is_within_the_page_in_every_small_size(station: Make, visit: Visit) -> None:
    page = visit(station(panel=True).url, has_touch=True, is_mobile=True)
    ready(page)
    for size in SMALL:
        resize(page, size)
        assert page.locator(".tabs").evaluate("(node) => node.scrollWidth <= node.clientWidth"), (
            size
        )


def test_what_drives_by_pad_and_key_has_room_on_a_desktop(station: Make, visit: Visit) -> None:
    page = visit(station().url, viewport={"width": 1366, "height": 768})
    ready(page)
    take_control(page)
    shown = "(node) => node.scrollHeight <= node.clientHeight + 1"
    for inputs in ("0", "makePad(); 0"):
        page.evaluate(inputs)
        page.wait_for_timeout(300)
        for name in ("#pad-text", ".settings"):
            assert page.locator(name).evaluate(shown), (name, inputs)


def test_why_a_key_no_longer_counts_can_be_read_whole(station: Make, visit: Visit) -> None:
    page = visit(station().url, viewport={"width": 1280, "height": 800})
    arm(page)
    page.evaluate("window.repeats = false; 0")
    page.keyboard.down("w")
    why = page.locator("#drive-why")
    expect(why).to_contain_text("the key stopped repeating")
    assert why.evaluate("(node) => node.scrollHeight - node.clientHeight") <= 0


def test_headings_miss_no_level_in_any_size(station: Make, visit: Visit) -> None:
    page = visit(station().url)
    ready(page)
    open_tab(page, "link")
    for size in SIZES:
        resize(page, size)
        levels = page.evaluate(
            """[...document.querySelectorAll("h1, h2, h3")].filter((node) => node.checkVisibility())
                .map((node) => Number(node.tagName[1]))"""
        )
        assert levels[0] == 1, size
        assert all(after <= before + 1 for before, after in itertools.pairwise(levels))


def test_tabs_do_not_jump_when_they_are_chosen(station: Make, visit: Visit) -> None:
    page = visit(station(panel=True).url)
    ready(page)
    places = []
    for name in ("plots", "events", "io", "link", "sim"):
        open_tab(page, name)
        places.append([tab.bounding_box() for tab in page.get_by_role("tab").all()])
    assert places[1:] == places[:-1]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_high_contrast_keeps_what_colour_tells(theme: str, station: Make, visit: Visit) -> None:
    page = visit(station().url, forced_colors="active")
    ready(page)
    arm(page)
    fills = "(node) => getComputedStyle(node).backgroundColor"
    assert page.locator("#mode").evaluate(fills) != page.locator("body").evaluate(fills)
    assert page.locator("#stop").evaluate(fills) == "rgb(192, 0, 24)"
    more = visit(page.url, contrast="more", color_scheme=theme)
    ready(more)
    expect(more.locator("html")).to_have_attribute("data-theme", theme)
    assert more.locator("#link-say").evaluate(
        "(node) => getComputedStyle(node).color"
    ) == more.locator("#asked").evaluate("(node) => getComputedStyle(node).color")
    grid, text = more.evaluate("""["--grid", "--text"].map((name) =>
        getComputedStyle(document.documentElement).getPropertyValue(name))""")
    assert grid != text, "the grid hides the robot"
    bar = more.locator(".speed .bar").first
    assert bar.evaluate(fills) != bar.evaluate(
        "(node) => getComputedStyle(node, '::before').backgroundColor"
    )


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
