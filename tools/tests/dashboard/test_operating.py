# SPDX-License-Identifier: MIT
"""What an operator's hands and eyes expect: keys, names, places, alarms, the past."""

import itertools
import math
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from station import (
    LB,
    NAME,
    RB,
    B,
    Station,
    arm,
    armed,
    free_port,
    hold_pad,
    open_tab,
    press_arm,
    ready,
    take_control,
    until,
    watched,
)

import roburoc4
from roburoc4_tools.dashboard.frames import Frames
from roburoc4_tools.dashboard.history import History

Visit = Callable[..., Page]
Make = Callable[..., Station]


# ---- who drives ----


def test_pages_have_names_that_can_be_edited_and_are_kept(station: Make, visit: Visit) -> None:
    here = station(idle_s=0.0)
    page, other = visit(here.url), visit(here.url)
    ready(page)
    ready(other)
    take_control(page)
    expect(other.locator("#control")).to_have_text(f"Control: {NAME}")
    open_tab(page, "link")
    page.get_by_label("This page is called").fill("phone of the lab")
    page.keyboard.press("Tab")
    expect(other.locator("#control")).to_have_text("Control: phone of the lab")
    page.reload()
    ready(page)
    take_control(page)
    expect(other.locator("#control")).to_have_text("Control: phone of the lab")
    expect(other.locator("#events")).to_contain_text("phone of the lab took control")


def test_a_page_that_drives_nothing_is_relieved_while_the_robot_stands(
    station: Make, visit: Visit
) -> None:
    here = station(idle_s=0.0)
    page, other = visit(here.url), visit(here.url)
    arm(page)
    other.get_by_role("button", name="Relieve").click()
    expect(other.locator("#control")).to_have_text("Control: this page")
    assert not here.robot.facts.armed
    here.sim.set("pad_a", True)
    here.sim.set("pad_lj_x", 1.0)
    expect(page.get_by_role("button", name="Ask for control")).to_be_visible()


# ---- hands ----


def test_arrow_keys_drive_after_the_slider_was_clicked(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.locator("#scale").click(position={"x": 5, "y": 10})
    value = page.locator("#scale").input_value()
    here.wait_until_driven(
        page, lambda: page.keyboard.down("ArrowUp"), lambda: page.keyboard.up("ArrowUp")
    )
    assert page.locator("#scale").input_value() == value
    expect(page.locator("kbd", has_text="W")).to_have_attribute("data-held", "true")
    page.keyboard.up("ArrowUp")
    expect(page.locator("kbd", has_text="W")).to_have_attribute("data-held", "false")


def test_a_double_click_on_take_control_arms_nothing(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    take = page.locator("#take").bounding_box()
    page.locator("#take").dblclick()
    expect(page.locator("#control")).to_have_text("Control: this page")
    arm_box = page.locator("#arm").bounding_box()
    assert take is not None
    assert arm_box is not None
    assert arm_box["x"] + arm_box["width"] <= take["x"], "a second click would arm"
    assert not here.robot.facts.armed


def test_a_held_enter_takes_control_and_arms_nothing(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    page.locator("#take").focus()
    page.keyboard.down("Enter")
    expect(page.locator("#arm")).to_be_focused()
    for _ in range(5):
        page.keyboard.down("Enter")  # as the keyboard repeats it
    page.keyboard.up("Enter")
    expect(page.locator("#arm")).to_be_visible()
    assert not here.robot.facts.armed


@pytest.mark.parametrize("field", ["#events-text", "#events-level", "#record", "#scale"])
def test_space_stops_from_every_field(field: str, station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    open_tab(page, "events")
    page.locator(field).focus()
    page.keyboard.press("Space")
    until(lambda: not here.robot.facts.armed)
    here.wait_for_stop_pressed()


def test_a_field_takes_spaces_while_nothing_can_move(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    open_tab(page, "events")
    page.locator("#events-text").focus()
    page.keyboard.type("a b")
    expect(page.locator("#events-text")).to_have_value("a b")
    expect(page.locator("#events")).not_to_contain_text("STOP was pressed")


def test_escape_closes_what_is_open(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    take_control(page)
    open_tab(page, "plots")
    page.locator(".signals summary").click()
    page.locator("#map-relocalize").click()
    for name in ("#relocalize", "#plot-signals", "#panel-plots"):
        expect(page.locator(name)).to_be_visible()
        page.keyboard.press("Escape")
        expect(page.locator(name)).to_be_hidden()
    page.locator("#map-past").click()
    page.keyboard.press("Escape")
    expect(page.locator("#past")).to_be_hidden()


def test_a_held_escape_closes_one_thing(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    open_tab(page, "plots")
    page.locator("#map-past").click()
    page.keyboard.down("Escape")
    expect(page.locator("#past")).to_be_hidden()
    page.keyboard.down("Escape")  # as the keyboard repeats it
    page.keyboard.up("Escape")
    expect(page.locator("#panel-plots")).to_be_visible()


def test_r_begins_a_recording_and_ends_none(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    page.keyboard.press("r")
    expect(page.locator("#recording")).to_be_visible()
    page.keyboard.press("r")
    count = here.hub.recorder.now["statuses"]
    until(lambda: here.hub.recorder.now["statuses"] > count + 10)
    assert here.hub.recorder.now["on"]


def test_the_pad_stops_and_changes_the_speed(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.evaluate("makePad()")
    expect(page.locator("#pad-text")).to_contain_text("[B] STOP")
    for button, value in ((RB, "35"), (RB, "40"), (LB, "35")):
        page.evaluate(f"hold({button}, 1)")
        expect(page.locator("#scale")).to_have_value(value)
        page.evaluate(f"hold({button}, 0)")
        page.wait_for_timeout(300)
    press_arm(page)
    hold_pad(page, rt=1.0)
    until(lambda: page.locator("#knob").evaluate("(node) => node.style.transform") != "")
    page.evaluate(f"hold({B}, 1)")
    here.wait_for_stop_pressed()


def test_hints_fit_the_device(station: Make, visit: Visit) -> None:
    here = station()
    desk = visit(here.url)
    arm(desk)
    expect(desk.locator("#drive-why")).to_have_text(
        "Ready: drag the stick, or hold a key. Letting go stops."
    )
    desk.close()
    phone = visit(here.url, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    arm(phone)
    expect(phone.locator("#drive-why")).to_have_text("Ready: drag the stick. Letting go stops.")
    expect(phone.locator("#pad-text")).to_be_empty()


# ---- going to a place ----


def begin_to_go(page: Page, x: str, y: str = "0") -> None:
    page.locator("#map-go").click()
    page.locator("#relocalize-x").fill(x)
    page.locator("#relocalize-y").fill(y)


def test_go_to_says_the_way_and_its_time_before_it_begins(station: Make, visit: Visit) -> None:
    _, page = armed(station, visit, lease_s=1.0)
    begin_to_go(page, "3", "4")
    expect(page.locator("#relocalize-text")).to_contain_text(
        "5.0\u202fm, 17\u202fs or more at 0.30"
    )
    expect(page.locator("#relocalize-turn")).to_be_hidden()


@pytest.mark.parametrize("wrong", ["1e9", "-1000.5", ""])
def test_a_place_that_cannot_be_is_refused_on_the_page(
    wrong: str, station: Make, visit: Visit
) -> None:
    here, page = armed(station, visit, lease_s=1.0)
    begin_to_go(page, wrong)
    page.get_by_role("button", name="Go", exact=True).click()
    expected = "x is empty: type a number." if not wrong else "x is \u22121000 to 1000\u202fm."
    expect(page.locator("#relocalize-warning")).to_have_text(f"{expected} ")
    expect(page.locator("#relocalize-x")).to_be_focused()
    expect(page.locator("#control")).to_have_text("Control: this page")
    assert here.hub.control.going is None


def test_far_places_are_asked_about(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit, lease_s=1.0)
    begin_to_go(page, "12")
    page.get_by_role("button", name="Go", exact=True).click()
    expect(page.locator("#relocalize-warning")).to_contain_text("That is far")
    assert not here.hub.control.begun
    expect(page.get_by_role("button", name="Go 12\u202fm")).to_be_visible()
    page.locator("#relocalize-x").fill("1")
    expect(page.get_by_role("button", name="Go", exact=True)).to_be_visible()


def test_a_move_is_among_the_events_with_its_end(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit, lease_s=1.0)
    events = page.locator("#events")
    for _ in range(5):  # a stall of a loaded machine may end one
        press_arm(page)
        begin_to_go(page, "2.5")
        page.locator("#relocalize-clearance").fill("4")
        page.get_by_role("button", name="Go", exact=True).click()
        until(lambda: here.hub.control.going is None)
        if "obstacle" in (events.text_content() or ""):
            break
    expect(events).to_contain_text("the robot goes to x 2.50 m, y 0.00 m by itself")
    expect(events).to_contain_text("did not arrive at x 2.50 m, y 0.00 m")


# ---- old and new ----


def test_nothing_sounds_live_when_the_connection_is_lost(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    page.keyboard.down("w")
    expect(page.locator("kbd[data-held='true']")).to_have_text("W")
    here.stop_serving()
    expect(page.locator("#mode")).to_have_text("UNKNOWN")
    expect(page.locator("#knob")).not_to_have_attribute("style", re.compile("translate"))
    expect(page.locator("#control")).to_have_text("Control: not known")
    expect(page.locator("#drive-why")).to_contain_text("Nothing can be driven from here")
    expect(page.locator("#asked")).to_be_empty()
    expect(page.locator("kbd[data-held='true']")).to_have_count(0)
    open_tab(page, "link")
    expect(page.locator("#link-say")).to_contain_text("not known")
    expect(page.locator("#link-figures")).to_be_empty()
    expect(page.locator("#arm")).to_be_disabled()


def test_what_is_known_of_a_lost_robot_has_an_age(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    battery = page.locator("#gauge-text")
    live = battery.evaluate("(node) => getComputedStyle(node).color")
    here.sim.set("power", False)
    expect(page.locator("#banner")).to_contain_text("ROBOT LOST")
    expect(page.locator("#quality-say")).to_have_text("Lost 3\u202fs")
    assert battery.evaluate("(node) => getComputedStyle(node).color") != live


def test_nothing_can_be_answered_set_or_recorded_without_a_connection(
    station: Make, visit: Visit
) -> None:
    here = station()
    page, other = visit(here.url), visit(here.url)
    ready(page)
    take_control(page)
    other.locator("#take").click()
    expect(page.locator("#asked-by")).to_be_visible()
    open_tab(page, "events")
    page.locator("#record").click()
    expect(page.locator("#recording")).to_be_visible()
    page.locator("#map-relocalize").click()
    here.stop_serving()
    expect(page.locator("#mode")).to_have_text("UNKNOWN")
    for name in ("#asked-by", "#relocalize", "#map-relocalize", "#recording"):
        expect(page.locator(name)).to_be_hidden()
    expect(page.locator("#drive-why")).to_be_visible()
    expect(page.locator("#record")).to_be_disabled()
    expect(page.locator("#record-text")).to_have_text("not known")


def test_a_refusal_ends_with_its_reason(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    take_control(page)
    here.sim.set("pad_a", True)
    expect(page.locator("#banner-title")).to_have_text("OVERRIDE")
    page.locator("#arm").click()
    expect(page.locator("#drive-why")).to_have_text(re.compile("^(?!Not ready).*release"))
    here.sim.set("pad_a", False)
    expect(page.locator("#drive-why")).to_contain_text("Is the way clear", timeout=4000)


def test_an_input_that_is_not_sent_says_so(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    take_control(page)
    hold_pad(page, rt=1.0)
    expect(page.locator("#asked")).to_have_text("game pad: not sent")


def test_a_plot_has_a_gap_where_nothing_was_received(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit, enable_drive=False)
    gap = page.evaluate(
        """async () => {
            const { Plots } = await import("/static/plots.js");
            const plots = new Plots();
            plots.add(100, { speed: 1 });
            plots.add(101, { speed: 2 });
            plots.add(110, { speed: 3 });
            return plots.column("speed");
        }"""
    )
    assert gap == [1, 2, None, 3]
    old = page.evaluate(
        """async () => {
            const { Plots } = await import("/static/plots.js");
            const plots = new Plots();
            const link = { round_trip_ms: 1, loss: 0 };
            const frame = { state: "ready", stale: ["differential"], speeds: [1, 1, 1, 1], link };
            plots.show({ ...frame, time_s: 100 }, false);
            return plots.column("speed");
        }"""
    )
    assert old == [None]
    kept = page.evaluate(
        """async () => {
            const { Plots } = await import("/static/plots.js");
            const plots = new Plots();
            const times = [100, 105, 110, 115, 120, 125];
            const speeds = [times, ...[1, 2, 3, 4].map((speed) => times.map(() => speed))];
            plots.begin(speeds, [[101, 111, 121], [99, null, 98], [24, null, 23]]);
            return plots.times.map((time, row) => [time, plots.column("battery")[row]])
                .filter(([, value]) => value !== undefined);
        }"""
    )
    assert kept == [[101, 99], [111, None], [115, None], [120, None], [121, 98]]


def test_a_page_that_opens_later_has_the_same_gaps(station: Make) -> None:
    here = station(enable_drive=False)
    until(lambda: here.hub._latest.get("battery") and here.hub._latest.get("speeds"))
    history = History()
    frames = Frames(here.robot, history)
    frames.take(0.0, 100.0)
    frames._stale = ["differential", "battery"]
    frames.take(0.0, 200.0)
    assert history.speeds.columns()[1] == [0.0, None]
    assert history.battery.columns()[1] == [100.0, None]


# ---- what else may be wrong ----


def test_a_charger_and_a_lost_pose_are_told_and_logged(station: Make, visit: Visit) -> None:
    here, page = armed(station, visit)
    here.sim.set("charger", True)
    expect(page.locator("#banner-title")).to_have_text("CHARGER PLUGGED IN")
    expect(page.locator("#banner-text")).to_contain_text("unplug")
    here.sim.set("localization_flags", 82)
    expect(page.locator("#banner-more")).to_contain_text("POSE WRONG")
    events = page.locator("#events")
    expect(events).to_contain_text("the charger was plugged in")
    expect(events).to_contain_text("armed or moving with the charger plugged in")
    expect(events).to_contain_text("the localization reports an error")
    here.sim.set("charger", False)
    here.sim.set("localization_flags", 18)
    expect(events).to_contain_text("the charger was unplugged")
    expect(events).to_contain_text("the localization works again")
    expect(page.locator("#banner-more")).to_be_empty()


def test_a_bumper_is_logged(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    events = page.locator("#events")
    for pressed, text in ((True, "the rear bumper was pressed"), (False, "was released")):
        here.sim.set("rear_bumper", pressed)
        expect(events).to_contain_text(text)


def test_a_commander_that_stop_cannot_stop_is_told(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    with roburoc4.connect(here.sim.address) as other:
        other.arm()

        def told() -> bool:
            other.drive(0.0, 0.4)
            return page.locator("#banner-title").text_content() == "ANOTHER COMMANDER"

        until(told)
        text = page.locator("#banner-text").text_content() or ""
    assert "STOP here cannot stop it, the robot\u2019s emergency stop can" in text


def test_an_alarm_sounds_and_vibrates_for_whoever_wants_it(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    page.evaluate("window.shakes = 0; navigator.vibrate = () => { shakes += 1; return true; }; 0")
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
    assert page.evaluate("shakes") == 0
    here.sim.set("front_bumper", False)
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    open_tab(page, "link")
    page.get_by_role("button", name="alarm sound").click()
    assert page.evaluate("shakes") == 1
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
    assert page.evaluate("shakes") == 2


def test_an_alarm_sounds_on_a_page_that_was_loaded_again(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url, forgive="Blocked call to navigator.vibrate")
    ready(page)
    open_tab(page, "link")
    page.get_by_role("button", name="alarm sound").click()
    page.reload()
    ready(page)
    # Browsers suspend a sound that begins before the page is touched.
    expect(page.locator("#sound")).to_have_text("alarm sound: press any key first")
    page.evaluate("""window.resumed = 0; {
        const resume = AudioContext.prototype.resume;
        AudioContext.prototype.resume = function () { resumed += 1; return resume.call(this); };
    } 0;""")
    for times in (1, 2):
        here.sim.set("front_bumper", True)
        page.wait_for_function("(times) => resumed === times", arg=times)
        here.sim.set("front_bumper", False)
        expect(page.locator("#banner-title")).to_have_text("DISARMED")
    page.keyboard.press("x")
    expect(page.locator("#sound")).to_have_text("alarm sound")


def test_a_charger_is_seen_before_the_robot_is_armed(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    take_control(page)
    here.sim.set("charger", True)
    expect(page.locator("#drive-why")).to_contain_text("The charger is plugged in")
    for state in ("charging", "charged"):
        shown = page.evaluate(
            """async (state) => {
                const { showBattery } = await import("/static/status.js");
                const battery = { state, percent: 100, volts: 25, trend_percent_h: 0 };
                showBattery({ battery }, {});
                return document.getElementById("gauge-text").textContent;
            }""",
            state,
        )
        assert "⚡" in shown, state


def test_stop_on_the_driver_s_own_page_was_pressed_here(station: Make, visit: Visit) -> None:
    page = visit(station().url)
    arm(page)
    page.locator("#stop").click()
    expect(page.locator("#banner-text")).to_contain_text("STOP was pressed here.")


def test_the_pale_band_shows_what_the_slider_gives(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)

    def band() -> float:
        width = page.locator("#speed-linear .full").evaluate("(node) => node.style.width")
        return float(width.rstrip("%"))

    for percent in (100, 30):
        page.locator("#scale").fill(str(percent))
        share = pytest.approx(100 * math.sqrt(percent / 100 / 2.6), abs=0.5)
        until(lambda share=share: band() == share)  # it needs the robot's limits


def test_a_recording_that_is_replayed_says_so(tmp_path: Path) -> None:
    path = tmp_path / "run.pcapng"
    with (
        roburoc4.Simulator(port=0) as sim,
        roburoc4.connect(sim.address, record=path) as robot,
    ):
        until(lambda: robot.facts.descriptions_done and robot.link.received > 100)
    command = "from roburoc4_tools.cli import main; main()"
    port = str(free_port())
    arguments = ["replay", str(path), "--port", port, "--loop"]
    with subprocess.Popen([sys.executable, "-c", command, *arguments]) as replaying:
        try:
            with roburoc4.connect(f"127.0.0.1:{port}", wait=False) as robot:
                frames = Frames(robot, History())

                def recorded() -> bool:
                    frames.take(robot.now_s, 0.0)
                    frames.about(robot.now_s)
                    return bool(frames.known.get("recorded"))

                until(recorded)
        finally:
            replaying.terminate()


def replays(here: Station) -> None:
    """From the next look at the robot's properties on, they are those of a recording."""
    frames = here.hub._frames
    describe = frames._describe
    frames._describe = lambda: describe() | {"recorded": True}  # type: ignore[method-assign]
    frames._about_old = True


def test_the_page_says_what_it_shows(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    page = visit(here.url)
    expect(page.locator("#kind")).to_have_text("real")
    replays(here)
    page.reload()
    expect(page.locator("#kind")).to_have_text("replayed")


def test_a_recording_cannot_be_armed_and_asks_for_no_remedy(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    replays(here)
    page.reload()
    ready(page)
    expect(page.locator("#drive-why")).to_contain_text("A recording is replayed")
    take_control(page)
    expect(page.locator("#drive-why")).to_contain_text("A recording is replayed")
    expect(page.locator("#arm")).to_be_disabled()
    page.evaluate("document.getElementById('arm').disabled = false")
    page.evaluate("document.getElementById('arm').click()")
    page.wait_for_timeout(300)
    assert not here.robot.facts.armed
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
    expect(page.locator("#banner")).not_to_contain_text("Try:")


WRITES = """
window.written = {};
const fillText = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  window.written[text] = [x, y];
  return fillText.call(this, text, x, y);
};
"""


def test_robots_at_the_same_place_have_their_names_below_one_another(
    station: Make, visit: Visit
) -> None:
    page = visit(station(robots=("ANNA", "BELA", "CARL")).url, init=WRITES)
    ready(page)
    page.wait_for_function("['ANNA', 'BELA', 'CARL'].every((name) => name in written)")
    heights = sorted(page.evaluate("['ANNA', 'BELA', 'CARL'].map((name) => written[name][1])"))
    assert all(low - high >= 14 for high, low in itertools.pairwise(heights))


# ---- back in time ----


def test_a_robot_that_stood_has_been_there_since_it_arrived(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    now_s = time.time()
    here.hub._history.path.clear()
    here.hub._history.add_place(now_s - 300, 1.0, 0.0, 0.0)
    page = visit(here.url, init=WRITES)
    ready(page)
    page.locator("#map-past").click()
    page.locator("#past-at").fill("-100")
    page.wait_for_function("() => Object.keys(written).some((text) => text.startsWith('here '))")
    texts = page.evaluate("Object.keys(written).filter((text) => text.startsWith('here '))")
    since = time.strftime("%H:%M:%S", time.localtime(now_s - 300))
    assert texts == [f"here since {since}"]


def plot_says_the_moment_of_the_slider(page: Page) -> str:
    """Wait until the plot's legend is at most a second off, as it shows the nearest value."""
    moment = (page.locator("#past-text").text_content() or "").split(",")[0]
    page.wait_for_function(
        """moment => {
            const seconds = text => text.split(":").reduce((sum, part) => 60 * sum + +part, 0);
            const legend = document.querySelector(".u-legend .u-value").textContent;
            return [0, 1, 86399].includes(Math.abs(seconds(legend) - seconds(moment)));
        }""",
        arg=moment,
    )
    return moment


def test_map_and_plots_go_back_in_time_and_stop_stays_live(station: Make, visit: Visit) -> None:
    here = station()
    now_s = time.time()
    for ago in range(300, 0, -1):
        here.hub._history.add_place(now_s - ago, 0.1 * (300 - ago), 1.0, 0.5)
        here.hub._history.add_speeds(now_s - ago, (0.1, 0.1, 0.0, 0.0))
    page = visit(here.url)
    arm(page)
    open_tab(page, "plots")
    page.locator("#map-past").click()
    page.locator("#past-at").fill("-120")
    page.wait_for_function("() => document.getElementById('map').dataset.past")
    x_m, y_m, time_s, theta_rad = map(
        float, (page.locator("#map").get_attribute("data-past") or "").split()
    )
    assert (y_m, theta_rad) == (1.0, 0.5)
    assert x_m == pytest.approx(0.1 * (300 - (now_s - time_s)), abs=0.11)
    shown_s = page.evaluate("Number(document.getElementById('plots').dataset.until)")
    assert shown_s == pytest.approx(time_s + 15, abs=1.5)
    view = page.locator("#map").get_attribute("data-view") or ""
    assert [float(number) for number in view.split()[:2]] == [x_m, y_m], "it follows the past"
    # Map, slider and plot say the same moment, wherever the slider was before.
    moment = plot_says_the_moment_of_the_slider(page)
    page.locator("#past-at").fill("-60")
    expect(page.locator("#past-text")).not_to_contain_text(moment)
    plot_says_the_moment_of_the_slider(page)
    expect(page.locator("#past-text")).to_contain_text("ago")
    page.locator("#stop").click()
    here.wait_for_stop_pressed()
    expect(page.locator("#mode")).to_have_text("DISARMED")
    page.locator("#past-end").click()
    expect(page.locator("#past")).to_be_hidden()
    expect(page.locator("#map")).not_to_have_attribute("data-past", "")
    expect(page.locator("#plot-pause")).to_have_text("pause")


@pytest.mark.parametrize("size", [(1366, 768), (512, 384), (320, 568)])
def test_the_slider_of_the_past_stays_where_it_is_dragged(
    size: tuple[int, int], station: Make, visit: Visit
) -> None:
    here = station(enable_drive=False)
    page = visit(here.url, viewport={"width": size[0], "height": size[1]})
    ready(page)
    page.locator("#map-past").click()
    slider, text = page.locator("#past-at"), page.locator("#past-text")
    expect(text).to_have_text("now")
    before = slider.bounding_box()
    slider.press("Home")
    expect(text).to_contain_text("nothing known")
    expect(page.locator("#pose")).to_have_text("pose not known")
    assert int(slider.get_attribute("min") or 0) > -60, "most of it would be unknown"
    assert slider.bounding_box() == before
    here.hub._history.path.clear()
    here.hub._history.add_place(time.time() - 300, 1.0, 0.0, 0.0)
    page.reload()
    ready(page)
    page.locator("#map-past").click()
    slider.fill("-200")
    expect(text).to_contain_text("ago")
    expect(page.locator("#pose")).to_contain_text("x 1.00")
    assert slider.bounding_box() == before


def test_the_page_keeps_ten_minutes_of_the_trail(station: Make, visit: Visit) -> None:
    page = visit(station(enable_drive=False).url)
    kept_s = page.evaluate("""async () => {
        const { RobotMap } = await import("/static/map.js");
        const path = [];
        for (let frame = 0; frame < 1200 * 30; frame++) {
            RobotMap.prototype.keep(path, { x_m: frame / 15, y_m: 0, theta_rad: 0 }, frame / 30);
        }
        return path.at(-1)[2] - path[0][2];
    }""")
    assert kept_s > 595


# ---- the map's words ----

WORDS = """
window.words = new Map();
const write = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  if (this.canvas.id === "map") words.set(text.replace(/^\\d[.]\\d\\d.*/, "distance"), [x, y]);
  return write.call(this, text, x, y);
};
0;
"""


def test_a_distance_is_written_before_its_wall_and_a_way_before_it_begins(
    station: Make, visit: Visit
) -> None:
    here = station(lease_s=1.0)
    here.sim.clear_obstacles()
    here.sim.add_wall(2.5, -3.0, 2.5, 3.0)
    page = visit(here.url)
    page.evaluate(WORDS)
    page.locator("#map-out").click()  # so that the wall is in view
    arm(page)
    until(lambda: page.evaluate("words.has('distance')"))
    _, y_px = page.evaluate("words.get('distance')")
    height, scale = page.evaluate(
        """(() => { const map = document.getElementById("map");
            return [map.clientHeight, Number(map.dataset.view.split(" ")[2])]; })()"""
    )
    assert 0.7 < (height / 2 - y_px) / scale < 2.5
    begin_to_go(page, "1")
    until(lambda: page.evaluate("words.has('go here?')"))
