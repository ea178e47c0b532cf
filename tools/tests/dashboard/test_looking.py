# SPDX-License-Identifier: MIT
"""What the page shows, compared with the simulator."""

import math
import re
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect
from station import Station, open_tab, ready, until, watched

import roburoc4_tools.dashboard

Visit = Callable[..., Page]
Make = Callable[..., Station]

REFUSED = "Content Security Policy|violates the following directive"


def number(text: str | None) -> float:
    found = re.search(r"[\u2212-]?[\d.]+", text or "")
    assert found is not None, text
    return float(found[0].replace("\u2212", "-"))


@pytest.mark.both
def test_it_shows_what_the_simulator_reports(station: Make, visit: Visit) -> None:
    here = station(start_x_m=1.5, start_y_m=-2.25, start_theta_rad=1.0, battery_percent=73.0)
    here.sim.add_wall(6.0, -9.0, 6.0, 9.0)
    here.sim.set("pad_rj_x", 0.5)
    here.sim.set("pad_lb", True)
    here.sim.set("rear_bumper", True)
    page = visit(here.url)
    ready(page)
    expect(page.locator("#address")).to_have_text(here.sim.address)
    expect(page.locator("#pose")).to_contain_text(re.compile(r"x 1\.50.m +y \u22122\.25.m +θ 57.°"))
    expect(page.locator("#gauge-text")).to_contain_text("73")
    expect(page.locator("#battery-state")).to_have_text("In use")
    open_tab(page, "io")
    battery = page.locator('#analog-inputs li:has-text("Battery voltage") b')
    expect(battery).to_have_text(re.compile(r"\d"))
    until(lambda: abs(number(battery.text_content()) - here.sim.state.battery_v) < 0.02)
    front = page.locator('#analog-inputs li:has-text("Front telemeter") b')
    until(lambda: abs(number(front.text_content()) - here.robot.inputs.analog(0)) < 0.01)
    expect(page.locator("#analog-inputs li[data-input='5'] b")).to_have_text("0.50")
    expect(page.locator('#digital-inputs li:has-text("LB")')).to_have_attribute("data-on", "yes")
    expect(page.locator('#digital-inputs li:has-text("RB")')).to_have_attribute("data-on", "no")
    expect(page.locator("#banner-title")).to_have_text("REAR BUMPER")
    expect(page.locator("#digital-inputs li")).to_have_count(22)
    expect(page.locator("#analog-inputs li")).to_have_count(9)
    expect(page.locator("#outputs li")).to_have_count(8)


def test_speeds_targets_and_limits_are_the_robot_s(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, enable_drive=False, slip=0.0)
    marks = page.locator("#speed-linear .marks span")
    until(lambda: {"\u22122.6", "0.3", "2.6"} <= set(marks.all_text_contents()))
    here.sim.set("pad_a", True)
    here.sim.set("pad_lj_x", -0.2)
    here.sim.set("pad_rt", -0.6)
    shown = page.locator("#speed-linear .value"), page.locator("#speed-angular .value")
    until(lambda: here.sim.state.wheel_linear_m_s > 0.51)
    until(
        lambda: (
            abs(number(shown[0].text_content()) - here.sim.state.wheel_linear_m_s) < 0.05
            and abs(number(shown[1].text_content()) - here.sim.state.wheel_angular_rad_s) < 0.1
        )
    )
    expect(page.locator("#speed-linear .target")).to_contain_text("0.52")


def test_override_and_loss_are_unmistakable(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, enable_drive=False)
    here.sim.set("pad_a", True)
    expect(page.locator("#banner-title")).to_have_text("OVERRIDE")
    expect(page.locator("#banner")).to_have_attribute("data-level", "bad")
    here.sim.set("pad_a", False)
    expect(page.locator("#banner")).to_have_attribute("data-level", "calm")
    here.sim.set("power", False)
    expect(page.locator("#banner-title")).to_have_text("ROBOT LOST")
    expect(page.locator("#link-try")).to_contain_text("cable")
    expect(page.locator("#link-figures")).to_contain_text("round trip \u2013")
    expect(page.locator("#link-figures")).to_contain_text("loss \u2013")
    expect(page.locator("#services td:nth-child(4)").first).to_have_text("\u2013 %")
    here.sim.set("power", True)
    ready(page)
    expect(page.locator("#events")).to_contain_text("fell silent")


def test_the_most_urgent_condition_has_the_banner(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, battery_percent=60.0)
    title, others = page.locator("#banner-title"), page.locator("#banner-more")
    expect(title).to_have_text("DISARMED")
    for warn, first, also in (
        (lambda: here.sim.set("battery_percent", 3.0), "BATTERY CRITICAL", ""),
        (lambda: here.sim.set("pad_a", True), "OVERRIDE", "BATTERY CRITICAL"),
        (lambda: here.sim.set("rear_bumper", True), "REAR BUMPER", "OVERRIDEBATTERY CRITICAL"),
        (lambda: here.sim.set("power", False), "ROBOT LOST", ""),
    ):
        warn()
        expect(title).to_have_text(first)
        expect(others).to_have_text(also)


def test_no_count_of_seconds_is_spoken(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit)
    here.sim.set("power", False)
    expect(page.locator("#spoken")).to_contain_text("ROBOT LOST")
    page.evaluate(
        """window.spoken = 0;
        new MutationObserver(() => { spoken += 1; }).observe(document.getElementById("spoken"),
            { childList: true, characterData: true, subtree: true })"""
    )
    page.wait_for_timeout(2500)
    assert page.evaluate("spoken") == 0


def test_a_bad_link_is_explained_in_plain_words(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit, enable_drive=False, panel=True)
    open_tab(page, "sim")
    page.locator("#sim input[name=loss]").fill("20")
    expect(page.locator("#banner-text")).to_contain_text("of the statuses are lost", timeout=30_000)
    expect(page.locator("#link-try")).to_contain_text("cable instead of radio")
    page.get_by_role("button", name="Restore the network").click()
    expect(page.locator("#quality-say")).to_have_text("Link good", timeout=60_000)
    expect(page.locator("#link-try")).to_be_empty()
    expect(page.locator("#banner")).not_to_contain_text("Try:")


def test_a_page_that_opens_later_sees_what_happened(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    first = visit(here.url)
    ready(first)
    here.sim.set("pad_a", True)
    here.sim.set("pad_rt", 0.0)
    until(lambda: here.sim.state.true_x_m > 0.5)
    second = visit(here.url)
    ready(second)
    expect(second.locator("#events")).to_contain_text("[A] is held")
    assert len(here.hub._history.path) > 10
    assert len(here.hub._history.speeds) > 5


def test_plots_scroll_pause_and_zoom(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit, enable_drive=False)
    open_tab(page, "plots")
    span = page.locator("#plot-span")
    expect(page.locator("#plots .u-legend")).to_contain_text("speed, target")
    expect(span).to_have_text("30 s")
    page.locator("#plot-less").click()
    expect(span).to_have_text("10 s")
    page.locator("#plot-more").click(click_count=3)
    expect(span).to_have_text("2 min")
    pause = page.locator("#plot-pause")
    pause.click()
    expect(pause).to_have_text("continue")
    pause.click()
    over = page.locator("#plots .u-over")
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 50, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 50 + box["width"] / 4, box["y"] + 20, steps=4)
    page.mouse.up()
    expect(pause).to_have_text("continue")
    expect(span).to_have_text("30 s")
    page.mouse.dblclick(box["x"] + 100, box["y"] + 20)
    expect(pause).to_have_text("pause")


def test_any_signal_can_be_plotted_read_and_exported(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, battery_percent=61.0)
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


def right_edge(page: Page) -> float:
    """The newest time that the first plot shows."""
    return float(page.evaluate("document.getElementById('plots').dataset.until"))


def test_plots_continue_until_they_are_paused(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit, enable_drive=False)
    open_tab(page, "plots")
    begun_s = right_edge(page)
    until(lambda: right_edge(page) > begun_s + 0.5)
    page.locator("#plot-pause").click()
    paused_s = right_edge(page)
    time.sleep(1.0)
    assert right_edge(page) == paused_s
    page.locator("#plot-pause").click()
    until(lambda: right_edge(page) > paused_s + 1.0)


def test_the_battery_s_trend_is_shown_in_words(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False, battery_percent=60.0)
    here.hub._history.trend_percent_h = lambda: -20.0
    page = visit(here.url)
    ready(page)
    text = page.locator("#battery-text")
    expect(text).to_contain_text("\u2198 \u221220\u202f% per hour")
    expect(text).to_contain_text("2.0\u202fh to the minimum")


@pytest.mark.both
def test_the_page_asks_no_other_host_for_anything(station: Make, visit: Visit) -> None:
    here = station(panel=True)
    page = visit(here.url, forgive=REFUSED)
    ready(page)
    asked = page.evaluate("performance.getEntriesByType('resource').map((entry) => entry.name)")
    assert len(asked) > 10
    assert [url for url in asked if not url.startswith(here.url)] == []
    refused = page.evaluate(
        """async () => {
            const told = new Promise((resolve) => {
                addEventListener("securitypolicyviolation", (event) => resolve(event.blockedURI));
            });
            fetch("http://127.0.0.1:9/").catch(() => {});
            return told;
        }"""
    )
    assert "127.0.0.1:9" in refused


def test_the_page_stays_small() -> None:
    static = Path(roburoc4_tools.dashboard.__file__).parent / "static"
    loaded = [
        path for path in static.rglob("*.*") if path.suffix in (".html", ".js", ".css", ".svg")
    ]
    assert len(loaded) > 20
    assert sum(path.stat().st_size for path in loaded) <= 200_000


def test_a_clock_that_is_set_back_leaves_the_page_alive(
    station: Make, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, page = watched(station, visit, enable_drive=False)
    open_tab(page, "plots")
    now = time.time
    monkeypatch.setattr(
        "roburoc4_tools.dashboard.hub.time", SimpleNamespace(time=lambda: now() - 86400)
    )
    until(lambda: right_edge(page) < now() - 80000)
    edge_s = right_edge(page)
    until(lambda: right_edge(page) > edge_s + 0.5)
    visit(here.url)


def test_the_theme_can_be_chosen_and_is_kept(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    page = visit(here.url, color_scheme="dark")
    root = page.locator("html")
    expect(root).to_have_attribute("data-theme", "dark")
    open_tab(page, "link")
    page.locator("#theme").click()
    expect(root).to_have_attribute("data-theme", "light")
    page.reload()
    expect(root).to_have_attribute("data-theme", "light")


def test_a_dashboard_without_a_robot_says_what_to_try(station: Make, visit: Visit) -> None:
    here = station()
    here.sim.set("power", False)
    page = visit(here.url)
    expect(page.locator("#banner-title")).to_have_text(re.compile("NO ROBOT YET|ROBOT LOST"))
    expect(page.locator("#banner-text")).to_contain_text("Try: ")


def test_missing_numbers_are_dashes_and_the_page_keeps_working(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False)
    here.sim.set("pin_analog_0", float("nan"))
    here.sim.set("pin_analog_2", float("inf"))
    page = visit(here.url)
    ready(page)
    open_tab(page, "io")
    expect(page.locator("#analog-inputs li[data-input='0'] b")).to_contain_text("\u2013")
    expect(page.locator("#battery-text")).not_to_contain_text("NaN")
    here.sim.set("pin", 0)
    expect(page.locator("#battery-text")).to_contain_text("V")


# ---- the simulator's panel ----


def test_switches_of_the_panel_do_what_they_say(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    open_tab(page, "sim")
    for name in (
        "estop_local",
        "estop_remote",
        "brakes_released",
        "charger",
        "front_bumper",
        "rear_bumper",
        "overridden",
    ):
        box = page.locator(f"#sim input[name={name}]")
        box.check()
        until(lambda name=name: getattr(here.sim.state, name))
        box.uncheck()
        until(lambda name=name: not getattr(here.sim.state, name))


def test_motor_power_needs_what_the_manual_says(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    open_tab(page, "sim")
    page.locator("#sim input[name=estop_local]").check()
    motor = page.get_by_role("button", name="Press the motor power button")
    motor.click()
    expect(page.locator("#drive-why")).to_contain_text("release both emergency stops")
    page.locator("#sim input[name=estop_local]").uncheck()
    motor.click()
    until(lambda: here.sim.state.motors_enabled)
    expect(page.get_by_role("button", name="Motor power is on")).to_be_visible()


def test_power_off_and_on_is_a_reboot_with_the_same_page(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    open_tab(page, "sim")
    power = page.locator("#sim input[name=powered]")
    power.uncheck()
    expect(page.locator("#banner-title")).to_have_text("ROBOT LOST")
    power.check()
    ready(page)
    assert here.sim.state.reboots == 1


@pytest.mark.both
def test_an_obstacle_is_dragged_and_the_telemeter_sees_it(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
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


def test_true_pose_is_shown_beside_odometry(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    here.sim.place(1.0, 2.0, 0.5)
    expect(page.locator("#sim-state")).to_contain_text(re.compile(r"x 1\.00.m +y 2\.00.m"))
    expect(page.locator("#pose")).to_contain_text(re.compile(r"x 0\.00.m"))


def test_faults_of_the_network_reach_the_simulator(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    open_tab(page, "sim")
    for name, moved, fault in (
        ("duplicate", "10", 0.1),
        ("reorder", "5", 0.05),
        ("corrupt", "1", 0.01),
        ("delay_ms", "40", 40.0),
        ("jitter_ms", "5", 5.0),
    ):
        page.locator(f"input[name={name}]").fill(moved)
        until(lambda name=name, fault=fault: here.hub.panel.now()["faults"][name] == fault)


def test_the_robot_s_own_game_pad_drives_the_simulator(station: Make, visit: Visit) -> None:
    here, page = watched(station, visit, panel=True)
    open_tab(page, "sim")
    page.locator("#sim input[name=overridden]").check()
    page.get_by_label("RT forward").fill("50")
    until(lambda: here.sim.state.wheel_linear_m_s > 0.3)
    page.get_by_role("button", name="Release the pad").click()
    until(lambda: not here.sim.state.overridden)
    until(lambda: abs(here.sim.state.wheel_linear_m_s) < 0.05)


# ---- the view from above ----


def trail(page: Page) -> int:
    return int(page.locator("#map").get_attribute("data-trail") or 0)


def test_a_trail_survives_a_reload_and_stays_cleared(station: Make, visit: Visit) -> None:
    here = station()
    page, other = visit(here.url), visit(here.url)
    ready(page)
    ready(other)
    here.sim.set("pad_a", True)
    here.sim.set("pad_rt", 0.0)
    until(lambda: here.sim.state.true_x_m > 1.0)
    here.sim.set("pad_a", False)
    until(lambda: here.sim.state.wheel_linear_m_s == 0)
    page.reload()
    ready(page)
    until(lambda: trail(page) > 20)
    until(lambda: trail(other) > 1)  # a page on a loaded machine draws few frames
    page.locator("#map-clear").click()
    until(lambda: trail(page) <= 1)
    until(lambda: trail(other) <= 1)
    page.reload()
    ready(page)
    page.wait_for_timeout(500)
    assert trail(page) <= 1


def view(page: Page) -> list[float]:
    return [float(part) for part in (page.locator("#map").get_attribute("data-view") or "").split()]


@pytest.mark.both
def test_the_wheel_zooms_to_the_cursor(station: Make, visit: Visit) -> None:
    _, page = watched(station, visit)
    page.locator("#map-follow").click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    right_px, down_px = 150, -90
    page.mouse.move(box["x"] + box["width"] / 2 + right_px, box["y"] + box["height"] / 2 + down_px)

    def pointed_at() -> tuple[float, float]:
        x_m, y_m, scale = view(page)
        return x_m - down_px / scale, y_m - right_px / scale

    before = pointed_at()
    scale = view(page)[2]
    page.mouse.wheel(0, -400)
    until(lambda: view(page)[2] > 1.5 * scale)
    assert pointed_at() == pytest.approx(before, abs=0.02)


@pytest.mark.both
def test_map_stick_and_stop_fit_on_one_screen_of_a_phone(station: Make, visit: Visit) -> None:
    here = station(panel=True)
    page = visit(here.url, has_touch=True)
    ready(page)
    for width, height in ((390, 844), (844, 390), (360, 640)):
        page.set_viewport_size({"width": width, "height": height})
        for name in ("#map", "#stick", "#stop", "#take", "#banner"):
            expect(page.locator(name)).to_be_in_viewport(ratio=1)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate("document.getElementById('map').clientHeight") > 0.2 * height


@pytest.mark.parametrize("turned", [False, True])
def test_telemeter_cones_are_drawn_where_they_are_mounted(
    turned: bool, station: Make, visit: Visit
) -> None:
    _, page = watched(station, visit, start_theta_rad=math.pi / 2 if turned else 0.0)

    def painted(right_px: int, down_px: int) -> bool:
        """Whether a pixel is painted; the robot is in the middle, and grid lines are left out."""
        alpha = page.evaluate(
            """([x, y]) => {
                const { width, height } = document.getElementById("map");
                const pen = document.getElementById("map").getContext("2d");
                return pen.getImageData(width / 2 + x, height / 2 + y, 1, 1).data[3];
            }""",
            [right_px, down_px],
        )
        return bool(alpha)

    ahead, left = (4, -80), (-80, 4)
    until(lambda: painted(*(left if turned else ahead)))
    assert not painted(*(ahead if turned else left))
