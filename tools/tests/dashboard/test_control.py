# SPDX-License-Identifier: MIT
"""The control alone, in virtual time: whatever pages send and whenever, the lease holds."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from station import until

import roburoc4
from roburoc4_tools.dashboard.control import (
    FORGOTTEN_S,
    IDLE_S,
    Control,
    ControlError,
    Input,
    Limits,
    Viewer,
    limits_of,
)
from roburoc4_tools.dashboard.going import Goal
from roburoc4_tools.dashboard.ticks import Ticks

LEASE_S = 0.25
CYCLE_S = 0.011
"""Until the simulator's state shows what arrived."""


class Scene:
    """A robot in virtual time, a control, and two pages."""

    def __init__(self, sim: roburoc4.Simulator) -> None:
        self.sim = sim
        self.robot = self.sim.connect()
        self.ticks = Ticks()
        self.control = Control(self.robot, self.ticks, LEASE_S, offered=True)
        self.control.limits = limits_of(self.robot, 1.0, 1.0)
        self.pages = [Viewer(1), Viewer(2)]
        self.issued_s: dict[int, float] = {}

    def show(self) -> int:
        """Send both pages a frame."""
        now_s = self.robot.now_s
        tick = self.ticks.issue(now_s)
        self.issued_s[tick] = now_s
        for page in self.pages:
            page.sent_tick = tick
            page.heard_s = now_s
        return tick

    def drive(self, page: int, tick: int, forward: float) -> None:
        self.control.drive(self.pages[page], Input(tick, forward, 0.0, 1.0), self.robot.now_s)

    def arm(self) -> None:
        self.control.take(self.pages[0])
        self.robot.arm()
        self.control.arm(self.pages[0], self.show(), self.robot.now_s)
        self.drive(0, self.show(), 0.0)

    @property
    def driven(self) -> bool:
        return self.sim.state.last_linear_m_s != 0.0


@pytest.fixture
def scene() -> Iterator[Scene]:
    one = Scene(roburoc4.Simulator())
    with one.sim, one.robot:
        yield one


def test_an_input_holds_until_one_lease_after_its_tick(scene: Scene) -> None:
    scene.arm()
    tick = scene.show()
    scene.sim.step(0.1)
    scene.drive(0, tick, 0.5)
    scene.sim.step(0.1)
    assert scene.driven
    scene.sim.step(0.05 + CYCLE_S)
    assert not scene.driven


def test_full_deflection_is_the_lower_of_limit_and_ceiling_on_each_side() -> None:
    scene = Scene(roburoc4.Simulator(max_linear_m_s=0.5, min_linear_m_s=-2.0))
    with scene.sim, scene.robot:
        assert scene.control.limits == ((1.0, 0.5), (1.0, 1.0))
        scene.arm()
        for forward, linear_m_s in ((1.0, 0.5), (0.0, 0.0), (-1.0, -1.0)):
            for _ in range(6):  # until the stop before is confirmed
                scene.drive(0, scene.show(), forward)
                scene.sim.step(0.1)
            assert scene.sim.state.last_linear_m_s == pytest.approx(linear_m_s, abs=1e-4)


def test_letting_go_pauses_and_stop_disarms(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.drive(0, scene.show(), 0.0)
    assert not scene.robot.facts.driving
    scene.sim.step(5.0)
    assert scene.robot.facts.armed
    scene.control.stop(scene.pages[1])
    assert scene.robot.facts.disarm_cause is roburoc4.Result.STOP_CALLED
    scene.control.watch(scene.robot.now_s)
    assert scene.control.why == "STOP was pressed on page 2"
    scene.sim.step(5.0)
    before = scene.sim.state.speed_commands
    scene.control.stop(scene.pages[0])
    scene.sim.step(0.1)
    assert scene.sim.state.speed_commands > before, "STOP sends zeros to a disarmed robot, too"
    assert scene.control.why == "STOP was pressed here"


def test_the_end_of_the_dashboard_disarms_and_takes_no_more_control(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.control.close()
    assert scene.robot.facts.disarm_cause is roburoc4.Result.STOP_CALLED
    with pytest.raises(ControlError, match="only watches"):
        scene.control.take(scene.pages[1])


def test_whoever_asked_gets_control_disarmed_when_the_driver_is_gone(scene: Scene) -> None:
    scene.arm()
    driver, other = scene.pages
    scene.control.ask(other)
    assert scene.control.driver is driver
    with pytest.raises(ControlError, match="already asked"):
        scene.control.ask(Viewer(3))
    assert scene.control.keep(driver) is other
    scene.control.ask(other)
    scene.control.leave(driver)
    assert scene.control.driver is other
    assert not scene.robot.facts.armed


def test_a_frame_that_another_page_got_is_answered_by_that_one_only(scene: Scene) -> None:
    scene.arm()
    seen = scene.pages[0].sent_tick
    tick = scene.show()
    scene.pages[0].sent_tick = seen
    scene.drive(0, tick, 0.5)
    assert scene.control.dropped == 1


def test_inputs_that_end_disarm_a_second_after_the_lease(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(LEASE_S + 1.0 + CYCLE_S)
    assert scene.robot.facts.disarm_cause is roburoc4.Result.LAPSED
    scene.control.watch(scene.robot.now_s)
    assert "too late" in scene.control.why
    assert "arm()" not in scene.control.why


def test_a_page_that_leaves_unarmed_takes_the_robot_from_nobody(scene: Scene) -> None:
    scene.control.take(scene.pages[0])
    scene.control.leave(scene.pages[0])
    scene.sim.step(1.0)
    assert scene.sim.state.speed_commands == 0


def test_letting_go_of_a_disarmed_robot_commands_nothing(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.sim.set("estop_remote", True)
    for _ in range(40):
        scene.sim.step(0.05)
        if scene.robot.facts.armed:
            scene.drive(0, scene.show(), 0.5)
    assert scene.robot.facts.disarm_cause is roburoc4.Result.INHIBITED
    scene.sim.set("estop_remote", False)
    scene.sim.set("motor_button", True)
    scene.sim.step(2.0)
    sent = scene.sim.state.speed_commands
    scene.drive(0, scene.show(), 0.0)
    scene.sim.step(1.0)
    assert scene.sim.state.speed_commands == sent


def test_an_idle_driver_is_relieved_only_while_the_robot_stands(scene: Scene) -> None:
    scene.arm()
    driver, other = scene.pages
    for wait_s, at_rest in ((0.0, True), (IDLE_S / 2, True), (IDLE_S / 2, False)):
        scene.sim.step(wait_s)
        with pytest.raises(ControlError, match="page 1 drives: ask for control"):
            scene.control.relieve(other, scene.robot.now_s, at_rest=at_rest)
    scene.drive(0, scene.show(), 0.0)
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(2 * LEASE_S)
    with pytest.raises(ControlError):
        scene.control.relieve(other, scene.robot.now_s, at_rest=True)
    scene.sim.step(IDLE_S)
    scene.control.relieve(other, scene.robot.now_s, at_rest=True)
    assert scene.control.driver is other
    assert driver is not other
    assert not scene.robot.facts.armed


class Walker:
    """A robot that goes until it is told that nobody wants that any more."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.facts = SimpleNamespace(armed=True, driving=False, lapsed=False)
        self.under_way: list[tuple[float, float]] = []
        self.driven = False

    def goto(self, x_m: float, _y_m: float, *, speed: float, on_progress: Any, **_: Any) -> None:
        if self.under_way:
            raise roburoc4.RobotError("a move is under way", roburoc4.Result.STATE)
        self.under_way.append((x_m, speed))
        try:
            while True:
                time.sleep(0.05)
                on_progress(None)
        finally:
            self.under_way.clear()

    def drive(self, *_: float, **_rest: float) -> None:
        self.driven = True

    def stop(self) -> None:
        self.facts.armed = False


class Walk:
    """Its control, and a page that drives it."""

    def __init__(self) -> None:
        self.robot = Walker()
        self.ticks = Ticks()
        self.control = Control(cast(roburoc4.Robot, self.robot), self.ticks, LEASE_S, offered=True)
        self.control.limits = Limits((0.8, 0.8), (1.0, 1.0))
        self.page = Viewer(1)
        self.control.take(self.page)
        self.show()  # releases all inputs

    def go(self, x_m: float) -> None:
        self.control.go(self.page, self.tick(), Goal(x_m, 0.0, 0.5), self.robot.now_s)

    def tick(self) -> int:
        self.page.sent_tick = self.ticks.issue(self.robot.now_s)
        return self.page.sent_tick

    def show(self, forward: float = 0.0, *, going: bool = True) -> None:
        inputs = Input(self.tick(), forward, 0.0, 1.0, going)
        self.control.drive(self.page, inputs, self.robot.now_s)


@pytest.fixture
def walk() -> Iterator[Walk]:
    one = Walk()
    yield one
    one.control.leave(one.page)


def test_another_place_waits_until_the_first_move_has_ended(walk: Walk) -> None:
    walk.go(1.0)
    first = walk.control.going
    until(lambda: walk.robot.under_way == [(1.0, 0.4)])  # half of full speed
    walk.go(2.0)
    until(lambda: walk.robot.under_way == [(2.0, 0.4)])
    assert first is not None
    assert first.why == "the move was ended"


def test_a_move_ends_one_lease_after_its_page_last_showed_it(walk: Walk) -> None:
    walk.go(1.0)
    move = walk.control.going
    assert move is not None
    walk.robot.now_s += 0.1
    walk.show()
    walk.robot.now_s += LEASE_S - 0.1
    time.sleep(0.2)
    assert move.on
    walk.robot.now_s += 0.1
    until(lambda: not move.on)
    assert move.why == "the driver's page was late"


@pytest.mark.parametrize(("forward", "going"), [(0.5, True), (0.0, False)])
def test_an_input_ends_a_move_and_must_be_released_before_it_drives(
    forward: float, going: bool, walk: Walk
) -> None:
    walk.go(1.0)
    move = walk.control.going
    walk.show(forward, going=going)
    assert move is not None
    until(lambda: not move.on)
    assert move.why == "the move was ended"
    walk.show(0.5)
    assert not walk.robot.driven
    walk.show(0.0)
    walk.show(0.5)
    assert walk.robot.driven


def test_a_disarmed_robot_or_a_late_page_goes_nowhere(walk: Walk) -> None:
    late = walk.tick()
    walk.robot.now_s += LEASE_S
    with pytest.raises(ControlError, match="late"):
        walk.control.go(walk.page, late, Goal(1.0, 0.0, 0.5), walk.robot.now_s)
    walk.robot.facts.armed = False
    with pytest.raises(ControlError, match="disarmed"):
        walk.go(1.0)
    assert not walk.robot.under_way


def test_a_delay_while_commanding_makes_no_lease_longer(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene.arm()
    give = scene.robot.drive

    def slowly(linear_m_s: float, angular_rad_s: float, *, lease_s: float) -> None:
        scene.sim.step(held_s.pop() if held_s else 0.0)
        give(linear_m_s, angular_rad_s, lease_s=lease_s)

    monkeypatch.setattr(scene.robot, "drive", slowly)
    held_s = [0.15]
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(0.05)
    assert scene.driven
    scene.sim.step(0.05 + CYCLE_S)
    assert not scene.driven
    scene.drive(0, scene.show(), 0.0)
    held_s = [0.24]
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(CYCLE_S)
    assert not scene.driven
    assert scene.control.must_let_go


def test_arming_again_while_driving_stops(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(0.05)
    assert scene.driven
    scene.control.arm(scene.pages[0], scene.show(), scene.robot.now_s)
    scene.sim.step(2 * CYCLE_S)
    assert not scene.driven


def test_inputs_from_before_arming_are_ignored(scene: Scene) -> None:
    scene.arm()
    old = scene.show()
    scene.control.arm(scene.pages[0], old, scene.robot.now_s)
    scene.drive(0, old, 0.0)
    scene.drive(0, old, 0.5)
    scene.sim.step(0.05)
    assert not scene.driven


def test_arming_needs_a_fresh_tick(scene: Scene) -> None:
    scene.control.take(scene.pages[0])
    tick = scene.show()
    scene.sim.step(LEASE_S)
    with pytest.raises(ControlError, match="late"):
        scene.control.arm(scene.pages[0], tick, scene.robot.now_s)
    assert not scene.robot.facts.armed


def test_a_driver_that_shows_nothing_for_long_loses_control(scene: Scene) -> None:
    scene.arm()
    scene.sim.step(FORGOTTEN_S - 1.0)
    scene.control.watch(scene.robot.now_s)
    assert scene.control.driver is scene.pages[0]
    scene.sim.step(2.0)
    scene.control.watch(scene.robot.now_s)
    assert scene.control.driver is None
    assert not scene.robot.facts.armed


def test_after_a_lease_that_ran_out_inputs_must_be_released_once(scene: Scene) -> None:
    scene.arm()
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(2 * LEASE_S)
    scene.drive(0, scene.show(), 0.5)
    scene.sim.step(0.05)
    assert not scene.driven
    assert "let go" in scene.control.why
    scene.drive(0, scene.show(), 0.0)
    assert scene.control.why == ""
    for _ in range(6):  # until the stop before is confirmed
        scene.drive(0, scene.show(), 0.5)
        scene.sim.step(0.1)
    assert scene.driven


@pytest.mark.parametrize("high", [math.inf, -0.5, None])
def test_invalid_limits_allow_nothing(high: float | None) -> None:
    found = None
    if high is not None:
        found = SimpleNamespace(
            min_linear_m_s=-1.0,
            max_linear_m_s=high,
            min_angular_rad_s=-1.0,
            max_angular_rad_s=high,
        )
    robot = SimpleNamespace(properties=SimpleNamespace(differential=found))
    assert limits_of(cast(roburoc4.Robot, robot), 1.0, 1.0) == ((0.0, 0.0), (0.0, 0.0))


_STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("wait"), st.sampled_from((0.01, 0.03, 0.1, 0.2, 0.3))),
        st.tuples(st.just("show"), st.just(0.0)),
        st.tuples(st.just("drive"), st.sampled_from((0.0, 0.5, 1.0, -1.0))),
        st.tuples(st.just("late"), st.integers(-3, 12)),
        st.tuples(st.just("other"), st.just(1.0)),
        st.tuples(st.sampled_from(("arm", "stop", "disarm", "leave", "take", "pad")), st.just(0.0)),
    ),
    min_size=5,
    max_size=60,
)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(_STEPS)
def test_no_speed_outlives_the_lease_of_its_tick(
    steps: list[tuple[str, float]],
) -> None:
    scene = Scene(roburoc4.Simulator())
    newest_s = float("-inf")  # issue of the newest tick that an accepted speed can answer to
    with scene.sim, scene.robot:
        scene.arm()
        for what, value in steps:
            page = scene.pages[0]
            now_s = scene.robot.now_s
            try:
                if what == "wait":
                    scene.sim.step(value)
                elif what == "show":
                    scene.show()
                elif what == "drive":
                    scene.drive(0, scene.ticks.last, value)
                    newest_s = max(newest_s, scene.issued_s[scene.ticks.last])
                elif what == "late":
                    tick = scene.ticks.last - int(value)
                    scene.drive(0, tick, 0.7)
                    newest_s = max(newest_s, scene.issued_s.get(tick, newest_s))
                elif what == "other":
                    scene.drive(1, scene.ticks.last, value)
                elif what == "arm":
                    scene.control.arm(page, scene.ticks.last, now_s)
                elif what == "stop":
                    scene.control.stop(scene.pages[1])
                elif what == "disarm":
                    scene.control.disarm(page)
                elif what == "leave":
                    scene.control.leave(page)
                elif what == "take":
                    scene.control.take(page)
                else:
                    scene.sim.set("pad_a", True)
                    scene.sim.step(0.1)
                    scene.sim.set("pad_a", False)
            except ControlError:
                pass
            scene.control.watch(scene.robot.now_s)
            scene.sim.step(CYCLE_S)
            if scene.driven:
                assert scene.robot.now_s - newest_s <= LEASE_S + 2 * CYCLE_S
            if what in ("stop", "disarm", "leave", "pad"):
                assert not scene.robot.facts.driving
