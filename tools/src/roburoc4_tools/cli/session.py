# SPDX-License-Identifier: MIT
"""A connection for the duration of a command, and the questions before the robot moves."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roburoc4 import DifferentialStatus
from roburoc4.latest import latest
from roburoc4.protocol import MAX_DRIVE_M_S, MAX_DRIVE_RAD_S

from ..terminal.signals import Signalled, unsuspendable
from .errors import refused, unreachable, usage
from .options import Options
from .output import note

if TYPE_CHECKING:
    from roburoc4 import Robot

SILENCE_S = 5.0  # how long a robot may be silent before the command gives up
_FIRST_INPUTS_S, _LAST_INPUTS_S = 2.0, 10.0  # as long as it still describes them
_REST_S = 3.0
_POLL_S = 0.02
_STILL_M_S = 0.01
_STILL_RAD_S = 0.02
_CEILING_M_S, _CEILING_RAD_S = 1.0, 1.5
_NO_INPUT = 63  # the highest index of a digital input, where no RobuROC4 has its game pad


def add_robot_file(parser: argparse.ArgumentParser) -> None:
    """Add `--robot-file`."""
    parser.add_argument(
        "--robot-file",
        metavar="FILE",
        help="what roburoc4 first-contact or calibrate wrote for this robot",
    )


def add_driving(parser: argparse.ArgumentParser, *, with_file: bool = True) -> None:
    """Add `--robot-file`, `--allow-unknown-override` and `--yes`."""
    parser.set_defaults(robot_file=None)
    if with_file:
        add_robot_file(parser)
    parser.add_argument(
        "--allow-unknown-override",
        action="store_true",
        help="drive although the robot does not report whether its game pad is in use; all but "
        "teleop then need --clearance 0, too, as its bumpers are not known either",
    )
    parser.add_argument("--yes", "-y", action="store_true", help="do not ask before it moves")


def address_of(robot: str) -> str:
    """Resolve the text of `--robot` to a numeric address."""
    from roburoc4.protocol import resolve

    return resolve(robot)


@contextmanager
def connected(options: Options, **settings: Any) -> Iterator[Robot]:
    """Connect, and stop the robot however the block ends."""
    from roburoc4 import (
        ArgumentError,
        NetworkError,
        RecordingError,
        RobotTimeoutError,
        connect,
    )

    try:
        robot = connect(options.robot, timeout=SILENCE_S, **settings)
    except ArgumentError as error:
        raise usage(f"--robot: {error}") from None
    except RobotTimeoutError as error:
        raise unreachable(str(error)) from None
    except NetworkError as error:
        named = str(error) if options.robot in str(error) else f"{options.robot}: {error}"
        raise unreachable(f"{named}; run roburoc4 doctor for details") from None
    except RecordingError as error:
        raise refused(str(error)) from None
    with robot:
        yield robot


def recording() -> dict[str, Any]:
    """Return the setting that records a drive if ROBUROC4_RECORD names a folder."""
    folder = os.environ.get("ROBUROC4_RECORD")
    if not folder:
        return {}
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise refused(
            f"ROBUROC4_RECORD: {folder} is not a usable folder: {error.strerror}"
        ) from None
    return {"record": folder}


def note_recording(robot: Robot) -> None:
    """Report where the datagrams are recorded."""
    if robot.recorder is not None:
        note(f"recording to {robot.recorder.path}")


@contextmanager
def driven(
    options: Options, speeds: tuple[float, float] = (0.0, 0.0), **more: float
) -> Iterator[Robot]:
    """Connect to a robot that may be driven this fast: its game pad is known to be released."""
    known = _known(options)
    settings: dict[str, Any] = {**_ceilings(*speeds, known), **recording(), **more}
    if known:
        settings["robot_file"] = options.robot_file
    with unsuspendable(), connected(options, **settings) as robot:
        note_recording(robot)
        if _has_inputs(robot):
            refuse_override(robot)
            yield robot
            return
        if not options.allow_unknown_override:
            raise refused(
                "the robot does not report its inputs, so it is not known whether its game pad is "
                "in use: run roburoc4 doctor, or drive anyway with --allow-unknown-override"
            )
    note("driving without knowing the game pad's state: keep an emergency stop in your hand")
    blind = {"allow_unknown_override": True, "override_index": _NO_INPUT}
    with unsuspendable(), connected(options, **settings, **blind) as robot:
        note_recording(robot)
        yield robot


def _known(options: Options) -> dict[str, float]:
    """Return the numbers of the robot file, if there is one."""
    from roburoc4 import ArgumentError, robot_file

    if not options.robot_file:
        return {}
    try:
        return robot_file.load(options.robot_file)
    except ArgumentError as error:
        raise usage(f"--robot-file: {error}") from None


def _ceilings(linear_m_s: float, angular_rad_s: float, known: dict[str, float]) -> dict[str, float]:
    """Raise the default ceilings to the speeds that a user asked for, scaled or not."""
    rounding = 1.0 + 1e-6  # the client computes with floats
    linear_m_s = abs(linear_m_s) * max(1.0, known.get("scale_linear", 1.0) * rounding)
    angular_rad_s = abs(angular_rad_s) * max(1.0, known.get("scale_angular", 1.0) * rounding)
    return {
        "max_linear_m_s": min(max(_CEILING_M_S, linear_m_s), MAX_DRIVE_M_S),
        "max_angular_rad_s": min(max(_CEILING_RAD_S, angular_rad_s), MAX_DRIVE_RAD_S),
    }


def _has_inputs(robot: Robot) -> bool:
    begun_s = time.monotonic()
    while (facts := robot.facts).overridden is None:
        longest_s = _FIRST_INPUTS_S if facts.descriptions_done else _LAST_INPUTS_S
        if time.monotonic() - begun_s >= longest_s:
            return False
        time.sleep(_POLL_S)
    return True


def refuse_override(robot: Robot) -> None:
    """End the command if somebody drives with the game pad."""
    if robot.facts.overridden:
        raise refused(
            "somebody holds [A] on the game pad and drives the robot: no speed was sent; wait "
            "until it is released, then start again"
        )


def refuse_loss(robot: Robot, name: str, remedy: str) -> None:
    """End the command if the robot fell silent and is still not back."""
    if robot.state.name != "READY":
        raise refused(f"{name} fell silent and did not come back: {remedy}")


def name_of(robot: Robot, options: Options) -> str:
    """Name the robot as the user did, and its address."""
    if options.robot in (robot.address, robot.address.rpartition(":")[0]):
        return f"the robot at {robot.address}"
    return f"the robot '{options.robot}' at {robot.address}"


def confirm(robot: Robot, options: Options, intention: str) -> None:
    """Ask a person at the terminal once; not without a terminal, or with --yes."""
    if options.yes or not sys.stdin.isatty():
        return
    print(
        f"Drive {name_of(robot, options)} (140 kg) {intention}. Is the way clear? [y/N] ",
        end="",
        file=sys.stderr,
        flush=True,
    )
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise usage("not confirmed: no speed was sent; answer y, or give --yes")


def wait_for_rest(robot: Robot, patience_s: float) -> bool:
    """Wait until the robot has confirmed a stop and reports wheels at rest."""
    from roburoc4 import StopOutcome

    until_s = time.monotonic() + patience_s
    while time.monotonic() < until_s:
        confirmed = robot.facts.stop_outcome is StopOutcome.CONFIRMED
        if confirmed and is_at_rest(latest(robot, DifferentialStatus)):
            return True
        time.sleep(_POLL_S)
    return False


@contextmanager
def armed(robot: Robot) -> Iterator[None]:
    """Arm for the block, and stop the robot however it ends."""
    from roburoc4 import NotArmedError

    robot.arm()
    try:
        yield
    except Signalled:
        robot.stop()
        at_rest = wait_for_rest(robot, _REST_S)
        with suppress(OSError):  # the terminal may be gone
            note(
                "interrupted: the robot has stopped"
                if at_rest
                else "interrupted: a stop was sent, but the robot may still be moving: watch it, "
                "and press an emergency stop if it does"
            )
        raise
    except NotArmedError:
        if robot.facts.overridden:
            raise refused(
                "somebody took the robot over with [A] on the game pad, and the drive ended: wait "
                "until it is released, then start again"
            ) from None
        raise
    finally:
        robot.stop()


def is_at_rest(speeds: DifferentialStatus | None) -> bool:
    """Whether targets are zero and the wheels stand; True for a robot that reports no speeds."""
    if speeds is None:
        return True
    return (
        speeds.target_linear_m_s == speeds.target_angular_rad_s == 0.0
        and abs(speeds.current_linear_m_s) < _STILL_M_S
        and abs(speeds.current_angular_rad_s) < _STILL_RAD_S
    )
