# SPDX-License-Identifier: MIT
"""What the page shows, compared with the simulator: values, plots, the map, the past."""

import re
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect
from station import Station, open_tab, ready, take_control, until

from roburoc4_tools.dashboard.frames import Frames
from roburoc4_tools.dashboard.history import History

Visit = Callable[..., Page]
Make = Callable[..., Station]
Opened = Callable[..., tuple[Station, Page]]


def number(text: str | None) -> float:
    found = re.search(r"[\u2212-]?[\d.]+", text or "")
    assert found is not None, text
    return float(found[0].replace("\u2212", "-"))


def test_it_shows_what_the_simulator_reports(station: Make, visit: Visit) -> None:
    here = station(start_x_m=1.5, start_y_m=-2.25, start_theta_rad=1.0, battery_percent=73.0)
    here.sim.add_wall(6.0, -9.0, 6.0, 9.0)
    here.sim.set("pad_rj_x", 0.5)
    here.sim.set("pad_lb", True)
    here.sim.set("rear_bumper", True)
    here.sim.set("pin_analog_0", float("inf"))
    here.hub._history.trend_percent_h = lambda: -20.0
    page = visit(here.url)
    ready(page)
    expect(page.locator("#address")).to_have_text(here.sim.address)
    expect(page.locator("#kind")).to_have_text("real")
    expect(page.locator("#pose")).to_contain_text(re.compile(r"x 1\.50.m +y \u22122\.25.m +θ 57.°"))
    expect(page.locator("#gauge-text")).to_contain_text("73")
    expect(page.locator("#battery-state")).to_have_text("In use")
    trend = page.locator("#battery-text")
    expect(trend).to_contain_text(re.compile("\u2198 \u221220.% per hour, .*h to the minimum"))
    open_tab(page, "io")
    battery = page.locator('#analog-inputs li:has-text("Battery voltage") b')
    expect(battery).to_have_text(re.compile(r"\d"))
    until(lambda: abs(number(battery.text_content()) - here.sim.state.battery_v) < 0.02)
    expect(page.locator("#analog-inputs li[data-input='0'] b")).to_contain_text("\u2013")
    expect(page.locator("#analog-inputs li[data-input='5'] b")).to_have_text("0.50")
    expect(page.locator('#digital-inputs li:has-text("LB")')).to_have_attribute("data-on", "yes")
    expect(page.locator('#digital-inputs li:has-text("RB")')).to_have_attribute("data-on", "no")
    for name, count in (("digital-inputs", 22), ("analog-inputs", 9), ("outputs", 8)):
        expect(page.locator(f"#{name} li")).to_have_count(count)


def test_speeds_targets_and_limits_are_the_robot_s(watched: Opened) -> None:
    here, page = watched(slip=0.0)
    marks = page.locator("#speed-linear .marks span")
    until(lambda: {"\u22122.6", "0.3", "2.6"} <= set(marks.all_text_contents()))
    style = "(node) => [node.style.left, node.style.width].map(parseFloat)"
    for percent, band in ((100, 62.0), (30, 34.0)):  # the root of 0.3 of 2.6 m/s, both ways
        page.locator("#scale").fill(str(percent))
        full = page.locator("#speed-linear .full")
        until(lambda full=full, band=band: abs(full.evaluate(style)[1] - band) < 0.5)
    here.sim.set("pad_a", True)
    here.sim.set("pad_lj_x", -0.2)
    here.sim.set("pad_rt", -0.6)
    state = here.sim.state
    until(lambda: here.sim.state.wheel_linear_m_s > 0.51)
    for name, at, least in (
        ("linear", "wheel_linear_m_s", 0.4),
        ("angular", "wheel_angular_rad_s", 0.1),
    ):
        shown = page.locator(f"#speed-{name} .value")
        until(
            lambda shown=shown, at=at: (
                abs(number(shown.text_content()) - getattr(here.sim.state, at)) < 0.1
            )
        )
        assert number(shown.text_content()) > least
        left, width = page.locator(f"#speed-{name} .fill").evaluate(style)
        assert (left >= 49.9) is (name == "linear"), "ahead is right, and a left turn left"
        assert width > 5
    expect(page.locator("#speed-linear .target")).to_contain_text("0.52")
    assert state.speed_commands == 0


def test_a_bad_link_is_explained_in_plain_words(watched: Opened) -> None:
    here, page = watched(enable_drive=False, panel=True)
    expect(page.locator("#stop")).to_be_hidden()
    expect(page.get_by_role("button", name="Take control")).to_be_hidden()
    here.hub.panel.set_faults({"loss": 0.2})
    expect(page.locator("#banner-text")).to_contain_text("of the statuses are lost")
    expect(page.locator("#link-try")).to_contain_text("cable instead of radio")
    share = re.compile(r"loss ([5-9]|[1-4]\d)\.\d\u202f%")
    expect(page.locator("#link-figures")).to_contain_text(share)
    open_tab(page, "sim")
    page.get_by_role("button", name="Restore the network").click()
    expect(page.locator("#quality-say")).to_have_text("Link good")
    expect(page.locator("#link-try")).to_be_empty()


def test_a_charger_and_a_replayed_recording_are_told_before_arming(watched: Opened) -> None:
    here, page = watched()
    take_control(page)
    here.sim.set("charger", True)
    expect(page.locator("#drive-why")).to_contain_text("The charger is plugged in")
    expect(page.locator("#gauge-text")).to_contain_text("⚡")
    frames = here.hub._frames
    describe = frames._describe
    frames._describe = lambda: describe() | {"recorded": True}  # type: ignore[method-assign]
    frames._about_old = True
    page.reload()
    ready(page)
    expect(page.locator("#kind")).to_have_text("replayed")
    take_control(page)
    expect(page.locator("#drive-why")).to_contain_text("A recording is replayed")
    expect(page.locator("#arm")).to_be_disabled()
    page.evaluate("{ const { arm } = window; arm.disabled = false; arm.click(); }")
    expect(page.locator("#drive-why")).to_contain_text("nothing can be driven")
    page.wait_for_timeout(300)
    assert not here.robot.facts.armed


# ---- plots ----


def right_edge(page: Page) -> float:
    """The newest time that the first plot shows."""
    return float(page.evaluate("document.getElementById('plots').dataset.until"))


def test_plots_scroll_pause_and_zoom(
    watched: Opened, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, page = watched(enable_drive=False)
    open_tab(page, "plots")
    begun_s = right_edge(page)
    until(lambda: right_edge(page) > begun_s + 0.5)
    span, pause = page.locator("#plot-span"), page.locator("#plot-pause")
    expect(page.locator("#plots .u-legend")).to_contain_text("speed, target")
    expect(span).to_have_text("30 s")
    page.locator("#plot-more").click(click_count=2)
    expect(span).to_have_text("2 min")
    page.locator("#plot-less").click(click_count=2)
    pause.click()
    expect(pause).to_have_text("continue")
    paused_s = right_edge(page)
    time.sleep(0.5)
    assert right_edge(page) == paused_s
    pause.click()
    until(lambda: right_edge(page) > paused_s + 0.5)
    box = page.locator("#plots .u-over").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 50, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 50 + box["width"] / 4, box["y"] + 20, steps=4)
    page.mouse.up()
    expect(pause).to_have_text("continue")
    expect(span).to_have_text("7.5 s")
    page.mouse.dblclick(box["x"] + 100, box["y"] + 20)
    expect(pause).to_have_text("pause")
    expect(span).to_have_text("30 s")
    now = time.time
    clock = SimpleNamespace(time=lambda: now() - 86400)  # the clock is set back
    monkeypatch.setattr("roburoc4_tools.dashboard.hub.time", clock)
    until(lambda: right_edge(page) < now() - 80000)
    edge_s = right_edge(page)
    until(lambda: right_edge(page) > edge_s + 0.5)
    ready(visit(here.url))


def test_any_signal_can_be_plotted_read_and_exported(watched: Opened) -> None:
    here, page = watched(battery_percent=61.0)
    open_tab(page, "plots")
    page.locator(".signals summary").click()
    for name in ("battery", "voltage", "distance_0", "digital_3", "round_trip", "loss", "turn"):
        page.locator(f"#plot-signals input[name={name}]").check()
    expect(page.locator("#plots .uplot")).to_have_count(8)
    expect(page.locator("#plots")).to_contain_text(re.compile("battery ?61"))
    page.wait_for_timeout(500)
    with page.expect_download() as download:
        page.locator("#plot-export").click()
    lines = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    names = "speed,target,turn,battery,voltage,round_trip,loss,distance_0,digital_3"
    assert lines[0] == f"time_s,{names}"
    last = dict(zip(names.split(","), map(float, lines[-1].split(",")[1:]), strict=True))
    assert last["battery"] == 61.0
    assert last["distance_0"] == pytest.approx(here.sim.state.distances_m[0], abs=0.1)
    page.reload()
    expect(page.locator("#plots .uplot")).to_have_count(8)
    page.keyboard.press("Escape")
    expect(page.locator("#panel-plots")).to_be_hidden()


def test_what_was_not_received_is_a_gap_in_plots_and_ten_minutes_of_trail_are_kept(
    watched: Opened,
) -> None:
    here, page = watched(enable_drive=False)
    live, old, kept, trail_s = page.evaluate(
        """async () => {
            const { Plots } = await import("/static/plots.js");
            const { RobotMap } = await import("/static/map.js");
            const live = new Plots();
            for (const [time, speed] of [[100, 1], [101, 2], [110, 3]]) live.add(time, { speed });
            const old = new Plots();
            const link = { round_trip_ms: 1, loss: 0 };
            const frame = { state: "ready", stale: ["differential"], speeds: [1, 1, 1, 1], link };
            old.show({ ...frame, time_s: 100 }, false);
            const kept = new Plots();
            const times = [100, 105, 110, 115, 120, 125];
            const speeds = [times, ...[1, 2, 3, 4].map((speed) => times.map(() => speed))];
            kept.begin(speeds, [[101, 111, 121], [99, null, 98], [24, null, 23]]);
            const path = [];
            for (let frame = 0; frame < 1200 * 30; frame++) {
                const pose = { x_m: frame / 15, y_m: 0, theta_rad: 0 };
                RobotMap.prototype.keep(path, pose, frame / 30);
            }
            return [live.column("speed"), old.column("speed"),
                kept.times.map((time, row) => [time, kept.column("battery")[row]])
                    .filter(([, value]) => value !== undefined), path.at(-1)[2] - path[0][2]];
        }"""
    )
    assert live == [1, 2, None, 3]
    assert old == [None]
    assert kept == [[101, 99], [111, None], [115, None], [120, None], [121, 98]]
    assert trail_s > 595
    until(lambda: here.hub._latest.get("battery") and here.hub._latest.get("speeds"))
    history = History()
    frames = Frames(here.robot, history)
    frames.take(0.0, 100.0)
    frames._stale = ["differential", "battery"]
    frames.take(0.0, 200.0)
    assert history.speeds.columns()[1] == [0.0, None], "a page that opens later has the same gaps"
    assert history.battery.columns()[1] == [100.0, None]


# ---- the view from above ----


def view(page: Page) -> list[float]:
    return [float(part) for part in (page.locator("#map").get_attribute("data-view") or "").split()]


def trail(page: Page) -> int:
    return int(page.locator("#map").get_attribute("data-trail") or 0)


def test_a_trail_survives_a_reload_and_stays_cleared(watched: Opened, visit: Visit) -> None:
    here, page = watched()
    other = visit(here.url)
    ready(other)
    here.sim.set("pad_a", True)
    here.sim.set("pad_rt", 0.0)
    until(lambda: here.sim.state.true_x_m > 1.0)
    here.sim.set("pad_a", False)
    until(lambda: here.sim.state.wheel_linear_m_s == 0)
    page.reload()
    ready(page)
    until(lambda: trail(page) > 20)
    expect(page.locator("#events")).to_contain_text("[A] is held")
    page.locator("#map-clear").click()
    until(lambda: trail(page) <= 1)
    until(lambda: trail(other) <= 1)
    page.reload()
    ready(page)
    page.wait_for_timeout(300)
    assert trail(page) <= 1


WORDS = """
window.words = {};
const write = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  if (this.canvas.id === "map") words[text.replace(/^\\d[.]\\d\\d.*/, "distance")] = [x, y];
  return write.call(this, text, x, y);
};
0;
"""


@pytest.mark.parametrize("turned", [False, True])
def test_what_telemeters_see_is_drawn_where_they_are_mounted(
    turned: bool, station: Make, visit: Visit
) -> None:
    here = station(start_theta_rad=1.5708 if turned else 0.0)
    here.sim.clear_obstacles()
    here.sim.add_wall(*((-3.0, 2.2, 3.0, 2.2) if turned else (2.2, -3.0, 2.2, 3.0)))
    page = visit(here.url, init=WORDS)
    ready(page)
    page.locator("#map-out").click()  # so that the wall is in view
    page.wait_for_function("'distance' in words")
    time.sleep(0.3)
    x_px, y_px = page.evaluate("words.distance")
    wide, high = page.evaluate(
        "[document.getElementById('map').clientWidth, document.getElementById('map').clientHeight]"
    )
    ahead, left = (high / 2 - y_px) / view(page)[2], (wide / 2 - x_px) / view(page)[2]
    there, beside = (left, ahead) if turned else (ahead, left)
    assert 0.7 < there < 2.2, "before the wall"
    assert abs(beside) < 0.5


def test_map_and_plots_go_back_in_time_and_stop_stays_live(armed: Opened) -> None:
    here, page = armed()
    now_s = time.time()
    here.hub._history.path.clear()
    here.hub._history.speeds.clear()
    for ago in range(300, 0, -1):
        here.hub._history.add_place(now_s - ago, 0.1 * (300 - ago), 1.0, 0.5)
        here.hub._history.speeds.append((now_s - ago, 0.1, 0.1, 0.0, 0.0))
    page.evaluate(WORDS)
    page.evaluate("localStorage.setItem('signals', '[\"speed\"]')")
    page.reload()
    ready(page)
    open_tab(page, "plots")
    page.locator("#map-past").click()
    expect(page.locator("#past-text")).to_have_text("now")
    page.locator("#past-at").fill("-120")
    page.wait_for_function("() => document.getElementById('map').dataset.past")
    x_m, y_m, time_s, theta_rad = map(
        float, (page.locator("#map").get_attribute("data-past") or "").split()
    )
    assert (y_m, theta_rad) == (1.0, 0.5)
    assert x_m == pytest.approx(0.1 * (300 - (now_s - time_s)), abs=0.11)
    assert right_edge(page) == pytest.approx(time_s + 15, abs=1.5)
    assert view(page)[:2] == [x_m, y_m], "it follows the past"
    expect(page.locator("#past-text")).to_contain_text("ago")
    page.locator("#past-at").fill("-300")
    expect(page.locator("#pose")).to_have_text(re.compile("pose not known|x 0"))
    page.locator("#stop").click()
    here.wait_for_stop_pressed()
    expect(page.locator("#mode")).to_have_text("DISARMED")
    page.keyboard.press("Escape")
    expect(page.locator("#past")).to_be_hidden()
    expect(page.locator("#plot-pause")).to_have_text("pause")
