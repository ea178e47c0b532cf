# SPDX-License-Identifier: MIT
"""One commander at a time."""

import signal
from collections.abc import Callable

from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import now_us, stop_command

Plan = Callable[..., Planner]


def test_of_two_commanders_the_first_keeps_control(robot: Robot, armed: Bridge, plan: Plan) -> None:
    first = plan(sender="first", linear=0.3)
    until(robot.tap.moves, "the first drives")
    plan(sender="second", linear=-0.3)
    until(lambda: armed.statistics.rejected_control > 10, "the second is refused")
    assert min(command.linear_m_s for command in robot.tap.moves()) > 0
    assert armed.state.control_owner == "first"

    first.signal(signal.SIGKILL)
    killed_us = now_us()
    until(lambda: armed.state.control_owner == "second", "control is free")
    until(lambda: robot.tap.moves()[-1].linear_m_s < 0, "the second drives")
    # Not before the first one's lease was over, the last of which began 50 ms ago at most.
    changed = next(command for command in robot.tap.moves() if command.linear_m_s < 0)
    assert changed.time_us - killed_us > 200_000


def test_only_allowed_senders_drive_and_anybody_stops(
    robot: Robot, bus: Bus, start_bridge: Callable[..., Bridge], plan: Plan
) -> None:
    bridge = start_bridge("--enable-drive", "--allow-sender=planner*, joystick").arms()
    plan(sender="stranger", linear=-0.3)
    until(lambda: bridge.statistics.rejected_sender > 10, "the stranger is refused")
    until(
        lambda: (
            bridge.state.rejected_message
            == "only senders planner*, joystick are obeyed (--allow-sender)"
        ),
        f"the state says why; the bridge said:\n{bridge.output}",
    )
    assert bridge.state.can_drive, "a stranger does not keep others from driving"
    plan(sender="planner 17", linear=0.3)
    until(robot.tap.moves, "the planner drives")
    assert {command.linear_m_s for command in robot.tap.moves()} == {0.3}
    bus.publish("ROBUROC4_STOP_CMD", stop_command("stranger").encode())
    until(lambda: bridge.state.stopped_by == "stranger", "a stranger may stop the robot")


def test_a_rejection_names_what_keeps_the_robot_from_driving(
    robot: Robot, armed: Bridge, plan: Plan
) -> None:
    robot.tell("pad a down")
    until(lambda: armed.state.overridden, "the bridge sees the override")
    plan(linear=0.3)
    until(
        lambda: (
            "the robot cannot be armed" in armed.state.rejected_message
            and "[A]" in armed.state.rejected_message
        ),
        f"the cause is named, not: {armed.state.rejected_message}",
    )
