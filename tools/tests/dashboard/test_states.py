# SPDX-License-Identifier: MIT
"""The states that the page shows: their order, and that they say the truth about motion."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from state_table import CALM, MOVES, STATES, Frame, conflict, merged
from station import Station, arm, hold_pad, press_arm, ready, until

import roburoc4

Visit = Callable[..., Page]
Make = Callable[..., Station]


@pytest.fixture
def states_of(station: Make, visit: Visit) -> Callable[[list[Frame]], list[Any]]:
    """Ask the page for the states of frames: level, title and text, most urgent first."""
    page = visit(station(enable_drive=False).url)

    def ask(frames: list[Frame]) -> list[Any]:
        found: list[Any] = page.evaluate(
            """async (frames) => {
                const { statesOf } = await import("/static/states.js");
                return frames.map(statesOf);
            }""",
            frames,
        )
        return found

    return ask


def test_every_pair_of_states_has_a_decided_order(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    pairs = [
        (one, other)
        for one, other in itertools.combinations(STATES, 2)
        if not conflict(one[1], other[1])
    ]
    assert len(pairs) > 80
    both = [merged(merged(CALM, other[1]), one[1]) for one, other in pairs]
    for (one, other), found in zip(pairs, states_of(both), strict=True):
        titles = [title for _, title, *_ in found]
        assert one[0] in titles, f"{one[0]} is hidden by {titles}"
        if one[0] == "ROBOT LOST":
            assert titles == ["ROBOT LOST"], "nothing else is known of a robot that is silent"
        else:
            assert titles.index(one[0]) < titles.index(other[0]), titles


def test_each_state_alone_has_the_banner_and_each_alarm_a_remedy(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    alone = [merged(CALM, frame) for _, frame in STATES]
    for (title, _), found in zip(STATES, states_of(alone), strict=True):
        level, shown, _, remedy = found[0]
        assert shown == title
        assert level not in ("bad", "weak") or remedy.startswith("Try: "), title


def test_driving_alone_is_no_alarm(states_of: Callable[[list[Frame]], list[Any]]) -> None:
    driving = merged(merged(CALM, MOVES), {"facts": {"armed": True, "driving": True}})
    (found,) = states_of([driving])
    assert [title for level, title, *_ in found if level in ("bad", "weak")] == []


def test_a_driven_robot_that_stands_is_not_said_to_move(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    driving = merged(CALM, {"facts": {"armed": True, "driving": True}})
    stands, moves = states_of([driving, merged(driving, MOVES)])
    assert stands[0][1:3] == ["DRIVING", "Letting go stops the robot. The robot stands."]
    assert moves[0][1:3] == ["DRIVING", "Letting go stops the robot."]


def test_who_drives_is_in_the_banner_by_name(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    other = merged(CALM, {"mine": False, "driver_name": "phone", "facts": {"armed": True}})
    armed, driving = states_of([other, merged(merged(other, MOVES), {"facts": {"driving": True}})])
    assert armed[0][2] == "The robot accepts speeds from “phone”."
    assert driving[0][2] == "By “phone”."


def test_a_robot_that_brakes_is_not_moved_by_somebody(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    disarmed = merged(merged(CALM, MOVES), {"facts": {"armed": False}})
    brakes, driven = states_of([disarmed, disarmed | {"speeds": [1.28, 1.28, 0.0, 0.0]}])
    assert brakes[0][1:] == [
        "MOVING",
        "Its target is zero: it brakes, or something pushes it. "
        "The robot moves: 1.28\u202fm/s, 0.00\u202frad/s.",
        "Try: wait until it stands.",
    ]
    assert driven[0][2].startswith("Nothing is commanded from here.")
    assert driven[0][3].startswith("Try: look who moves it")


def test_what_was_stopped_may_still_move_and_what_is_over_is_no_alarm(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    armed = merged(merged(CALM, MOVES), {"facts": {"armed": True}})
    why = {"why": "it did not arrive: something is too near"}
    late, over = states_of([armed | why | {"must_let_go": True}, armed | why])
    assert late[0][1] == "LET GO"
    assert "The robot moves: 1.28\u202fm/s" in late[0][2]
    assert over[0][1:3] == ["ARMED", "It did not arrive: something is too near."]


def test_what_prevents_arming_now_comes_before_what_is_past(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    past = merged(CALM, {"why": "the robot was lost", "facts": {"blocked": "release [A]"}})
    now, after = states_of([past, merged(past, {"facts": {"blocked": ""}})])
    assert (now[0][2], after[0][2]) == ("Release [A].", "The robot was lost.")


def test_the_way_of_a_robot_that_goes_by_itself_is_in_the_banner(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    pose = {"x_m": 0.0, "y_m": 0.0, "theta_rad": 0.0}
    goes = {"going": [3.0, 4.0], "going_m_s": 0.5, "pose": pose}
    (found,) = states_of([merged(CALM, goes | {"facts": {"armed": True, "driving": True}})])
    assert found[0][2] == "By itself: 5.0\u202fm, 10\u202fs or more at 0.50\u202fm/s."


def test_no_state_says_the_opposite_of_the_measured_speed(
    states_of: Callable[[list[Frame]], list[Any]],
) -> None:
    still = {"speeds": [0.0, 0.0, 0.0, 0.0], "facts": {"at_rest": True}}
    unknown = {"speeds": None, "facts": {"at_rest": None}}
    claims = ("The robot stands", "1.28\u202fm/s", "not known whether the robot moves")
    for frame, claim in ((still, claims[0]), (MOVES, claims[1]), (unknown, claims[2])):
        frames = [merged(merged(CALM, state), frame) for _, state in STATES]
        texts = [text for found in states_of(frames) for _, _, text, _ in found]
        assert any(claim in text for text in texts)
        for wrong in set(claims) - {claim}:
            assert not any(wrong in text for text in texts), (wrong, claim)
        assert not any("does not move" in text for text in texts)


def test_what_is_past_is_not_a_state(station: Make, visit: Visit) -> None:
    here = station(lease_s=1.0)
    here.sim.set("estop_remote", True)
    page = visit(here.url)
    arm(page)
    here.wait_until_inhibited(page)
    page.evaluate("hold(0, 0)")
    expect(page.locator("#banner-text")).to_contain_text("The robot did not follow its commands")
    until(lambda: here.robot.facts.stop_outcome is roburoc4.StopOutcome.CONFIRMED)
    here.sim.set("estop_remote", False)
    here.sim.set("motor_button", True)
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    here.sim.set("pad_a", True)
    until(lambda: here.robot.facts.overridden)  # else its target may pass for an old one
    here.sim.set("pad_lj_x", -1.0)
    until(lambda: here.sim.state.wheel_angular_rad_s > 2.0)
    expect(page.locator("#banner-title")).to_have_text("OVERRIDE")
    expect(page.locator("#banner-text")).to_contain_text("The robot moves: ")
    here.sim.set("battery_percent", 3.0)
    expect(page.locator("#banner-more")).to_have_text("BATTERY CRITICAL")
    here.sim.set("power", False)
    expect(page.locator("#banner-title")).to_have_text("ROBOT LOST")
    here.sim.set("power", True)
    here.sim.set("pad_a", False)
    expect(page.locator("#banner-title")).to_have_text("BATTERY CRITICAL")
    expect(page.locator("#banner")).not_to_contain_text("INHIBITED")


def test_an_unconfirmed_stop_ends_when_the_robot_stands(station: Make, visit: Visit) -> None:
    here = station()
    page = visit(here.url)
    ready(page)
    here.sim.set("pad_a", True)
    until(lambda: here.robot.facts.overridden)  # else its target is another commander's
    here.sim.set("pad_rt", 0.0)
    until(lambda: here.sim.state.wheel_linear_m_s > 0.5)
    page.locator("#stop").click()  # which the robot ignores now
    here.wait_for_stop_pressed()
    here.sim.set("pad_a", False)
    here.sim.set("pad_rt", 1.0)
    until(lambda: here.sim.state.wheel_linear_m_s == 0.0)
    expect(page.locator("#banner-title")).to_have_text("DISARMED")
    here.sim.set("pad_a", True)
    until(lambda: here.robot.facts.overridden)
    here.sim.set("pad_rt", 0.0)
    until(lambda: here.sim.state.wheel_linear_m_s > 0.5)
    expect(page.locator("#banner-title")).to_have_text("OVERRIDE")
    expect(page.locator("#banner-more")).not_to_contain_text("STOP NOT CONFIRMED")


def test_the_next_alarm_can_be_read_on_a_small_phone(station: Make, visit: Visit) -> None:
    here = station(enable_drive=False, battery_percent=3.0)
    page = visit(here.url, viewport={"width": 320, "height": 568})
    ready(page)
    here.sim.set("localization_flags", 82)
    here.sim.set("pad_a", True)
    here.sim.set("front_bumper", True)
    names = page.locator("#banner-more li")
    expect(names).to_have_text(["OVERRIDE", "BATTERY CRITICAL", "POSE WRONG"])
    first, _, last = names.all()
    assert first.evaluate("(node) => node.scrollWidth - node.clientWidth") <= 0
    expect(last).to_be_in_viewport(ratio=1)


def test_the_strip_shows_who_drives_what_whatever_is_wrong(station: Make, visit: Visit) -> None:
    here = station(robots=("RED", "BLUE"), panel=True)
    page = visit(here.url, viewport={"width": 320, "height": 568})
    ready(page)
    page.locator("#take").click()
    expect(page.get_by_role("button", name="Arm RED")).to_be_visible()
    press_arm(page)
    mode = page.locator("#mode")
    expect(mode).to_have_text("ARMED")
    calm = mode.evaluate("(node) => getComputedStyle(node).backgroundColor")
    here.sim.set("battery_percent", 3.0)
    here.sim.set("front_bumper", True)
    expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
    for name, text in (
        ("name", "RED"),
        ("kind", "simulator"),
        ("mode", "ARMED"),
        ("control", "Control: this page"),
    ):
        expect(page.locator(f"#{name}")).to_be_in_viewport(ratio=1)
        expect(page.locator(f"#{name}")).to_have_text(text)
    here.sim.set("front_bumper", False)
    here.wait_until_driven(
        page, lambda: hold_pad(page, rt=1.0), lambda: page.evaluate("hold(0, 0)")
    )
    expect(mode).to_have_text("DRIVING")
    assert mode.evaluate("(node) => getComputedStyle(node).backgroundColor") != calm
