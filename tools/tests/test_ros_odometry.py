# SPDX-License-Identifier: MIT
"""Odometry is one thing: pose and speeds of one moment, in a frame that never jumps (REP-105)."""

import math
from collections.abc import Iterable
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

import roburoc4
from roburoc4_tools.ros.odometry import Frames
from roburoc4_tools.ros.topics import Messages

STORE = get_typestore(Stores.ROS2_JAZZY)
KINDS = {
    "odom": "nav_msgs/msg/Odometry",
    "tf": "tf2_msgs/msg/TFMessage",
    "diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


def pose(cycle: int, x_m: float, y_m: float = 0.0, theta_rad: float = 0.0) -> Any:
    return roburoc4.LocalizationStatus(cycle, x_m, y_m, theta_rad, 0, utc_s=100 + cycle / 100)


def speeds(cycle: int) -> Any:
    """The measured speed is the cycle, so that a test knows it again."""
    return roburoc4.DifferentialStatus(cycle, 0.0, cycle / 1000, 0.0, 0.0, utc_s=100 + cycle / 100)


def made(messages: Messages, items: Iterable[Any]) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {kind: [] for kind in KINDS}
    made_of = [each for item in items for each in messages.of(item)]
    for topic, data in [*made_of, *messages.rest()]:
        if topic in KINDS:
            found[topic].append(STORE.deserialize_cdr(data, KINDS[topic]))
    return found


def stamp_s(message: Any) -> float:
    return float(message.header.stamp.sec + message.header.stamp.nanosec / 1e9)


@pytest.mark.parametrize(
    "order", [(pose, speeds), (speeds, pose)], ids=["pose first", "speeds first"]
)
def test_pose_and_twist_are_of_one_cycle(order: tuple[Any, Any]) -> None:
    items = []
    for cycle in range(0, 100, 5):
        for make in order:
            items.append(make(cycle, cycle / 1000) if make is pose else make(cycle))
    found = made(Messages(None, ""), items)["odom"]
    assert len(found) == 20
    for odometry in found:
        cycle = round((stamp_s(odometry) - 100) * 100)
        assert odometry.pose.pose.position.x == pytest.approx(cycle / 1000)
        assert odometry.twist.twist.linear.x == pytest.approx(cycle / 1000)


def test_lost_or_rarer_speeds_hold_no_pose_back() -> None:
    messages = Messages(None, "")
    assert list(messages.of(pose(-10, 0.0))) == []
    assert len(list(messages.of(pose(-5, 0.0)))) == 4, "there are no speeds"
    made(messages, [speeds(0), pose(0, 0.0), speeds(10), pose(10, 0.0)])
    for cycle in (12, 14, 16, 18):  # speeds are due with cycle 20
        assert [topic for topic, _ in messages.of(pose(cycle, 0.0))] == ["odom", "tf"]
    assert list(messages.of(pose(20, 0.0))) == []
    assert len(list(messages.of(pose(22, 0.0)))) == 4, "the speeds were lost: both poses"


def path(found: dict[str, list[Any]]) -> list[tuple[float, float, float]]:
    poses = [each.pose.pose for each in found["odom"]]
    return [
        (one.position.x, one.position.y, 2 * math.atan2(one.orientation.z, one.orientation.w))
        for one in poses
    ]


def test_odom_goes_on_after_a_relocalization_and_map_moves() -> None:
    reports: list[str] = []
    messages = Messages(None, "", frames=Frames(map="map", prefix="red/"), report=reports.append)
    found = made(messages, [pose(0, 1.0), pose(5, 1.1), pose(10, 7.0, 2.0, math.pi / 2)])
    assert path(found)[-1] == pytest.approx((1.1, 0.0, 0.0))
    # a metre forward, which is along y by the robot's new heading
    found = made(messages, [pose(15, 7.0, 2.1, math.pi / 2)])
    assert path(found)[-1] == pytest.approx((1.2, 0.0, 0.0))
    to_odom, to_base = found["tf"][-1].transforms
    assert (to_odom.header.frame_id, to_odom.child_frame_id) == ("map", "red/odom")
    assert (to_base.header.frame_id, to_base.child_frame_id) == ("red/odom", "red/base_link")
    half = 2 * math.atan2(to_odom.transform.rotation.z, to_odom.transform.rotation.w)
    place = to_odom.transform.translation
    in_odom = complex(to_base.transform.translation.x, to_base.transform.translation.y)
    in_map = complex(place.x, place.y) + in_odom * complex(math.cos(half), math.sin(half))
    assert (in_map.real, in_map.imag) == pytest.approx((7.0, 2.1)), "map has the robot's own pose"
    (report,) = reports
    assert "relocalized to 7.00 m, 2.00 m" in report


def test_odom_goes_on_after_a_restart_and_map_stays() -> None:
    reports: list[str] = []
    messages = Messages(None, "", frames=Frames(map="map"), report=reports.append)
    found = made(messages, [pose(1000, 3.0, 1.0), pose(3, 0.0), pose(8, 0.1)])
    assert path(found)[1:] == [pytest.approx((3.0, 1.0, 0.0)), pytest.approx((3.1, 1.0, 0.0))]
    place = found["tf"][-1].transforms[0].transform.translation
    assert (place.x, place.y) == (0.0, 0.0)
    (event,) = found["diagnostics"]
    assert "restarted" in event.status[0].message
    assert reports == [event.status[0].message]


def test_a_fast_robot_and_a_gap_are_no_relocalization() -> None:
    messages = Messages(None, "")
    fast = roburoc4.DifferentialStatus(0, 2.0, 2.0, 0.0, 0.0)
    found = made(messages, [fast, pose(0, 0.0), pose(10, 0.2), pose(1010, 9.0)])
    assert [round(x, 6) for x, _, _ in path(found)] == [0.0, 0.2, 9.0]
    assert found["diagnostics"] == []
