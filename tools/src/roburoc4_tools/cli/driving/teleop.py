# SPDX-License-Identifier: MIT
"""`roburoc4 teleop`: drive with the keyboard; letting go stops."""

from __future__ import annotations

import argparse
import math
import signal
import sys
import time
from typing import TYPE_CHECKING

from roburoc4 import DifferentialStatus
from roburoc4.latest import latest

from ...terminal.deadman import DeadMan
from ...terminal.keyboard import Keyboard, is_ctrl_c
from ...terminal.signals import Signalled
from .. import session
from ..errors import ExitCode, usage, why_not_armed
from ..options import Options, add_robot
from ..output import console

if TYPE_CHECKING:
    from rich.console import RenderableType

    from roburoc4 import Robot

    from ...terminal.keyboard import Key

_STEP_S = 0.05
_GENTLE_LINEAR_M_S2 = 0.5
_GENTLE_ANGULAR_RAD_S2 = 1.0
_HELD_UP_S = 0.25  # by then the lease is over, and keys in the queue are old
_FULL_LINEAR_M_S = 1.0
_FULL_ANGULAR_RAD_S = 1.0
_SCALES = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0)
_FIRST_SCALE = 2

# Share of the full speeds: ahead, and to the left.
_MOTIONS = {
    "up": (1, 0),
    "down": (-1, 0),
    "left": (0, 1),
    "right": (0, -1),
    "w": (1, 0),
    "s": (-1, 0),
    "a": (0, 1),
    "d": (0, -1),
    "q": (1, 1),
    "e": (1, -1),
    "z": (-1, 1),
    "c": (-1, -1),
}
_HELP = """\
hold w s or up down   ahead, back         + -      faster, slower
hold a d or arrows    turn left, right    space    stop
hold q e z c          both at once        enter    drive again after space
                                          x        end"""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "teleop",
        help="drive with the keyboard",
        description="Drive with the keyboard of this terminal, up to 1 m/s and 1 rad/s. The robot\n"
        "moves while a key is held and stops when it is released.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    session.add_driving(parser)
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Drive until x is pressed."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise usage("teleop needs a terminal: run it in one, without pipes")
    if sys.platform == "win32":
        raise usage("teleop needs a POSIX terminal: use roburoc4 drive, or WSL")
    with session.driven(options) as robot:
        session.confirm(robot, options, "by keyboard")
        with Keyboard() as keyboard:
            try:
                _Teleop(robot, keyboard).loop()
            finally:
                robot.stop()
        session.refuse_loss(robot, options.robot, "check its power and cable")
    return ExitCode.FINE


class _Teleop:
    """Keys in, speeds out."""

    def __init__(self, robot: Robot, keyboard: Keyboard) -> None:
        self._robot = robot
        self._keyboard = keyboard
        self._man = DeadMan(keyboard.reports_releases)
        self._scale = _FIRST_SCALE
        self._speeds = (0.0, 0.0)
        self._ended = False
        self._stopped = False
        self._trouble = ""

    def loop(self) -> None:
        """Take keys and drive until the end."""
        from rich.live import Live

        with Live(console=console(), auto_refresh=False, transient=True) as live:
            last_s = time.monotonic()
            while not self._ended:
                keys = list(self._keyboard.keys(_STEP_S))
                now_s = time.monotonic()
                if now_s - last_s > _HELD_UP_S:
                    keys = self._forget(keys)
                    last_s = now_s
                for key in keys:
                    self._press(key, now_s)
                if now_s - last_s >= _STEP_S:
                    self._keyboard.ask_echo(now_s)
                    self._step(now_s, now_s - last_s)
                    live.update(self._picture(now_s), refresh=True)
                    last_s = now_s

    def _forget(self, keys: list[Key]) -> list[Key]:
        """Stop after the terminal froze, for example; keep only the keys that end and stop."""
        self._keyboard.forget()
        self._man.let_go()
        self._speeds = (0.0, 0.0)
        self._robot.pause()
        return [key for key in keys if is_ctrl_c(key) or key.name in ("x", " ")]

    def _press(self, key: Key, now_s: float) -> None:
        if is_ctrl_c(key):
            raise Signalled(signal.SIGINT)
        if key.name in _MOTIONS or key.action in ("blur", "echo"):
            self._man.feed(key, now_s)
        elif key.action == "release":
            return
        elif key.name == "x":
            self._ended = True
        elif key.name == " ":
            self._man.let_go()
            self._robot.stop()
            self._stopped = True
        elif key.name in ("\r", "\n"):
            self._stopped, self._trouble = False, ""
        elif key.name in ("+", "="):
            self._scale = min(self._scale + 1, len(_SCALES) - 1)
        elif key.name == "-":
            self._scale = max(self._scale - 1, 0)

    def _step(self, now_s: float, step_s: float) -> None:
        """Drive for one step, or arm again once all keys are released."""
        from roburoc4 import NotArmedError, Result

        facts = self._robot.facts
        if facts.disarm_cause is Result.INHIBITED:
            self._man.let_go()
            self._trouble = "the robot does not follow: check emergency stops, brakes and bumpers"
        wanted = self._wanted(now_s)
        if not facts.armed:
            self._speeds = (0.0, 0.0)
            if self._stopped:
                self._trouble = "stopped: press enter to drive again"
                return
            if wanted != (0.0, 0.0):
                return  # a key that was held while somebody else drove must be pressed again
            try:
                self._robot.arm(timeout=0.0)
            except NotArmedError as error:
                self._trouble = f"{why_not_armed(error)}; drive on when it is over"
                return
        if wanted != (0.0, 0.0):
            self._trouble = ""
        self._speeds = (
            _approach(self._speeds[0], wanted[0], _GENTLE_LINEAR_M_S2 * step_s),
            _approach(self._speeds[1], wanted[1], _GENTLE_ANGULAR_RAD_S2 * step_s),
        )
        try:
            if self._speeds != (0.0, 0.0):
                self._robot.drive(*self._speeds)
            elif self._robot.facts.driving:
                self._robot.pause()
        except NotArmedError as error:
            self._trouble = why_not_armed(error)

    def _wanted(self, now_s: float) -> tuple[float, float]:
        motions = [_MOTIONS[name] for name in self._man.held(now_s)]
        ahead = max(-1, min(1, sum(motion[0] for motion in motions)))
        left = max(-1, min(1, sum(motion[1] for motion in motions)))
        scale = _SCALES[self._scale]
        return ahead * scale * _FULL_LINEAR_M_S, left * scale * _FULL_ANGULAR_RAD_S

    def _picture(self, now_s: float) -> RenderableType:
        from rich.console import Group
        from rich.text import Text

        from ..watching.view import bar, lamps, speeds

        scale = _SCALES[self._scale]
        held = ", ".join(self._man.held(now_s)) or "none"
        how = "until let go" if self._keyboard.reports_releases else "while it repeats"
        measured = latest(self._robot, DifferentialStatus)
        return Group(
            Text(f"{self._robot.address}  {self._robot.state.name.lower()}", "bold"),
            lamps(self._robot.facts, console().width),
            Text.assemble(
                bar(scale, "cyan"),
                f"  {scale * _FULL_LINEAR_M_S:.1f} m/s  {scale * _FULL_ANGULAR_RAD_S:.1f} rad/s",
            ),
            Text(speeds(measured) if measured is not None else "no speeds reported"),
            Text(f"keys held ({how}): {held}"),
            Text(self._trouble, "bold red"),
            Text(_HELP, "dim"),
        )


def _approach(now: float, wanted: float, most: float) -> float:
    """Accelerate gently; slow down at once, and change direction through 0."""
    if now * wanted < 0.0:
        return 0.0
    if abs(wanted) <= abs(now):
        return wanted
    return math.copysign(min(abs(wanted), abs(now) + most), wanted)
