# SPDX-License-Identifier: MIT
"""threaded=False: the program spins, or another loop watches the socket."""

import re
import select
import time

import pytest
from robot_support import LONG_S, until

import roburoc4
from roburoc4 import Simulator


def test_everything_that_waits_spins(served: Simulator) -> None:
    with roburoc4.connect(served.address, threaded=False) as robot:
        robot.arm()
        robot.drive_for(0.5, 0.0, seconds=0.5)
        robot.relocalize(1.0, 2.0, 0.5)
        assert robot.wait_for("localization")
        assert len(robot.record(2.0, "localization")["localization"]["x_m"]) >= 5
        statuses = robot.statuses("differential")
        assert [type(next(statuses)) for _ in range(3)] == [roburoc4.DifferentialStatus] * 3
    assert served.state.last_linear_m_s == 0
    assert served.state.nonzero_speed_commands >= 2


def test_nothing_happens_without_spin(served: Simulator) -> None:
    with roburoc4.connect(served.address, threaded=False) as robot:
        robot.wait_for("localization")
        before = robot.localization
        time.sleep(0.3)
        assert robot.localization == before
        until(lambda: robot.spin(0.0) or robot.localization != before)


def test_who_sleeps_without_spinning_is_told_so(served: Simulator) -> None:
    with roburoc4.connect(served.address, threaded=False) as robot:
        for nap in (lambda: time.sleep(2.0), lambda: [time.sleep(2.0), robot.spin(0)]):
            robot.arm()
            nap()
            with pytest.raises(roburoc4.NotArmedError, match=r"for [2-9].* s: .*spin\(\)"):
                robot.drive(0.1, 0.0)
            robot.stop()
            with pytest.raises(roburoc4.NotArmedError, match="stopped") as caught:
                robot.drive(0.1, 0.0)
            assert "spin" not in str(caught.value)


def test_another_loop_can_watch_the_socket(served: Simulator) -> None:
    with roburoc4.connect(served.address, threaded=False) as robot:
        statuses = robot.service_link("localization").received
        end = time.monotonic() + LONG_S
        while robot.service_link("localization").received < statuses + 10:
            select.select([robot.fileno()], [], [], min(robot.next_deadline(), 1.0))
            robot.spin(0)
            assert time.monotonic() < end


@pytest.mark.parametrize("threaded", [True, False])
@pytest.mark.parametrize(
    ("host", "error"),
    [
        ("127.0.0.1:99999", roburoc4.ArgumentError),
        ("127.0.0.1\0.evil", roburoc4.ArgumentError),
        ("no.such.host.invalid", roburoc4.NetworkError),
    ],
)
def test_invalid_addresses_are_named(threaded: bool, host: str, error: type[Exception]) -> None:
    with pytest.raises(error, match=re.escape(repr(host))):
        if threaded:
            roburoc4.connect(host, timeout=1)
        else:
            roburoc4.connect(host, timeout=1, threaded=False)
