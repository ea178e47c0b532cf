# SPDX-License-Identifier: MIT
"""Closing ends what waits in one way, whoever moves the datagrams: iterations end, waits raise."""

import asyncio
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
from robot_support import until

import roburoc4
from roburoc4 import ClosedError, Robot, Simulator


@contextmanager
def _virtual() -> Iterator[Robot]:
    with Simulator() as sim, sim.connect() as robot:
        yield robot


@contextmanager
def _threaded() -> Iterator[Robot]:
    with Simulator(port=0) as sim, roburoc4.connect(sim.address) as robot:
        yield robot


@contextmanager
def _manual() -> Iterator[Robot]:
    with Simulator(port=0) as sim, roburoc4.connect(sim.address, threaded=False) as robot:
        yield robot


def test_a_robot_that_does_not_become_ready_is_closed() -> None:
    with Simulator() as sim:
        robot = sim.connect()
        sim.set("power", False)
        robot.sleep(3)
        with pytest.raises(roburoc4.RobotTimeoutError):
            robot.wait_ready(0.5)
        assert robot.closed


KINDS = pytest.mark.parametrize("kind", [_virtual, _threaded, _manual])


@KINDS
def test_an_iteration_ends(kind: Callable[[], Iterator[Robot]]) -> None:
    with kind() as robot:  # type: ignore[attr-defined]
        events = robot.events()
        robot.arm()
        for number, _ in enumerate(robot.statuses("localization")):
            if number == 3:
                robot.close()
        assert number >= 3
        assert robot.closed
        assert roburoc4.Event.ARMED in list(events)
        assert list(robot.statuses()) == []
        assert list(robot.events()) == []


@KINDS
def test_a_wait_raises(kind: Callable[[], Iterator[Robot]]) -> None:
    with kind() as robot:  # type: ignore[attr-defined]
        statuses, events = robot.statuses("battery"), robot.events()
        robot.close()
        waits: list[Callable[[], object]] = [
            lambda: robot.wait_for("battery"),
            lambda: robot.wait_for(lambda robot: False),
            lambda: robot.sleep(1.0),
            lambda: robot.record(1.0),
            lambda: (statuses.take() and None) or statuses.take(),
            lambda: (events.take() and None) or events.take(),
            lambda: robot.arm(),
            lambda: robot.drive(0.1, 0.0),
            lambda: robot.move(1.0),
        ]
        for wait in waits:
            with pytest.raises(ClosedError):
                wait()


def test_another_thread_ends_iterations_and_waits() -> None:
    with Simulator(port=0) as sim, roburoc4.connect(sim.address) as robot:
        ends: list[object] = []

        def note(wait: Callable[[], object]) -> None:
            try:
                wait()
                ends.append("end")
            except ClosedError:
                ends.append("raised")

        never = roburoc4.Event.REBOOT
        waits = [
            lambda: list(robot.statuses("battery")),
            lambda: list(robot.events()),
            lambda: robot.wait_for(never, None),
            lambda: robot.sleep(1e6),
        ]
        threads = [threading.Thread(target=note, args=(wait,)) for wait in waits]
        for thread in threads:
            thread.start()
        robot.sleep(0.2)
        robot.close()
        for thread in threads:
            thread.join()
    assert sorted(ends, key=str) == ["end", "end", "raised", "raised"]


def test_asyncio_ends_alike() -> None:
    async def use(address: str) -> None:
        async with roburoc4.aio.connect(address) as robot:
            events = robot.events()
            await robot.arm()
            async for _ in robot.statuses("localization"):
                await robot.close()
            assert roburoc4.Event.ARMED in [event async for event in events]
            assert [status async for status in robot.statuses()] == []
            assert [event async for event in robot.events()] == []
            for wait in (robot.wait_for("battery"), robot.record(1.0), robot.arm()):
                with pytest.raises(ClosedError):
                    await wait

    with Simulator(port=0) as sim:
        asyncio.run(use(sim.address))


def test_a_simulator_that_ends_ends_the_iterations_in_its_time() -> None:
    with Simulator() as sim, sim.connect() as robot:
        for number, _ in enumerate(robot.statuses("localization")):
            if number == 3:
                sim.close()
        assert number >= 3
        until(lambda: robot.closed)
