# SPDX-License-Identifier: MIT
"""What an operator does besides driving: places, recordings, cameras, robots, the simulator."""

import contextlib
import csv
import http.server
import io
import re
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from PIL import Image
from playwright.sync_api import Error, Page, expect
from station import (
    WITHIN_S,
    Station,
    arm,
    drive,
    hang,
    open_tab,
    press_arm,
    ready,
    stays_stopped,
    take_control,
    until,
)

from roburoc4_tools import recordings
from roburoc4_tools.dashboard.camera import Camera

Visit = Callable[..., Page]
Make = Callable[..., Station]
Opened = Callable[..., tuple[Station, Page]]


# ---- recording and events ----


def test_a_recording_continues_without_the_page(
    watched: Opened, visit: Visit, tmp_path: Path
) -> None:
    here, page = watched(battery_percent=61.0, client={"record": tmp_path / "run.pcapng"})
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(f"{here.url}recording.csv")
    page.keyboard.press("r")
    expect(page.locator("#recording")).to_be_visible()
    here.sim.set("pad_a", True)  # an event
    page.close()
    until(lambda: here.hub.recorder.now["statuses"] > 50)
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(f"{here.url}recording.mcap")  # it is not complete
    page = visit(here.url)
    ready(page)
    page.keyboard.press("r")  # which begins none anew
    open_tab(page, "events")
    page.get_by_role("button", name="End recording").click()
    expect(page.locator("#recording")).to_be_hidden()
    assert here.hub.recorder.now["statuses"] > 50
    with page.expect_download() as download:
        page.get_by_role("link", name="Download CSV").click()
    assert download.value.suggested_filename.startswith("roburoc4-")
    text = Path(download.value.path()).read_text(encoding="utf-8")
    found = list(csv.DictReader(io.StringIO(text)))
    assert len(found) > 5
    assert {row["battery_remaining_percent"] for row in found} - {""} == {"61"}
    with page.expect_download() as download:
        page.get_by_role("link", name="MCAP").click()
    with open(download.value.path(), "rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    topics = {channel.topic for channel in summary.channels.values()}
    assert topics >= {"/odom", "/battery_state", "/pad/joy", "/diagnostics"}
    with page.expect_download() as download:
        page.get_by_role("link", name="pcapng").click()
    recording = recordings.open_recording(download.value.path())
    assert any(status.service == "localization" for status in recording)


def test_events_are_filtered_and_downloaded(watched: Opened) -> None:
    here, page = watched()
    open_tab(page, "events")
    shown = page.locator("#events li:visible")
    page.locator("#events-level").select_option("weak")
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
    rows = list(csv.reader(io.StringIO(Path(download.value.path()).read_text(encoding="utf-8"))))
    assert rows[0] == ["time", "level", "text"]
    assert [row[1] for row in rows[1:]] == ["plain", "bad"]


# ---- places ----


def choose(page: Page, what: str, x: str, y: str) -> None:
    page.locator(f"#map-{what}").click(timeout=3000)
    page.locator("#relocalize-x").fill(x)
    page.locator("#relocalize-y").fill(y)


def test_a_drag_on_the_map_sets_the_robots_pose(watched: Opened) -> None:
    here, page = watched()
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


def test_a_place_to_go_to_is_checked_and_told_before_it_begins(armed: Opened) -> None:
    here, page = armed(lease_s=1.0)
    go, warning = (
        page.get_by_role("button", name="Go", exact=True),
        page.locator("#relocalize-warning"),
    )
    choose(page, "go", "3", "4")
    expect(page.locator("#relocalize-text")).to_contain_text(
        "5.0\u202fm, 17\u202fs or more at 0.30"
    )
    for wrong, text in (
        ("-1000.5", "x is \u22121000 to 1000\u202fm. "),
        ("", "x is empty: type a number. "),
    ):
        page.locator("#relocalize-x").fill(wrong)
        go.click()
        expect(warning).to_have_text(text)
    page.locator("#relocalize-x").fill("12")
    go.click()
    expect(warning).to_contain_text("That is far")
    expect(page.get_by_role("button", name="Go 13\u202fm")).to_be_visible()
    page.locator("#relocalize-x").fill("1")
    expect(go).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator("#relocalize")).to_be_hidden()
    assert not here.hub.control.begun
    assert here.speeds_sent() == 0


def set_out(here: Station, page: Page, x: str, y: str) -> None:
    """Start to go there; again, where a stall of a loaded machine ended it."""
    for _ in range(5):
        press_arm(page)
        with contextlib.suppress(Error):
            choose(page, "go", x, y)
            page.get_by_role("button", name="Go", exact=True).click(timeout=3000)
            if here.drives_on():
                return
        page.wait_for_timeout(1000)
    raise AssertionError("it never started")


GOING_ENDS: dict[str, Callable[[Page], object]] = {
    "Escape": lambda page: page.keyboard.press("Escape"),
    "a key": lambda page: page.keyboard.press("s"),
    "the page hangs": hang,
    "the window is left": lambda page: page.evaluate(
        "dispatchEvent(new Event('blur')); document.hasFocus = () => false"
    ),
}


def test_going_ends_with_whatever_its_driver_does(armed: Opened) -> None:
    here, page = armed(panel=True)
    here.hub.panel.clear()
    for what, end in GOING_ENDS.items():
        set_out(here, page, "8", "0")
        end(page)
        assert here.wait_until_stopped(time.monotonic()) < WITHIN_S, what
        stays_stopped(here)
    events = page.locator("#events")
    expect(events).to_contain_text("the robot goes to x 8.00 m, y 0.00 m by itself")
    expect(events).to_contain_text("did not arrive at x 8.00 m, y 0.00 m")


def test_each_robot_goes_by_its_own_origin(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"), slip=0.0)
    sim, robot = here.sims[1], here.robots[1]
    page = visit(f"{here.url}#BLUE")
    ready(page)
    take_control(page)
    choose(page, "relocalize", "5", "2")
    page.locator("#relocalize-theta").fill("90")
    page.get_by_role("button", name="Set").click()
    until(lambda: abs(robot.localization.x_m - 5.0) < 0.05)
    goals = []
    for _ in range(5):  # a stall of a loaded machine may end one
        press_arm(page)
        with contextlib.suppress(Error):
            choose(page, "go", "5", "3")
            page.get_by_role("button", name="Go", exact=True).click(timeout=3000)
            page.wait_for_timeout(300)
            goals.append(here.hubs[1].in_short["going"])
            until(lambda: here.hubs[1].control.going is None)
        if abs(robot.localization.y_m - 3.0) < 0.15:
            break
    assert robot.localization.y_m == pytest.approx(3.0, abs=0.15)
    assert (5.0, 3.0) in goals, "other pages show no goal"
    assert here.sims[0].state.speed_commands == 0
    assert sim.state.true_x_m > 0.8, "it did not go ahead"


# ---- several robots ----


def test_the_chosen_robot_is_driven_and_stop_stops_all(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"))
    red, blue = visit(here.url), visit(f"{here.url}#BLUE")
    for page, colour in ((red, "red"), (blue, "blue")):
        expect(page.locator("body")).to_have_attribute("data-robot", colour)
    arm(blue)
    expect(blue.locator("#address")).to_have_text(here.sims[1].address)
    arm(red)
    drive(here, red)
    assert here.sims[1].state.nonzero_speed_commands == 0
    expect(blue.get_by_role("button", name="STOP ALL")).to_be_visible()
    name = here.hubs[1].control.driver.name
    blue.locator("#stop").click()
    until(lambda: not any(robot.facts.armed for robot in here.robots))
    expect(red.locator("#banner-text")).to_contain_text(f"STOP was pressed on {name}")
    here.sims[1].set("battery_percent", 3.0)
    expect(red.locator("#fleet button", has_text="BLUE")).to_contain_text("alarm")


def test_choosing_another_robot_stops_the_one_before(armed: Opened) -> None:
    here, page = armed(robots=("RED", "BLUE"))
    drive(here, page)
    page.get_by_role("button", name="BLUE").click()
    until(lambda: not here.robots[0].facts.armed)
    expect(page.locator("#address")).to_have_text(here.sims[1].address)
    expect(page.locator("#control")).to_have_text("Control: nobody")
    stays_stopped(here)
    here.sims[0].set("power", False)
    expect(page.get_by_role("button", name="RED")).to_contain_text("lost")


def test_a_robot_with_an_unknown_name_is_refused(station: Make, visit: Visit) -> None:
    page = visit(f"{station(robots=('RED', 'BLUE')).url}#GREY")
    expect(page.locator("#banner-text")).to_contain_text("o robot has that name")


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


def test_a_camera_is_shown_says_when_it_is_old_and_gives_its_room_back(
    camera: str, watched: Opened
) -> None:
    forgive = "Content Security Policy|violates the following directive|^asked http://127"
    cameras = [Camera("front", f"{camera}?size=small")]
    _, page = watched(cameras=cameras, page={"forgive": forgive})
    wide = "document.getElementById('map').clientWidth"
    picture, caption = page.get_by_alt_text("camera front"), page.locator("figcaption")
    until(lambda: picture.evaluate("(node) => node.naturalWidth") == 64)
    expect(caption).to_have_text("front")
    beside = page.evaluate(wide)
    picture.click()
    until(lambda: page.evaluate(wide) < 0.6 * beside)
    page.get_by_role("button", name="camera front large").click()
    until(lambda: page.evaluate(wide) == beside)
    RUNS.clear()
    expect(caption).to_contain_text("front: no new picture for")
    expect(page.locator("figure[data-state=dead]")).to_be_visible()
    until(lambda: page.evaluate(wide) > 1.3 * beside)
    RUNS.set()
    expect(caption).to_have_text("front")
    refused = page.evaluate(
        """(url) => new Promise((resolve) => {
            addEventListener("securitypolicyviolation", (event) => resolve(event.blockedURI));
            new Image().src = url;
        })""",
        camera.replace("stream.mjpg", "other.mjpg"),
    )
    assert refused.endswith("other.mjpg"), "a page loads pictures from other hosts"


# ---- the simulator's panel ----


def test_the_panel_does_what_a_person_beside_the_robot_could(watched: Opened) -> None:
    here, page = watched(panel=True)
    open_tab(page, "sim")
    for name in ("powered", "brakes_released", "charger", "rear_bumper", "estop_remote"):
        box = page.locator(f"#sim input[name={name}]")
        before = getattr(here.sim.state, name)
        box.set_checked(not before)
        until(lambda name=name, before=before: getattr(here.sim.state, name) is not before)
        box.set_checked(before)
        until(lambda name=name, before=before: getattr(here.sim.state, name) is before)
    ready(page)
    page.get_by_role("button", name="Press the motor power button").click()
    until(lambda: here.sim.state.motors_enabled)
    page.locator("input[name=delay_ms]").fill("40")
    until(lambda: here.hub.panel.now()["faults"]["delay_ms"] == 40.0)
    page.locator("input[name=corrupt]").fill("1")
    until(lambda: here.hub.panel.now()["faults"]["corrupt"] == 0.01)
    page.get_by_role("button", name="Restore the network").click()
    until(lambda: not any(here.hub.panel.now()["faults"].values()))
    here.sim.place(1.0, 2.0, 0.5)
    expect(page.locator("#sim-state")).to_contain_text(re.compile(r"x 1\.00.m +y 2\.00.m"))
    expect(page.locator("#pose")).to_contain_text(re.compile(r"x 0\.00.m"))
    page.get_by_role("button", name="Robot back to the origin").click()
    until(lambda: here.sim.state.true_x_m == 0.0)
    page.locator("#sim input[name=overridden]").check()
    page.get_by_label("RT forward").fill("50")
    until(lambda: here.sim.state.wheel_linear_m_s > 0.3)
    page.get_by_role("button", name="Release the pad").click()
    until(lambda: not here.sim.state.overridden)


def test_an_obstacle_is_dragged_and_the_telemeter_sees_it(watched: Opened) -> None:
    here, page = watched(panel=True)
    open_tab(page, "sim")
    free_m = here.sim.state.distances_m[0]
    page.get_by_role("button", name="Add an obstacle").click()
    until(lambda: here.sim.state.distances_m[0] < 2.0 < free_m)
    near_m = here.sim.state.distances_m[0]
    canvas = page.locator("#map")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(middle[0], middle[1] - 2.2 * 60)
    page.mouse.down()
    for step in range(1, 8):
        page.mouse.move(middle[0], middle[1] - (2.2 - 0.08 * step) * 60)
        time.sleep(0.05)
    page.mouse.up()
    until(lambda: here.sim.state.distances_m[0] < near_m - 0.3)
    page.get_by_role("button", name="Clear obstacles").click()
    until(lambda: here.sim.state.distances_m[0] > 5.0)
