# SPDX-License-Identifier: MIT
"""In every size: stick and STOP stay where they are, and nothing that tells is cut off."""

from collections.abc import Callable
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect
from station import SHOWS, Station, open_tab, press_arm, ready, take_control

Opened = Callable[..., tuple[Station, Page]]

SMALL = [(720, 450), (683, 384), (667, 375), (512, 384), (390, 844), (320, 568)]
"""A laptop at 200 % zoom, and phones."""
SIZES = [(1440, 900), (1024, 600), (844, 390), *SMALL]
TABS = ["plots", "events", "io", "link", "sim"]
OTHER = {"driver": 99, "driver_name": "Chrome on phone 2"}
ARMED: dict[str, Any] = {"why": "", "must_let_go": False, "facts": {"armed": True}}
FRAMES: dict[str, dict[str, Any]] = {
    "calm": {"facts": {"armed": False}},
    "armed": ARMED,
    "going": ARMED | {"going": [3, 0], "going_m_s": 0.3},
    "watching": OTHER,
    "idle": OTHER | {"relievable": True},
    "asked": ARMED | {"asker": 99, "asker_name": "phone of the laboratory"},
    "alarms": {
        "facts": {"other_commander": True, "inhibited": True, "pose_error": True, "at_rest": False},
        "speeds": [-1.0, -1.28, 0.2, -0.35],
        "battery": {"state": "critical"},
        "recording": {"on": True, "seconds": 1, "statuses": 1, "lost": 0, "why": "", "forms": []},
    },
}

WRONG = """() => {
    const find = (text) => [...document.querySelectorAll(text)].filter((node) => node
        .checkVisibility() && node.getBoundingClientRect().width > 1);
    const inside = (box, room) => box.left >= room.left - 1 && box.right <= room.right + 1
        && box.top >= room.top - 1 && box.bottom <= room.bottom + 1;
    const screen = new DOMRect(0, 0, innerWidth, innerHeight);
    const boxOf = (node) => node.getBoundingClientRect();
    const text = (node) => {
        const range = document.createRange();
        range.selectNodeContents(node);
        return range.getBoundingClientRect();
    };
    const over = (a, b) => Math.min(a.right, b.right) > Math.max(a.left, b.left) + 1
        && Math.min(a.bottom, b.bottom) > Math.max(a.top, b.top) + 1;
    const whole = "#stop, #stick, #map, #scale, #banner, #name, #mode, .drive .buttons button";
    const within = (nodes, room) => nodes.filter((node) => !inside(text(node), boxOf(room(node))));
    const map = boxOf(document.getElementById("map"));
    const seen = ({ left, right, top, bottom }, node) => [left + 8, (left + right) / 2, right - 8]
        .every((x) => [top + 4, bottom - 4]
            .every((y) => node.contains(document.elementFromPoint(x, y))));
    const banner = document.getElementById("banner");
    return {
        outside: find(`${whole}, .top :is(h1, .tag, .mode, .chip), .speed .value, .asked-by button`)
            .filter((node) => !inside(boxOf(node), screen)),
        covered: find("#stop, #hand-over, #keep").filter((node) => !seen(boxOf(node), node)),
        over: find("#stop, #stick, #scale").filter((node) => find(`${whole}, .speed, .tabs`)
            .some((other) => other !== node && over(boxOf(node), boxOf(other)))),
        cut: find("#drive-why, .tabs").filter((node) => node.scrollHeight
            > node.clientHeight + 1 || node.scrollWidth > node.clientWidth + 1),
        words: [
            ...within(find(".drive .buttons button, #stop"), (node) => node),
            ...within(find(".mode, .tag"), () => document.querySelector(".top")),
            ...within(find(".banner strong"), () => banner),
            ...within(find("#banner-text > :last-child").filter((node) => node.textContent),
                () => banner)],
        small: [...(map.height < innerHeight / 3 - 1 || map.width < innerWidth / 3 - 1
            ? [document.getElementById("map")] : []),
            ...find("#stop").filter((node) => boxOf(node).height < 48)],
        wide: document.documentElement.scrollWidth > innerWidth ? [document.body] : [],
    };
}"""
FOR_FINGERS = """() => [...document.querySelectorAll("button, input, select, summary, a")]
    .filter((node) => node.checkVisibility({ visibilityProperty: true }))
    .map((node) => (node.type === "checkbox" ? node.closest("label") : node))
    .map((node) => [node.id || node.textContent, node.getBoundingClientRect()])
    .filter(([, box]) => box.width < 43.5 || box.height < 43.5)
    .map(([name, box]) => `${name}: ${box.width} by ${box.height}`)
"""


def resize(page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_function("(width) => innerWidth === width", arg=size[0])
    page.wait_for_timeout(100)  # the banner is fitted when it has its size


def wrong(page: Page) -> dict[str, Any]:
    """What is wrong with the layout, by kind: names of elements."""
    found = page.evaluate(
        f"""() => Object.fromEntries(Object.entries(({WRONG})()).map(([kind, nodes]) =>
            [kind, nodes.map((node) => node.id || node.className || node.textContent)]))"""
    )
    return {kind: names for kind, names in found.items() if names}


def boxes(page: Page) -> list[Any]:
    return [page.locator(name).bounding_box() for name in ("#stick", "#stop", "#scale")]


@pytest.mark.parametrize("touch", [False, True])
def test_in_every_state_and_size_everything_that_drives_and_tells_is_whole(
    touch: bool, watched: Opened
) -> None:
    page_settings = {"init": SHOWS, "has_touch": touch, "is_mobile": touch}
    _, page = watched(page=page_settings, panel=True, robots=("RED", "BLUE"))
    take_control(page)
    page.evaluate("makePad(); 0")
    places: dict[tuple[int, int], Any] = {}
    for name, frame in FRAMES.items():
        page.evaluate("(frame) => { window.wanted = frame; }", frame)
        page.wait_for_timeout(200)
        for size in SIZES if name in ("armed", "alarms") else SMALL:
            resize(page, size)
            assert wrong(page) == {}, (name, size)
            if name not in ("watching", "idle"):  # where nothing can be driven
                assert places.setdefault(size, boxes(page)) == boxes(page), (name, size)


def test_a_place_is_chosen_in_every_small_size_with_map_and_fields_in_view(
    watched: Opened,
) -> None:
    _, page = watched(page={"init": SHOWS, "has_touch": True, "is_mobile": True}, panel=True)
    take_control(page)
    page.evaluate("(frame) => { window.wanted = frame; }", ARMED)
    for size in SMALL:
        resize(page, size)
        for what in ("go", "relocalize"):
            page.locator(f"#map-{what}").click()
            for name in ("set", "cancel", "x", "y", "warning"):
                expect(page.locator(f"#relocalize-{name}")).to_be_in_viewport(ratio=0.99)
            chart = page.locator("#map").bounding_box()
            form = page.locator("#relocalize").bounding_box()
            assert chart is not None
            assert form is not None
            assert form["y"] - chart["y"] >= 60, (what, size)
            page.locator("#relocalize-cancel").click()
        page.locator("#map-past").click()
        slider = page.locator("#past-at")
        before = slider.bounding_box()
        slider.press("Home")
        expect(page.locator("#past-text")).not_to_have_text("now")
        assert slider.bounding_box() == before, "it moves while it is dragged"
        page.locator("#past-end").click()


def test_tabs_fit_every_small_size_and_fingers(watched: Opened) -> None:
    settings = {"has_touch": True, "is_mobile": True}
    here, page = watched(page=settings, panel=True, robots=("RED", "BLUE", "GREEN"))
    for size in SMALL:
        resize(page, size)
        for tab in TABS:
            open_tab(page, tab)
            wide, room = page.locator(f"#panel-{tab}").evaluate(
                "(node) => [node.scrollWidth, node.clientWidth]"
            )
            assert wide <= room + 1, (size, tab)  # both are rounded
            if tab != "io" and size in ((320, 568), (667, 375), (390, 844)):
                assert page.evaluate(FOR_FINGERS) == [], (size, tab)
        page.keyboard.press("Escape")
    for sim, name in zip(here.sims[::-1], ("GREEN", "BLUE", "RED"), strict=True):
        page.get_by_role("button", name=name).click()
        expect(page.locator("#address")).to_have_text(sim.address)


def test_a_small_phone_shows_the_names_of_all_alarms_when_it_is_tapped(watched: Opened) -> None:
    settings = {"viewport": {"width": 320, "height": 568}, "has_touch": True, "is_mobile": True}
    here, page = watched(page=settings, battery_percent=3.0)
    here.sim.set("localization_flags", 82)
    here.sim.set("pad_a", True)
    here.sim.set("front_bumper", True)
    names = page.locator("#banner-more li")
    expect(names).to_have_text(["OVERRIDE", "BATTERY CRITICAL", "POSE WRONG"])
    page.locator("#banner").tap()
    for name in names.all():
        expect(name).to_be_in_viewport(ratio=1)
        assert name.evaluate("(node) => node.scrollWidth - node.clientWidth") <= 1


def test_hints_fit_the_device(watched: Opened) -> None:
    _, desk = watched()
    take_control(desk)
    press_arm(desk)
    why, pad = "#drive-why", "#pad-text"
    expect(desk.locator(why)).to_have_text(
        "Ready: drag the stick, or hold a key. Letting go stops."
    )
    # As on a page that came by plain HTTP from another machine.
    desk.evaluate("Object.defineProperty(window, 'isSecureContext', { get: () => false })")
    expect(desk.locator(pad)).to_contain_text("Start with --tls-cert and --tls-key")
    phone = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
    _, page = watched(page=phone)
    take_control(page)
    press_arm(page)
    expect(page.locator(why)).to_have_text("Ready: drag the stick. Letting go stops.")
    expect(page.locator(pad)).to_be_empty()


# ---- without a mouse, without eyes ----


def test_a_keyboard_alone_reaches_everything(watched: Opened) -> None:
    _, page = watched(panel=True)
    page.locator("#scale").focus()
    page.keyboard.press("l")  # a slider leaves letters to the page
    expect(page.locator("#panel-link")).to_be_focused()
    wanted = {"battery", "quality", "theme", "map", "map-in", "map-clear", "tab-link", "take"}
    wanted |= {"scale", "stop", "panel-link"}
    seen = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        name, ringed = page.evaluate(
            """[document.activeElement.id,
                getComputedStyle(document.activeElement).outlineStyle !== "none"]"""
        )
        assert ringed or not name, f"{name} has the focus and does not show it"
        seen.add(name)
    assert wanted <= seen
    page.locator("#panel-link").focus()
    page.keyboard.press("Escape")
    expect(page.locator("#panel-link")).to_be_hidden()
    expect(page.locator("#tab-link")).to_be_focused()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(theme: str, watched: Opened) -> None:
    here, page = watched(
        page={"color_scheme": theme, "reduced_motion": "reduce", "init": SHOWS},
        panel=True,
        robots=("RED", "BLUE"),
    )
    expect(page.locator("html")).to_have_attribute("data-theme", theme)
    take_control(page)
    axe = Axe()
    lost = {"state": "lost", "link": {"level": "bad"}}
    for frame, tabs in ((ARMED, TABS), (FRAMES["alarms"], ["events"]), (lost, ["link"])):
        page.evaluate("(frame) => { window.wanted = frame; }", frame)
        page.wait_for_timeout(300)
        for tab in tabs:
            open_tab(page, tab)
            found = axe.run(page)
            assert found.violations_count == 0, found.generate_report()
    open_tab(page, "link")
    page.locator("#theme").click()
    page.reload()
    ready(page)
    expect(page.locator("html")).to_have_attribute("data-theme", "light")
    assert here.speeds_sent() == 0
