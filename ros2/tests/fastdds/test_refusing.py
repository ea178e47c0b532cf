# SPDX-License-Identifier: MIT
"""What must not move the robot does not."""

import time
from collections.abc import Callable

from processes import Program, Robot, until
from ros import STORE, Listener, Node, Publisher

StartNode = Callable[..., Node]
Drive = Callable[..., Program]
Publish = Callable[..., Publisher]


def test_without_enable_drive_nobody_subscribes(
    robot: Robot, start_node: StartNode, listener: Listener
) -> None:
    start_node()
    listener.hears("rt/odom")
    time.sleep(1)
    assert not [e for e in listener.of_node() if e.kind == "reader" and "cmd_vel" in e.topic]
    assert not robot.tap.commands(), "a node that only watches sends no command"


def test_stop_is_obeyed_from_anyone_and_holds(
    robot: Robot, driven: Node, listener: Listener, drive: Drive, publish: Publish
) -> None:
    drive("speed", 0.3, 0)
    until(robot.tap.moves, "it drives")
    stop = next(e for e in listener.of_node() if e.kind == "reader" and e.topic.endswith("stop"))
    assert stop.type == "std_msgs::msg::dds_::Empty_"
    empty = bytes(STORE.serialize_cdr(STORE.types["std_msgs/msg/Empty"](), "std_msgs/msg/Empty"))
    # A single one can be lost before both sides know each other: see docs/ros2.md.
    publish(stop.topic, "std_msgs/msg/Empty").send_until(
        lambda: "stopped by" in driven.output, empty
    )
    driven.says("stopped by")
    until(lambda: not robot.tap.commands()[-1].moves, "the robot is stopped")
    stopped_us = robot.tap.commands()[-1].time_us
    time.sleep(1.5)
    assert not robot.tap.moves(stopped_us), "the stream goes on, the robot does not"
    until(robot.stands, "the robot stands")
