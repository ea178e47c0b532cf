# SPDX-License-Identifier: MIT
"""Commands that send one thing and end: `stop`, `output`, `relocalize`."""

from __future__ import annotations

import argparse
import math
import time
from typing import TYPE_CHECKING

from roburoc4 import DifferentialStatus
from roburoc4.latest import latest

from .. import session
from ..errors import ExitCode, refused
from ..options import Options, add_robot, angle, metres
from ..output import note, print_json

if TYPE_CHECKING:
    from roburoc4 import Facts, Robot

_REST_S = 10.0
# A drive command from before the zeros may be repeated until its lease ends.
_LEASE_S = 1.0
_UNDRIVEN_S = 0.5
_POLL_S = 0.02
# An output is sent three times, about 50 ms apart: ending earlier would suppress the rest.
_SENT_S = 0.3


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the commands."""
    stop = commands.add_parser(
        "stop",
        help="stop the robot",
        description="Send zero speeds until the robot stops. Another program that drives it, or "
        "somebody at its game pad, continues: this is not an emergency stop.",
    )
    add_robot(stop)
    stop.set_defaults(run=run_stop)

    output = commands.add_parser(
        "output",
        help="switch a digital output",
        description="Switch digital output INDEX. A command carries all outputs, and none can be "
        "read back: it switches all others off.",
    )
    output.add_argument("index", metavar="INDEX", type=_index, help="1 or more; 0 is the robot's")
    output.add_argument("state", metavar="on|off", choices=("on", "off"))
    add_robot(output)
    output.set_defaults(run=run_output)

    relocalize = commands.add_parser(
        "relocalize",
        help="set the robot's pose",
        description="Set the robot's pose in the main (odometry) frame; odometry continues from "
        "there.",
    )
    relocalize.add_argument("x", metavar="X", type=metres, help="metres")
    relocalize.add_argument("y", metavar="Y", type=metres, help="metres")
    relocalize.add_argument("theta", metavar="THETA", type=angle, help="radians, or as in 90deg")
    add_robot(relocalize)
    relocalize.set_defaults(run=run_relocalize)


def _index(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(
            f"'{text.strip()}' is not the number of an output: give 1 or more (0 is the robot's "
            "own watchdog)"
        )
    return int(text)


def run_stop(options: Options) -> int:
    """Stop."""
    from roburoc4 import StopOutcome

    with session.connected(options) as robot:
        if robot.properties.differential is None:
            raise refused(f"{robot.address} has no differential service to stop: see roburoc4 info")
        _stop(robot)
        outcome = robot.facts.stop_outcome
        if outcome is StopOutcome.OVERRIDDEN:
            raise refused(
                f"{robot.address} ignores zeros while somebody holds [A] on its game pad: press an "
                "emergency stop if it moves, and stop it again when [A] is released"
            )
        confirmed = outcome is StopOutcome.CONFIRMED
        _done(
            options,
            f"{robot.address} has stopped"
            if confirmed
            else f"{robot.address} was sent zeros, but did not confirm them: watch it",
            {
                "robot": robot.address,
                "stopped": True if confirmed else None,
                "outcome": outcome.name.lower(),
            },
        )
    return ExitCode.FINE


def _stop(robot: Robot) -> None:
    """Send zeros until the robot is at rest; refused if another program drives it."""
    begun_s = now_s = time.monotonic()
    driven_s, cycles, other = -math.inf, -1, False
    robot.stop()
    while now_s < begun_s + _REST_S:
        time.sleep(_POLL_S)
        now_s = time.monotonic()
        facts, speeds = robot.facts, latest(robot, DifferentialStatus)
        if speeds is not None and speeds.robot_cycles != cycles and _has_target(speeds):
            driven_s, cycles = now_s, speeds.robot_cycles
            if now_s > begun_s + _LEASE_S and not (other or facts.overridden):
                other = True
                note(
                    f"another program drives {robot.address} in spite of the zeros: end it, hold "
                    "[A] on the game pad, or press an emergency stop"
                )
        if facts.stopping:
            continue
        if session.is_at_rest(speeds) and now_s > driven_s + _UNDRIVEN_S:
            break
        robot.stop()
    else:
        session.refuse_loss(robot, robot.address, "check the robot; press an emergency stop")
        raise refused(
            f"zeros were sent for {_REST_S:g} s, but {robot.address} still moves: "
            f"{_driver(other, facts)} drives it; press an emergency stop"
        )
    if other:
        raise refused(
            f"{robot.address} has stopped, but another program drove it in spite of the zeros: end "
            "that program, else it may drive again"
        )


def _has_target(speeds: DifferentialStatus) -> bool:
    return speeds.target_linear_m_s != 0.0 or speeds.target_angular_rad_s != 0.0


def _driver(other: bool, facts: Facts) -> str:
    if facts.overridden:
        return "its game pad"
    return "another program" if other else "another program or its game pad"


def run_output(options: Options) -> int:
    """Switch an output."""
    from roburoc4 import RobotError

    on = options.state == "on"
    with session.connected(options) as robot:
        try:
            robot.digital_outputs[options.index] = on
        except RobotError as error:
            raise refused(f"output {options.index}: {error}") from None
        time.sleep(_SENT_S)
        _done(
            options,
            f"output {options.index} of {robot.address} is {options.state}",
            {"robot": robot.address, "output": options.index, "on": on},
        )
    return ExitCode.FINE


def run_relocalize(options: Options) -> int:
    """Set the robot's pose."""
    pose = {"x_m": options.x, "y_m": options.y, "theta_rad": options.theta}
    with session.connected(options) as robot:
        robot.relocalize(options.x, options.y, options.theta)
        _done(
            options,
            f"{robot.address} is at x {options.x:g} m, y {options.y:g} m, "
            f"theta {options.theta:g} rad",
            {"robot": robot.address, **pose},
        )
    return ExitCode.FINE


def _done(options: Options, text: str, document: dict[str, object]) -> None:
    if options.json:
        print_json(document)
    else:
        print(text)
