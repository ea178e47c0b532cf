# SPDX-License-Identifier: MIT
"""The robot for asyncio, on a real socket."""

import asyncio
import gc
import threading

import pytest
from robot_support import until

import roburoc4
from roburoc4 import Event, Simulator


def test_a_program_of_coroutines(served: Simulator) -> None:
    async def program() -> None:
        async with roburoc4.aio.connect(served.address) as robot:
            await robot.arm()
            await robot.drive_for(0.5, 0.0, seconds=0.5)
            await robot.relocalize(1.0, 2.0, 0.5)
            status = await robot.wait_for("localization")
            assert isinstance(status, roburoc4.LocalizationStatus)
            assert await robot.wait_for(lambda r: r.battery.remaining_percent) == 100
            served.set("pad_a", True)
            assert await robot.wait_for(Event.OVERRIDE) == Event.OVERRIDE
            recording = await robot.record(2.0, "differential")
            assert len(recording["differential"]["current_linear_m_s"]) >= 5
            with pytest.raises(TimeoutError, match="LOST"):
                await robot.wait_for(Event.LOST, timeout=0.1)

    asyncio.run(program())
    assert served.state.last_linear_m_s == 0
    assert served.state.nonzero_speed_commands >= 2


def test_properties_have_values_right_after_connecting(served: Simulator) -> None:
    async def program() -> None:
        async with roburoc4.aio.connect(served.address) as robot:
            assert robot.battery.remaining_percent == 100
            assert robot.telemeter.distances_m
        served.set("power", False)
        async with roburoc4.aio.connect(served.address, wait=False) as robot:
            assert robot.state is not roburoc4.State.READY
            served.set("power", True)
            await robot.wait_ready()
            assert robot.localization.x_m == 0.0

    asyncio.run(program())


def test_events_and_statuses_wait_no_longer_than_requested(served: Simulator) -> None:
    async def program() -> None:
        async with roburoc4.aio.connect(served.address) as robot:
            events = robot.events(timeout=60)
            await robot.arm()
            assert await anext(events) is Event.ARMED
            with pytest.raises(TimeoutError, match="no battery status"):
                async for _ in robot.statuses("battery", timeout=0.1):
                    pass
            robot.stop()
            seen = set()
            while not {Event.DISARMED, Event.STOP_CONFIRMED} <= seen:
                seen.add(await anext(events))
            await robot.close()
            assert [event async for event in events][1:] == []

    asyncio.run(program())


def test_an_async_progress_function_is_awaited(served: Simulator) -> None:
    seen: list[float] = []

    class Show:
        async def __call__(self, result: roburoc4.MoveResult) -> None:
            await asyncio.sleep(0)
            seen.append(result.remaining_m)

    async def later(_: object) -> bool:
        return True

    async def program() -> None:
        async with roburoc4.aio.connect(served.address) as robot:
            with pytest.raises(roburoc4.ArgumentError, match="not async"):
                await robot.wait_for(later)
            await robot.arm()
            await robot.move(0.2, on_progress=Show())

    asyncio.run(program())
    assert len(seen) > 3


async def driving(robot: roburoc4.aio.Robot, served: Simulator) -> asyncio.Task[None]:
    await robot.arm()
    task = asyncio.create_task(robot.drive_for(0.5, 0.0, seconds=60))
    await asyncio.to_thread(until, lambda: served.state.last_linear_m_s != 0)
    return task


def test_cancelling_a_drive_stops_the_robot(served: Simulator) -> None:
    async def program() -> None:
        async with roburoc4.aio.connect(served.address) as robot:
            task = await driving(robot, served)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert not robot.facts.driving
            await asyncio.to_thread(until, lambda: served.state.last_linear_m_s == 0)

    asyncio.run(program())


def test_a_robot_that_nobody_keeps_ends_with_its_thread(served: Simulator) -> None:
    async def program() -> None:
        robot = await roburoc4.aio.connect(served.address)
        await robot.arm()
        robot.drive(0.5, 0.0, lease_s=1.0)
        del robot
        gc.collect()
        await asyncio.to_thread(until, lambda: served.state.last_linear_m_s == 0)

    asyncio.run(program())
    until(lambda: not [t for t in threading.enumerate() if t.name == "roburoc4-aio"])


def test_silence_is_reported(served: Simulator) -> None:
    async def program() -> None:
        with pytest.raises(roburoc4.RobotTimeoutError, match="nothing listens"):
            await roburoc4.aio.connect("127.0.0.1:9", timeout=0.5)
        with pytest.raises(roburoc4.ArgumentError):
            await roburoc4.aio.connect("")

    asyncio.run(program())
