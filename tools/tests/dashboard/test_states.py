# SPDX-License-Identifier: MIT
"""The states that the page shows: their order, and that they say the truth about motion."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from state_table import CALM, MOVES, STATES, Frame, conflict, merged
from station import Station

Ask = Callable[..., list[Any]]


@pytest.fixture
def states_of(watched: Callable[..., tuple[Station, Page]]) -> Ask:
    """Ask the page for the states of frames: level, title and text, most urgent first."""
    _, page = watched(enable_drive=False)

    def ask(*frames: Frame) -> list[Any]:
        found: list[Any] = page.evaluate(
            """async (frames) => {
                const { statesOf } = await import("/static/states.js");
                return frames.map(statesOf);
            }""",
            frames,
        )
        return found

    return ask


def test_states_have_a_decided_order_and_alarms_a_remedy(states_of: Ask) -> None:
    alone = [merged(CALM, frame) for _, frame in STATES]
    for (title, _), found in zip(STATES, states_of(*alone), strict=True):
        level, shown, _, remedy = found[0]
        assert shown == title
        assert level not in ("bad", "weak") or remedy.startswith("Try: "), title
    pairs = [
        pair for pair in itertools.combinations(STATES, 2) if not conflict(*dict(pair).values())
    ]
    assert len(pairs) > 80
    both = [merged(merged(CALM, other[1]), one[1]) for one, other in pairs]
    for (one, other), found in zip(pairs, states_of(*both), strict=True):
        titles = [title for _, title, *_ in found]
        assert one[0] in titles, f"{one[0]} is hidden by {titles}"
        if one[0] == "ROBOT LOST":
            assert titles == ["ROBOT LOST"], "nothing else is known of a robot that is silent"
        else:
            assert titles.index(one[0]) < titles.index(other[0]), titles


def test_no_state_says_the_opposite_of_the_measured_speed(states_of: Ask) -> None:
    still = {"speeds": [0.0, 0.0, 0.0, 0.0], "facts": {"at_rest": True}}
    unknown = {"facts": {"at_rest": None}}
    claims = ("The robot stands", "1.28\u202fm/s", "not known whether the robot moves")
    for frame, claim in ((still, claims[0]), (MOVES, claims[1]), (unknown, claims[2])):
        frames = [merged(merged(CALM, state), frame) for _, state in STATES]
        texts = [text for found in states_of(*frames) for _, _, text, _ in found]
        assert any(claim in text for text in texts)
        for wrong in set(claims) - {claim}:
            assert not any(wrong in text for text in texts), (wrong, claim)


def test_a_stop_is_unconfirmed_unless_the_robot_is_known_to_stand(states_of: Ask) -> None:
    frame = merged(CALM, {"facts": {"stop_unconfirmed": True}})
    frames = [merged(frame, {"facts": {"at_rest": rest}}) for rest in (True, False, None)]
    lost = merged(frames[2], {"state": "lost"})
    titles = [found[0][1] for found in states_of(*frames, lost)]
    assert titles == ["DISARMED", *3 * ["STOP NOT CONFIRMED"]]


def test_the_banner_says_who_drives_why_and_where(states_of: Ask) -> None:
    armed = merged(CALM, {"facts": {"armed": True}})
    driving = merged(armed, {"facts": {"driving": True}})
    other = {"mine": False, "driver_name": "phone"}
    pose = {"x_m": 0.0, "y_m": 0.0, "theta_rad": 0.0}
    goes = {"going": [3.0, 4.0], "going_m_s": 0.5, "pose": pose}
    past = {"why": "the robot was lost"}
    late = {"why": "inputs came late", "must_let_go": True}
    brakes = merged(CALM, MOVES)
    by_itself = "By itself: 5.0\u202fm, 10\u202fs or more at 0.50\u202fm/s."
    moves = "The robot moves: 1.28\u202fm/s, 0.00\u202frad/s."
    for frame, title, text in (
        (driving, "DRIVING", "Letting go stops the robot. The robot stands."),
        (merged(driving, MOVES), "DRIVING", "Letting go stops the robot."),
        (driving | goes, "DRIVING", by_itself),
        (armed | other, "ARMED", "The robot accepts speeds from “phone”."),
        (armed | past, "ARMED", "The robot was lost."),
        (merged(armed, MOVES) | late, "LET GO", f"Inputs came late. {moves}"),
        (
            brakes,
            "MOVING",
            f"Its target is zero: it brakes, or something pushes it. {moves}",
        ),
        (
            brakes | {"speeds": [1.28, 1.28, 0, 0]},
            "MOVING",
            f"Nothing is commanded from here. {moves}",
        ),
        (CALM | past, "DISARMED", "The robot was lost."),
        (merged(CALM, past | {"facts": {"blocked": "release [A]"}}), "DISARMED", "Release [A]."),
        (CALM | {"recorded": True}, "DISARMED", "A recording is replayed: nothing can be driven."),
    ):
        assert states_of(frame)[0][0][1:3] == [title, text]


def test_the_most_urgent_state_has_the_banner_and_is_spoken_once(
    watched: Callable[..., tuple[Station, Page]],
) -> None:
    here, page = watched(battery_percent=60.0)
    title, others = page.locator("#banner-title"), page.locator("#banner-more")
    expect(title).to_have_text("DISARMED")
    for name, value, first, also in (
        ("battery_percent", 3.0, "BATTERY CRITICAL", ""),
        ("pad_a", True, "OVERRIDE", "BATTERY CRITICAL"),
        ("rear_bumper", True, "REAR BUMPER", "OVERRIDEBATTERY CRITICAL"),
        ("power", False, "ROBOT LOST", ""),
    ):
        here.sim.set(name, value)
        expect(title).to_have_text(first)
        expect(others).to_have_text(also)
        expect(page.locator("#banner")).to_have_attribute("data-level", "bad")
    expect(page.locator("#spoken")).to_contain_text("ROBOT LOST")
    page.evaluate(
        """window.spoken = 0;
        new MutationObserver(() => { spoken += 1; }).observe(document.getElementById("spoken"),
            { childList: true, characterData: true, subtree: true })"""
    )
    expect(page.locator("#quality-say")).to_have_text("Lost 3\u202fs")
    assert page.evaluate("spoken") == 0, "a count of seconds is spoken"
    expect(page.locator("#link-try")).to_contain_text("cable")
    expect(page.locator("#link-figures")).to_contain_text("loss \u2013")
    here.sim.set("power", True)
    expect(page.locator("#quality-say")).to_have_text("Link good")
    expect(page.locator("#events")).to_contain_text("fell silent")


def test_alarms_sound_once_for_whoever_wants_them(
    watched: Callable[..., tuple[Station, Page]],
) -> None:
    here, page = watched(page={"forgive": "Blocked call to navigator.vibrate"})
    shake = "window.shakes = 0; navigator.vibrate = () => { shakes += 1; return true; }; 0"
    page.evaluate(shake)

    def alarm() -> int:
        here.sim.set("front_bumper", True)
        expect(page.locator("#banner-title")).to_have_text("FRONT BUMPER")
        page.wait_for_timeout(200)
        here.sim.set("front_bumper", False)
        expect(page.locator("#banner-title")).to_have_text("DISARMED")
        return int(page.evaluate("shakes"))

    assert alarm() == 0
    page.locator("#tab-link").click()
    page.get_by_role("button", name="alarm sound").click()
    assert page.evaluate("shakes") == 1
    assert alarm() == 2
    page.reload()
    # Browsers suspend a sound that begins before the page is touched.
    expect(page.locator("#sound")).to_have_text("alarm sound: press any key first")
    page.evaluate(shake)
    assert alarm() == 1
    page.keyboard.press("x")
    expect(page.locator("#sound")).to_have_text("alarm sound")
