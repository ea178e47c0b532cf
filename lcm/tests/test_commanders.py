# SPDX-License-Identifier: MIT
"""One commander at a time."""

from collections.abc import Callable

from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import stop_command

Plan = Callable[..., Planner]


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
