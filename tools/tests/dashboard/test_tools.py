# SPDX-License-Identifier: MIT
"""Recording, events, place, cameras, several robots; use by keyboard and by screen reader."""

import contextlib
import csv
import http.server
import io
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from mcap.reader import make_reader
from PIL import Image
from playwright.sync_api import Download, Error, Page, expect
from station import (
    LEASE_S,
    Station,
    arm,
    armed,
    drive,
    open_tab,
    press_arm,
    ready,
    take_control,
    until,
    watched,
)
from test_looking import REFUSED

from roburoc4_tools import recordings
from roburoc4_tools.dashboard.camera import Camera
from roburoc4_tools.dashboard.hub import Hub

Visit = Callable[..., Page]
Make = Callable[..., Station]


def text_of(download: Download) -> str:
    return Path(download.path()).read_text(encoding="utf-8")


# ---- recording and events ----


def test_a_recording_continues_without_the_page(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, battery_percent=61.0)
    open_tab(page, "events")
    page.get_by_role("button", name="Record", exact=True).click()
    expect(page.locator("#recording")).to_be_visible()
    here.sim.set("pad_a", True)  # an event
    page.close()
    count = here.hub.recorder.now["statuses"]
    until(lambda: here.hub.recorder.now["statuses"] > count + 50)
    page = visit(here.url)
    ready(page)
    open_tab(page, "events")
    page.get_by_role("button", name="End recording").click()
    expect(page.locator("#recording")).to_be_hidden()
    with page.expect_download() as download:
        page.get_by_role("link", name="Download CSV").click()
    assert download.value.suggested_filename.startswith("roburoc4-")
    found = list(csv.DictReader(io.StringIO(text_of(download.value))))
    assert len(found) > 5
    assert {row["battery_remaining_percent"] for row in found} - {""} == {"61"}
    with page.expect_download() as download:
        page.get_by_role("link", name="MCAP").click()
    with open(download.value.path(), "rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    topics = {channel.topic for channel in summary.channels.values()}
    assert topics >= {"/odom", "/battery_state", "/pad/joy", "/diagnostics"}
    expect(page.get_by_role("link", name="pcapng")).to_be_hidden()


def test_every_datagram_is_recorded_if_requested(
    station: Make, visit: Visit, tmp_path: Path
) -> None:
    _, page = watched(station, visit, client={"record": tmp_path / "run.pcapng"})
    open_tab(page, "events")
    with page.expect_download() as download:
        page.get_by_role("link", name="pcapng").click()
    recording = recordings.open_recording(download.value.path())
    assert any(status.service == "localization" for status in recording)


def test_there_is_no_recording_before_there_is_one(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, forgive="404")
    assert page.request.get(f"{here.url}recording.csv").status == 404
    here.sim.set("power", False)
    expect(page.locator("#quality-say")).to_have_text(re.compile(r"^Lost"))


def test_events_are_filtered_and_downloaded(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    open_tab(page, "events")
    shown = page.locator("#events li:visible")
    page.locator("#events-level").select_option("bad")
    here.sim.set("pad_a", True)
    expect(shown).to_have_count(1)
    here.sim.set("pad_a", False)
    page.locator("#events-text").fill("nothing like this")
    expect(page.locator("#events-none")).to_have_text("No event fits the filter.")
    page.locator("#events-level").select_option("all")
    page.locator("#events-text").fill("game pad")
    expect(shown).to_have_count(2)
    with page.expect_download() as download:
        page.locator("#events-export").click()
    rows = list(csv.reader(io.StringIO(text_of(download.value))))
    assert rows[0] == ["time", "level", "text"]
    assert [row[1] for row in rows[1:]] == ["plain", "bad"]


# ---- place ----


@pytest.mark.both
def test_a_drag_on_the_map_sets_the_robots_pose(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    expect(page.locator("#map-relocalize")).to_be_hidden()
    take_control(page)
    page.locator("#map-relocalize").click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2 - 60, box["y"] + box["height"] / 2 - 60
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 40, y)
    page.mouse.up()
    page.wait_for_timeout(300)
    assert here.robot.localization.x_m == pytest.approx(0.0)
    page.get_by_role("button", name="Set").click()
    until(lambda: abs(here.robot.localization.x_m - 1.0) < 0.05)
    pose = here.robot.localization
    assert (pose.y_m, pose.theta_rad) == pytest.approx((1.0, 1.571), abs=0.05)


# ---- cameras ----


RUNS = threading.Event()
"""Whether the camera makes pictures."""


class Pictures(http.server.BaseHTTPRequestHandler):
    """A camera server with red pictures, one after the other while it runs."""

    def do_GET(self) -> None:
        picture = io.BytesIO()
        Image.new("RGB", (64, 48), "red").save(picture, "JPEG")
        data = picture.getvalue()
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=next")
        self.end_headers()
        head = f"--next\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
        with contextlib.suppress(OSError):  # the dashboard has enough
            while True:
                if RUNS.is_set():
                    self.wfile.write(head.encode() + data + b"\r\n")
                time.sleep(0.05)

    def log_message(self, *_: object) -> None:
        """Log nothing."""


@pytest.fixture
def camera() -> Iterator[str]:
    RUNS.set()
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Pictures) as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{serving.server_port}/stream.mjpg"
        serving.shutdown()


@pytest.mark.both
def test_a_camera_is_shown_and_no_other_picture(camera: str, station: Make, visit: Visit) -> None:
    here = station(cameras=[Camera("front", f"{camera}?size=small")])
    page = visit(here.url, forgive=f"{REFUSED}|^asked http://127")
    ready(page)
    picture = page.get_by_alt_text("camera front")
    until(lambda: picture.evaluate("(node) => node.naturalWidth") == 64)
    wide = page.locator("#map").evaluate("(node) => node.clientWidth")
    for press in (picture, page.get_by_role("button", name="camera front large")):
        press.click()
        until(lambda: page.locator("#map").evaluate("(node) => node.clientWidth") < 0.6 * wide)
        press.click()
        until(lambda: page.locator("#map").evaluate("(node) => node.clientWidth") == wide)
    refused = page.evaluate(
        """(url) => new Promise((resolve) => {
            addEventListener("securitypolicyviolation", (event) => resolve(event.blockedURI));
            new Image().src = url;
        })""",
        camera.replace("stream.mjpg", "other.mjpg"),
    )
    assert refused.endswith("other.mjpg")


@pytest.mark.parametrize("large", [False, True])
def test_a_picture_that_is_old_says_so_and_a_dead_camera_takes_no_room(
    large: bool, camera: str, station: Make, visit: Visit
) -> None:
    _, page = watched(station, visit, cameras=[Camera("front", camera)])
    caption = page.locator("figcaption")
    expect(page.locator("figure[data-state=live]")).to_be_visible()
    expect(caption).to_have_text("front")
    if large:
        page.get_by_role("button", name="camera front large").click()
    RUNS.clear()
    expect(caption).to_contain_text("front: no new picture for")
    wide = page.locator("#map").evaluate("(node) => node.clientWidth")
    expect(page.locator("figure[data-state=dead]")).to_be_visible()
    until(lambda: page.locator("#map").evaluate("(node) => node.clientWidth") > 1.3 * wide)
    stage = page.locator("#stage").evaluate("(node) => node.clientWidth")
    assert page.locator("#map").evaluate("(node) => node.clientWidth") >= stage - 2
    page.locator("#map-past").click()
    uncovered = """(node) => {
        const { left, bottom, width } = node.getBoundingClientRect();
        return document.elementFromPoint(left + width / 2, bottom - 3) === node;
    }"""
    assert page.locator("#past-end").evaluate(uncovered)
    RUNS.set()
    expect(caption).to_have_text("front")


@pytest.mark.parametrize("size", [(320, 568), (667, 375)])
def test_nothing_covers_the_age_of_a_picture(
    size: tuple[int, int], camera: str, station: Make, visit: Visit
) -> None:
    here = station(cameras=[Camera("front", camera)])
    page = visit(
        here.url, viewport={"width": size[0], "height": size[1]}, has_touch=True, is_mobile=True
    )
    expect(page.locator("figure[data-state=live]")).to_be_visible()
    RUNS.clear()
    caption = page.locator("figcaption")
    expect(caption).to_contain_text("no new picture for")
    assert caption.evaluate(
        """(node) => {
            const { left, right, top } = node.getBoundingClientRect();
            return [left + 3, (left + right) / 2, right - 3]
                .every((x) => document.elementFromPoint(x, top + 8) === node);
        }"""
    )
    RUNS.set()


# ---- several robots ----


@pytest.mark.both
def test_the_chosen_robot_is_driven_and_stop_stops_all(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"))
    red, blue = visit(here.url), visit(f"{here.url}#BLUE")
    for page, colour in ((red, "red"), (blue, "blue")):
        expect(page.locator("body")).to_have_attribute("data-robot", colour)
    button = red.locator("#fleet button", has_text="BLUE")
    button.hover()  # which changes the colour of its other sides
    expect(button).to_have_css("border-left-color", "rgb(0, 104, 168)")
    arm(blue)
    expect(blue.locator("#address")).to_have_text(here.sims[1].address)
    red.bring_to_front()
    arm(red)
    drive(here, red)
    assert here.sims[1].state.nonzero_speed_commands == 0
    expect(blue.get_by_role("button", name="STOP ALL")).to_be_visible()
    name = here.hubs[1].control.driver.name
    blue.locator("#stop").click()
    until(lambda: not any(robot.facts.armed for robot in here.robots))
    until(lambda: not here.driven)
    expect(red.locator("#banner-text")).to_contain_text(f"STOP was pressed on {name}")


def test_an_alarm_of_another_robot_is_seen(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"))
    page = visit(here.url)
    ready(page)
    here.sims[1].set("battery_percent", 3.0)
    expect(page.locator("#fleet button", has_text="BLUE")).to_contain_text("alarm")


def test_choosing_another_robot_stops_the_one_before(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit, robots=("RED", "BLUE"))
    drive(here, page)
    page.get_by_role("button", name="BLUE").click()
    until(lambda: not here.robots[0].facts.armed)
    expect(page.locator("#address")).to_have_text(here.sims[1].address)
    expect(page.locator("#control")).to_have_text("Control: nobody")
    page.wait_for_timeout(2000 * LEASE_S)
    assert not here.driven
    here.sims[0].set("power", False)
    expect(page.get_by_role("button", name="RED")).to_contain_text("lost")


def test_each_robot_goes_by_its_own_origin(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"), slip=0.0)
    red, blue = visit(here.url), visit(f"{here.url}#BLUE")
    ready(red)
    ready(blue)
    take_control(blue)
    blue.locator("#map-relocalize").click()
    for name, value in (("x", "5"), ("y", "2"), ("theta", "90")):
        blue.locator(f"#relocalize-{name}").fill(value)
    blue.get_by_role("button", name="Set").click()
    until(lambda: abs(here.robots[1].localization.x_m - 5.0) < 0.05)
    goals = arrive(
        here.hubs[1],
        blue,
        (5.0, 3.0),
        lambda: abs(here.robots[1].localization.y_m - 3.0) < 0.15,
    )
    assert (5.0, 3.0) in goals, "other pages show no goal"
    assert here.sims[0].state.speed_commands == 0
    assert here.sims[1].state.true_x_m > 0.8, "it did not go ahead"


@pytest.mark.both
def test_every_robot_can_be_chosen_in_every_size(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, robots=("RED", "BLUE", "GREEN"))
    for width, height in ((1440, 900), (390, 844), (844, 390)):
        page.set_viewport_size({"width": width, "height": height})
        for sim, name in zip(here.sims[::-1], ("GREEN", "BLUE", "RED"), strict=True):
            page.get_by_role("button", name=name).click()
            expect(page.locator("#address")).to_have_text(sim.address)


def test_the_chosen_robot_keeps_its_colour(station: Make, visit: Visit) -> None:
    page = visit(station(robots=("RED", "BLUE")).url)
    ready(page)
    stripes = page.locator("#fleet button").evaluate_all(
        "(all) => all.map(getComputedStyle).map((is) => [is.borderLeftWidth, is.borderLeftColor])"
    )
    assert [width for width, _ in stripes] == ["8px", "8px"]
    assert len({colour for _, colour in stripes}) == 2


def test_a_robot_with_an_unknown_name_is_refused(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"))
    page = visit(f"{here.url}#GREY")
    expect(page.locator("#banner-text")).to_contain_text("o robot has that name")


# ---- without a mouse, without eyes ----


def test_a_keyboard_alone_reaches_everything(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit, panel=True)
    page.keyboard.press("l")
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


@pytest.mark.both
def test_a_slider_that_has_the_focus_leaves_letters_to_the_page(
    station: Make, visit: Visit
) -> None:
    _, page = watched(station, visit)
    page.locator("#scale").focus()
    page.keyboard.press("e")
    expect(page.locator("#panel-events")).to_be_visible()


def test_what_a_key_opens_has_the_focus(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    page.keyboard.press("e")
    expect(page.locator("#panel-events")).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.locator("#record")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.locator("#panel-events")).to_be_hidden()
    expect(page.locator("#tab-events")).to_be_focused()


@pytest.mark.both
def test_control_arm_and_drive_by_key_alone(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    page.locator("#take").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#arm")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#disarm")).to_be_focused()
    here.wait_until_driven(page, lambda: page.keyboard.down("w"), lambda: page.keyboard.up("w"))
    page.keyboard.up("w")
    page.locator("#scale").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#scale")).to_have_value("35")
    expect(page.locator("#scale")).to_be_focused()
    page.keyboard.press("Space")
    until(lambda: not here.robot.facts.armed)


def alarm(here: Station, page: Page) -> None:
    here.sim.set("battery_percent", 3.0)
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")


def lose(here: Station, page: Page) -> None:
    here.sim.set("power", False)
    expect(page.locator("#banner-title")).to_have_text("ROBOT LOST")


TABS = ["plots", "events", "io", "link", "sim"]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(theme: str, station: Make, visit: Visit) -> None:
    here = station(panel=True, robots=("RED", "BLUE"))
    page = visit(here.url, color_scheme=theme, reduced_motion="reduce")
    ready(page)
    axe = Axe()
    # Only the tabs of the events and of the simulator depend on the robot's state.
    for prepare, tabs in (
        (lambda: None, TABS),
        (lambda: arm(page), ["events"]),
        (lambda: alarm(here, page), ["events", "sim"]),
        (lambda: lose(here, page), TABS),
    ):
        prepare()
        for tab in tabs:
            open_tab(page, tab)
            found = axe.run(page)
            assert found.violations_count == 0, found.generate_report()


# ---- going to a place ----


SOON_MS = 3000


def go_to(page: Page, x_m: float, y_m: float) -> bool:
    """Send the robot there; False where a stall of a loaded machine disarmed it meanwhile."""
    try:
        page.locator("#map-go").click(timeout=SOON_MS)
        for name, value in (("x", x_m), ("y", y_m)):
            page.locator(f"#relocalize-{name}").click(timeout=SOON_MS)
            page.keyboard.press("ControlOrMeta+a")
            page.keyboard.type(str(value))  # fill() leaves it empty in Firefox
        page.get_by_role("button", name="Go", exact=True).click(timeout=SOON_MS)
    except Error:
        return False
    return True


def arrive(
    hub: Hub, page: Page, place: tuple[float, float], there: Callable[[], bool]
) -> list[object]:
    """Go there; again, where a stall ended it. Return the goals that other pages showed."""
    end = time.monotonic() + 60
    goals = []
    while not there():
        assert time.monotonic() < end, hub.control.why
        press_arm(page)
        if go_to(page, *place):
            page.wait_for_timeout(300)
            goals.append(hub.in_short["going"])
            until(lambda: hub.control.going is None)
    return goals


def set_out(here: Station, page: Page, x_m: float, y_m: float) -> None:
    """Start to go there; again, where a stall of a loaded machine ended it."""
    for _ in range(5):
        press_arm(page)
        if go_to(page, x_m, y_m) and here.drives_on():
            return
        page.wait_for_timeout(1000)
    raise AssertionError("it never started")


@pytest.mark.both
def test_the_robot_goes_to_a_place_when_it_is_confirmed(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, slip=0.0)
    take_control(page)
    expect(page.locator("#map-go")).to_be_hidden()
    press_arm(page)
    page.locator("#scale").fill("60")
    page.locator("#map-go").click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2 - 60)
    page.wait_for_timeout(2000 * LEASE_S)
    assert here.speeds_sent() == 0, "it was not confirmed"
    page.locator("#relocalize-cancel").click()
    arrive(here.hub, page, (1.0, 0.0), lambda: abs(here.sim.state.true_x_m - 1.0) < 0.15)
    until(lambda: not here.driven)


def press_escape(page: Page) -> None:
    page.keyboard.press("Escape")


def press_a_key(page: Page) -> None:
    page.keyboard.press("s")


def lose_focus(page: Page) -> None:
    page.evaluate("dispatchEvent(new Event('blur')); document.hasFocus = () => false")


def stall(page: Page) -> None:
    page.evaluate(
        "() => setTimeout(() => { const end = Date.now() + 3000; while (Date.now() < end); }, 0)"
    )


@pytest.mark.parametrize("end", [press_escape, press_a_key, lose_focus, stall, Page.close])
def test_going_ends_with_whatever_its_driver_does(
    end: Callable[[Page], None], station: Make, visit: Visit
) -> None:
    here, page = armed(station, visit)
    set_out(here, page, 4.0, 0.0)
    end(page)
    assert here.wait_until_stopped(time.monotonic()) < LEASE_S + 0.4
    time.sleep(2 * LEASE_S)
    assert not here.driven, "it went on"
