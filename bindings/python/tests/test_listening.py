# SPDX-License-Identifier: MIT
"""Waiting, iterating, recording; losses and reboots; in virtual time."""

import itertools
import subprocess
from collections.abc import Callable

import pytest

import roburoc4
from roburoc4 import Event, Recording, Simulator
from roburoc4.samples import mask_of


def test_statuses_come_one_by_one_and_none_is_missing(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        seen = list(itertools.islice(robot.statuses("localization"), 200))
        cycles = [status.robot_cycles for status in seen]
        assert all(isinstance(status, roburoc4.LocalizationStatus) for status in seen)
        assert {b - a for a, b in itertools.pairwise(cycles)} == {5}


def test_overflow_is_counted_raised_once_and_iteration_continues(
    roburoc4_simulator: Simulator,
) -> None:
    with roburoc4_simulator.connect(buffer=100) as robot:
        statuses = robot.statuses()
        roburoc4_simulator.step(10.0)
        with pytest.raises(roburoc4.SamplesLostError, match="buffer=") as caught:
            next(statuses)
        assert caught.value.lost > 400
        assert statuses.lost == caught.value.lost
        rest = [next(statuses) for _ in range(100)]
        assert rest[-1].host_us <= robot.now_s * 1e6


def test_wait_for_returns_what_it_waited_for(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        status = robot.wait_for("telemeter")
        assert isinstance(status, roburoc4.TelemeterStatus)
        assert robot.wait_for(lambda r: r.battery.remaining_percent) == 100
        roburoc4_simulator.set("pad_a", True)
        assert robot.wait_for(Event.OVERRIDE | Event.LOST) == Event.OVERRIDE


def test_wait_for_ends_in_the_time_it_was_given(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        before_s = robot.now_s
        with pytest.raises(TimeoutError, match="no LOST event within 3 s") as caught:
            robot.wait_for(Event.LOST, timeout=3)
        assert robot.now_s - before_s == pytest.approx(3, abs=0.01)
        assert isinstance(caught.value, roburoc4.RobotError)
        assert caught.value.code == roburoc4.Result.TIMEOUT

        def dancing(r: roburoc4.Robot) -> bool:
            return r.closed

        with pytest.raises(TimeoutError, match="dancing"):
            robot.wait_for(dancing, timeout=1)


def test_statuses_wait_no_longer_than_requested(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        statuses = robot.statuses("battery", timeout=0.3)
        with pytest.raises(TimeoutError, match=r"no battery status within 0\.3 s"):
            for _ in range(100):
                next(statuses)
        robot.sleep(1.0)
        assert next(statuses).remaining_percent == 100


def test_events_come_one_by_one_with_a_sentence(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        events = robot.events(timeout=2.0)
        robot.arm()
        roburoc4_simulator.set("pad_a", True)
        seen = list(itertools.takewhile(lambda event: event is not Event.OVERRIDE, events))
        assert {Event.ARMED, Event.DISARMED} <= set(seen)
        assert all(event.text for event in seen)
        with pytest.raises(TimeoutError, match="no event within 2 s"):
            list(events)
        robot.close()
        list(events)


TABLES = """
import pandas, roburoc4
with roburoc4.Simulator() as sim, sim.connect() as robot:
    tables = robot.record(1.0, "localization", "battery").to_pandas()
assert set(tables) == {"localization", "battery"}
table = tables["localization"]
assert len(table) in (19, 20, 21)
assert table["x_m"].iloc[0] == 0.0
assert table.index.name == "utc"
assert table.index[1] - table.index[0] == pandas.Timedelta("50ms")
"""


def test_a_recording_becomes_tables_of_pandas(
    start: Callable[[str], subprocess.Popen[str]],
) -> None:
    pytest.importorskip("pandas")
    process = start(TABLES)
    assert process.communicate(timeout=120) == ("", "")
    assert process.returncode == 0


def test_record_gives_columns_of_equal_length(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        recording = robot.record(2.0, "localization", "telemeter", "iocard")
        assert set(recording) == {"localization", "telemeter", "iocard"}
        assert len(recording["localization"]["x_m"]) == pytest.approx(40, abs=1)
        assert {"distance_0_m", "distance_1_m"} <= set(recording["telemeter"])
        assert {"analog_input_8", "digital_input_21"} <= set(recording["iocard"])
        for columns in recording.values():
            assert len({len(column) for column in columns.values()}) == 1
        assert recording.lost == 0


def test_a_recording_counts_its_gaps(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        sim_time_s = roburoc4_simulator.now_s
        later = robot.statuses("localization", "telemeter")
        robot.sleep(1.0)
        roburoc4_simulator.set_faults(loss=1.0)
        robot.sleep(2.5)
        roburoc4_simulator.set_faults(loss=0.0)
        robot.wait_for("localization")
        robot.sleep(1.0)
        recording = Recording(mask_of(("localization", "telemeter")), robot.period_s)
        for status in later.take():
            recording.add(status)
        recording.end(robot.now_s)
        (gap,) = recording.gaps
        assert gap.seconds > 2.5
        assert gap.utc_s == pytest.approx(sim_time_s + 1.0, abs=0.2)
        assert gap.services == ("localization", "telemeter")
        assert recording.lost == pytest.approx(gap.seconds * 30, rel=0.1)


def test_connecting_to_silence_says_what_was_tried() -> None:
    with Simulator() as sim:
        sim.set("power", False)
        before_s = sim.now_s
        with pytest.raises(TimeoutError, match=r"datagrams sent, 0 received.*firewall"):
            sim.connect(timeout=5)
        assert 5 <= sim.now_s - before_s < 6


def test_the_timeout_of_connect_counts_silence_not_progress() -> None:
    with Simulator() as sim:
        sim.set_faults(delay_ms=200)
        before_s = sim.now_s
        with sim.connect(timeout=1.0, lost_ms=5000) as robot:
            assert robot.state is roburoc4.State.READY
            assert robot.now_s - before_s > 1.5
