# SPDX-License-Identifier: MIT
"""What the robot reports reaches Fast DDS, and rosbags reads the values that were set."""

import math
import re
import time
from collections.abc import Callable

from processes import Robot
from ros import Listener, Node

StartNode = Callable[..., Node]
Listen = Callable[..., Listener]


def odometry_of(robot: Robot) -> tuple[float, float, float]:
    found = re.search(r"odometry (\S+) (\S+) (\S+)", robot.tell("status"))
    assert found
    return float(found[1]), float(found[2]), float(found[3].rstrip(",;"))


def test_every_topic_reaches_fast_dds(
    start_node: StartNode, listener: Listener, listed: list[dict[str, str]]
) -> None:
    start_node("--enable-drive")
    published = [each["topic"] for each in listed if each["direction"] == "published"]
    assert len(published) >= 14
    for topic in published:
        sample = listener.hears(f"rt{topic}")
        assert sample.cdr[:2] == b"\x00\x01", "plain CDR, little-endian"
        assert sample.same, f"{topic}: Fast DDS encodes {sample.message} otherwise"
    assert not listener.incompatible


def test_a_late_subscriber_gets_robot_and_static_frames(
    start_node: StartNode, listener: Listener, listen: Listen
) -> None:
    start_node()
    listener.hears("rt/robot_description")
    time.sleep(2)
    late = listen()
    urdf = late.hears("rt/robot_description").message.data
    assert "<robot" in urdf
    assert '<link name="base_link"' in urdf
    frames = [each.child_frame_id for each in late.hears("rt/tf_static").message.transforms]
    assert len(frames) >= 2
    for frame in frames:
        assert f'"{frame}"' in urdf, "RViz shows each sensor where the tree has it"


def test_odometry_is_the_robots_own(
    robot: Robot, start_node: StartNode, listener: Listener
) -> None:
    start_node()
    listener.hears("rt/odom")
    x, y, theta = odometry_of(robot)

    def here(odometry: object) -> bool:
        pose = odometry.pose.pose  # type: ignore[attr-defined]
        heading = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
        near = math.hypot(pose.position.x - x, pose.position.y - y) < 0.01
        return near and abs(math.remainder(heading - theta, math.tau)) < 0.01

    odometry = listener.hears_that("rt/odom", here)
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    assert all(odometry.pose.covariance[i * 7] > 0 for i in (0, 1, 5)), "it is not exact"
    transform = listener.hears("rt/tf").message.transforms[0]
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
