# SPDX-License-Identifier: MIT
"""Moves end where they should, with a result; all of it in virtual time but for asyncio."""

import asyncio
import math
import pickle
from collections.abc import Iterator

import pytest

import roburoc4
from roburoc4 import MoveError, MoveOutcome, MoveResult, Result, Simulator

CENTIMETRE = 0.01
DEGREE = math.pi / 180


@pytest.fixture
def sim() -> Iterator[Simulator]:
    with Simulator(slip=0.0) as simulator:
        simulator.clear_obstacles()
        yield simulator


def test_a_move_ends_where_its_arguments_say_with_its_result(sim: Simulator) -> None:
    with sim.connect() as robot:
        robot.arm()
        result = robot.move(1.0)
        assert result.outcome is MoveOutcome.REACHED
        assert result.distance_m == pytest.approx(1.0, abs=CENTIMETRE)
        assert abs(result.remaining_m) < CENTIMETRE
        assert sim.true_pose.x_m == pytest.approx(1.0, abs=CENTIMETRE)
        result = robot.turn(math.pi / 2)
        assert result.angle_rad == pytest.approx(math.pi / 2, abs=DEGREE)
        assert result.pose is not None
        assert result.pose.theta_rad == pytest.approx(math.pi / 2, abs=DEGREE)
        robot.arc(math.pi / 2, -math.pi / 2)
        assert sim.true_pose.x_m == pytest.approx(2.0, abs=0.03)
        assert sim.true_pose.y_m == pytest.approx(1.0, abs=0.03)
        robot.goto(1.0, 1.0, -1.0)
        assert sim.true_pose.x_m == pytest.approx(1.0, abs=0.03)
        assert sim.true_pose.theta_rad == pytest.approx(-1.0, abs=DEGREE)
        assert robot.facts.armed


def test_degrees_and_speeds_beyond_the_ceilings_are_refused(sim: Simulator) -> None:
    with sim.connect() as robot:
        robot.arm()
        for turn in (
            lambda: robot.turn(90.0),
            lambda: robot.arc(1.0, 90.0),
            lambda: robot.goto(1.0, 0.0, 90),
        ):
            with pytest.raises(roburoc4.ArgumentError, match="not degrees"):
                turn()
        with pytest.raises(roburoc4.ArgumentError, match="not mm/s"):
            robot.move_for(300.0, 0.0, 1.0)
        for move in (lambda: robot.move(1.0, speed=1.1), lambda: robot.move_for(0.0, 1.6, 1.0)):
            with pytest.raises(roburoc4.ArgumentError, match="ceilings"):
                move()
        for speed in (0.4, 0.9):
            with pytest.raises(
                roburoc4.ArgumentError, match=rf"^speed: {speed} m/s, at which .* rad/s"
            ):
                robot.arc(0.5, 2.0, speed=speed)
        assert sim.state.nonzero_speed_commands == 0
        robot.turn(4.5 * math.pi, speed=1.5, allow_turns=True)
        assert sim.true_pose.theta_rad == pytest.approx(math.pi / 2, abs=2 * DEGREE)


def test_a_timeout_is_an_error(sim: Simulator) -> None:
    with sim.connect() as robot:
        robot.arm()
        with pytest.raises(MoveError) as caught:
            robot.move(5.0, clearance=0, timeout=1.0)
        assert caught.value.outcome is MoveOutcome.TIMEOUT


@pytest.mark.parametrize(("end", "code"), [("stop", Result.STOP_CALLED), ("pause", Result.STATE)])
def test_a_stop_button_ends_a_move(sim: Simulator, end: str, code: Result) -> None:
    with sim.connect() as robot:

        def press(result: MoveResult) -> None:
            if 0.3 < result.distance_m < 0.35:
                getattr(robot, end)()

        robot.arm()
        with pytest.raises(MoveError) as caught:
            robot.move(2.0, on_progress=press)
        assert caught.value.code == code
        assert caught.value.result.outcome is MoveOutcome.CANCELLED
        assert "link" not in str(caught.value)
        assert sim.state.last_linear_m_s == 0


@pytest.mark.parametrize("seconds", [0.01, 60])
def test_a_pause_between_two_commands_ends_drive_for(
    sim: Simulator, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    with sim.connect(lease_ms=1000) as robot:
        sleep = robot.sleep

        def sleep_and_stop(left_s: float) -> None:
            sleep(left_s)
            robot.pause()

        robot.arm()
        monkeypatch.setattr(robot, "sleep", sleep_and_stop)
        with pytest.raises(roburoc4.RobotError, match="was paused meanwhile"):
            robot.drive_for(0.3, 0.0, seconds=seconds)
        commands = sim.state.nonzero_speed_commands
        sleep(2)
        assert sim.state.nonzero_speed_commands == commands


def test_a_robot_that_is_not_armed_does_not_move(sim: Simulator) -> None:
    with sim.connect() as robot:
        for move in (lambda: robot.move(1.0), lambda: robot.goto(1.0, 0.0)):
            with pytest.raises(roburoc4.NotArmedError, match=r"arm\(\)"):
                move()
        assert robot.rest().outcome is MoveOutcome.REACHED
    assert sim.state.nonzero_speed_commands == 0


def test_a_second_move_is_refused_at_once(sim: Simulator) -> None:
    refused: list[str] = []

    def interfere(result: MoveResult) -> None:
        for second in (lambda: robot.move(-0.4), lambda: robot.drive_for(-0.1, 0.0, 1.0)):
            with pytest.raises(roburoc4.RobotError, match="under way") as caught:
                second()
            assert caught.value.code is roburoc4.Result.STATE
            refused.append(str(caught.value))

    with sim.connect() as robot:
        robot.arm()
        assert robot.move(0.4, on_progress=interfere).outcome is MoveOutcome.REACHED
        assert refused
        robot.move(-0.4)
        robot.drive_for(0.1, 0.0, 0.1)
        robot.rest()


def test_an_exception_in_mid_move_stops_the_robot(sim: Simulator) -> None:
    def interrupt(result: MoveResult) -> None:
        if result.distance_m > 0.3:
            raise KeyboardInterrupt

    with sim.connect() as robot:
        robot.arm()
        with pytest.raises(KeyboardInterrupt):
            robot.move(2.0, on_progress=interrupt)
        assert sim.state.last_linear_m_s == 0
        assert robot.facts.stopping


def test_asyncio_moves_and_cancels() -> None:
    async def main(sim: Simulator) -> None:
        async with roburoc4.aio.connect(sim.address) as robot:
            await robot.arm()
            result = await robot.move(0.2)
            assert result.outcome is MoveOutcome.REACHED
            await robot.turn(0.2)
            first, second = await asyncio.gather(
                robot.move(0.2), robot.move(-0.2), return_exceptions=True
            )
            assert isinstance(first, MoveResult)
            assert isinstance(second, roburoc4.RobotError)
            assert "under way" in str(second)
            task = asyncio.create_task(robot.move(5.0))
            await robot.wait_for(lambda r: r.differential.current_linear_m_s > 0.1)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert robot.facts.stopping
            await robot.rest()
        with pytest.raises(roburoc4.ClosedError):
            await robot.move(0.2)

    with Simulator(port=0, slip=0.0) as sim:
        asyncio.run(main(sim))
        assert sim.state.last_linear_m_s == 0


def test_an_obstacle_is_named_with_its_side_and_distance(sim: Simulator) -> None:
    sim.add_box(2.5, 0.0, 0.2, 2.0)
    sim.add_box(-2.5, 0.0, 0.2, 2.0)
    with sim.connect() as robot:
        for distance_m, side in ((3.0, "ahead"), (-5.0, "behind")):
            robot.arm()
            with pytest.raises(MoveError, match=rf"too near, 0\.\d\d m {side}: clear") as caught:
                robot.move(distance_m)
            assert caught.value.result.outcome is MoveOutcome.OBSTACLE
            assert 0.1 < abs(caught.value.result.distance_m) < abs(distance_m) - 1.0
            assert abs(caught.value.result.remaining_m) > 1.0
            copy = pickle.loads(pickle.dumps(caught.value))
            assert str(copy) == str(caught.value)
            robot.rest()
