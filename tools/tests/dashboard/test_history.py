# SPDX-License-Identifier: MIT
"""What is kept for pages that open later: of fixed size, and in order."""

import math
from dataclasses import dataclass

import pytest

from roburoc4.constants import Event
from roburoc4.notices import texts_of
from roburoc4_tools.dashboard.history import (
    BATTERY_EVERY_S,
    EVENT_ROWS,
    SPEED_EVERY_S,
    SPEED_ROWS,
    History,
    Ring,
)


def discharged(percent_h: float, rows: int) -> History:
    history = History()
    for row in range(rows):
        time_s = 1e9 + row * BATTERY_EVERY_S
        history.add_battery(time_s, 80.0 + percent_h * (time_s - 1e9) / 3600.0, 24.0)
    return history


def test_where_no_battery_was_received_is_a_gap_and_no_trend() -> None:
    assert discharged(-12.0, 5).trend_percent_h() is None
    history = discharged(-12.0, 100)
    lost_s = 1e9 + 99 * BATTERY_EVERY_S + 1.0
    for after in range(3600):
        history.add_battery(lost_s + after, math.nan, math.nan)
    assert [column[-1] for column in history.battery.columns()] == [lost_s, None, None]
    assert len(history.battery) == 101
    assert history.trend_percent_h() == pytest.approx(-12.0, abs=0.1)


def test_another_battery_after_a_gap_has_a_trend_of_its_own() -> None:
    history = discharged(-12.0, 100)
    begin_s = 1e9 + 100 * BATTERY_EVERY_S
    history.add_battery(begin_s, math.nan, math.nan)
    for row in range(1, 20):
        assert (history.trend_percent_h() is None) == (1 < row <= 6), row
        history.add_battery(begin_s + row * BATTERY_EVERY_S, 30.0, 23.0)
    assert history.trend_percent_h() == pytest.approx(0.0, abs=0.1)


def test_ten_minutes_of_driving_fit_into_the_trail() -> None:
    history = History()
    for frame in range(700 * 30):
        history.add_place(1e9 + frame / 30, 2.6 * frame / 30, 0.0, 0.0)
    times = history.path.columns()[2]
    assert times[-1] - times[0] > 595.0  # type: ignore[operator]


def test_a_ring_keeps_the_latest_rows_oldest_first() -> None:
    ring = Ring(2, 3)
    assert ring.columns() == [[], []]
    for value in range(5):
        ring.append((value, math.nan if value == 3 else -value))
    assert ring.columns() == [[2.0, 3.0, 4.0], [-2.0, None, -4.0]]


def test_history_has_a_fixed_size() -> None:
    history = History()
    for row in range(2 * SPEED_ROWS):
        history.add_speeds(row * SPEED_EVERY_S, (0.0, 0.0, 0.0, 0.0))
        history.add_speeds((row + 0.5) * SPEED_EVERY_S, (0.0, 0.0, 0.0, 0.0))
        history.note(row, "plain", "something")
    assert len(history.speeds) == SPEED_ROWS
    times = history.speeds.columns()[0]
    assert times[-1] - times[0] > 590.0  # type: ignore[operator]
    assert len(history.events) == EVENT_ROWS
    assert history.events[-1].number == 2 * SPEED_ROWS


def test_a_clock_that_is_set_back_begins_anew() -> None:
    history = discharged(-12.0, 200)
    history.add_speeds(2e9, (0.0, 0.0, 0.0, 0.0))
    history.add_speeds(1e9, (0.0, 0.0, 0.0, 0.0))
    history.add_speeds(1e9 + 1.0, (0.0, 0.0, 0.0, 0.0))
    assert history.speeds.columns()[0] == [1e9, 1e9 + 1.0]
    assert len(history.battery) == 0


@dataclass
class Facts:
    overridden: bool = False
    other_commander: bool = False
    inhibited: bool = False


@pytest.mark.parametrize(
    ("event", "fact"),
    [
        (Event.OVERRIDE, "overridden"),
        (Event.OTHER_COMMANDER, "other_commander"),
        (Event.INHIBITED, "inhibited"),
    ],
)
def test_the_end_of_a_danger_is_not_reported_as_the_danger(event: Event, fact: str) -> None:
    quiet, danger = Facts(), Facts(**{fact: True})
    begun = texts_of(event, quiet, danger)
    ended = texts_of(event, danger, quiet)
    assert [level for level, _ in (*begun, *ended)] == ["bad", "plain"]
    assert texts_of(event, quiet, quiet) == begun + ended, "one that came and went is lost"
    assert texts_of(event, danger, danger) == begun, "one that went and came is lost"
