# SPDX-License-Identifier: MIT
"""The page in Firefox: what moves the robot and what stops it; a tab that is really hidden."""

import time
from collections.abc import Callable, Iterator

import pytest
from firefox import Firefox, Tab
from station import LEASE_S, Station, until

Make = Callable[..., Station]
WITHIN_S = LEASE_S + 0.4


@pytest.fixture(scope="module")
def firefox() -> Iterator[Firefox]:
    with Firefox() as running:
        yield running


@pytest.fixture
def visit(firefox: Firefox) -> Iterator[Callable[..., Tab]]:
    tabs: list[Tab] = []
    firefox.complaints.clear()

    def visit_page(here: Station, *size: int) -> Tab:
        tabs.append(firefox.open(here.url, *size))
        tabs[-1].arm()
        return tabs[-1]

    yield visit_page
    complaints = list(firefox.complaints)
    for tab in tabs:
        tab.send("browsingContext.close")
    assert complaints == []


def drive_on(
    here: Station, tab: Tab, hold: Callable[[], object], let_go: Callable[[], object]
) -> None:
    """Hold until it drives; again, where a stall of a loaded machine ended that."""
    end = time.monotonic() + 60
    hold()
    while not here.drives_on():
        assert time.monotonic() < end, tab.text("drive-why")
        let_go()
        time.sleep(LEASE_S)
        until(lambda: "Ready:" in tab.text("drive-why") or tab._press_arm())
        hold()


def hold_pad(tab: Tab) -> None:
    tab.evaluate("window.pad || makePad()")
    tab.evaluate("requestAnimationFrame(() => { hold(0, 1); hold(7, 1); })")


def drive_by_pad(here: Station, tab: Tab) -> None:
    tab.evaluate("makePad()")
    tab.wait_for("pad-text", "hold [A]")
    drive_on(here, tab, lambda: hold_pad(tab), lambda: tab.evaluate("hold(0, 0)"))


def test_keys_drive_and_letting_go_stops(station: Make, visit: Callable[..., Tab]) -> None:
    here = station()
    tab = visit(here)
    drive_on(here, tab, lambda: tab.key("keyDown", "w"), lambda: tab.key("keyUp", "w"))
    tab.key("keyUp", "w")
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S


@pytest.mark.parametrize("kind", ["mouse", "touch"])
def test_the_stick_drives_and_letting_go_stops(
    kind: str, station: Make, visit: Callable[..., Tab]
) -> None:
    here = station()
    tab = visit(here, 390, 844)
    x, y = tab.middle("stick")

    def hold() -> None:
        tab.pointer(kind, ("pointerDown", (x, y)), ("pointerMove", (x, y - 40)))

    def let_go() -> None:
        tab.pointer(kind, ("pointerUp", (x, y - 40)))

    drive_on(here, tab, hold, let_go)
    assert here.sim.state.last_linear_m_s > 0
    let_go()
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S


def test_a_tab_that_is_really_hidden_stops_and_disarms(
    firefox: Firefox, station: Make, visit: Callable[..., Tab]
) -> None:
    here = station()
    tab = visit(here)
    drive_by_pad(here, tab)
    other = firefox.open("about:blank")
    begun_s = time.monotonic()
    assert here.wait_until_stopped(begun_s) < WITHIN_S
    until(lambda: not here.robot.facts.armed)
    assert tab.evaluate("document.visibilityState") == "hidden"
    other.send("browsingContext.close")
    time.sleep(2 * LEASE_S)
    assert not here.driven, "it came back by itself"


@pytest.mark.parametrize("kind", ["mouse", "touch"])
def test_stop_stops(kind: str, station: Make, visit: Callable[..., Tab]) -> None:
    here = station()
    tab = visit(here, 844, 390)
    drive_by_pad(here, tab)
    tab.click("stop", kind)
    assert here.wait_until_stopped(time.monotonic()) < WITHIN_S
    until(lambda: not here.robot.facts.armed)
