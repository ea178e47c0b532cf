# SPDX-License-Identifier: MIT
"""`roburoc4 first-contact FOLDER`: half an hour that makes a robot known."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ...terminal.signals import Signalled, unsuspendable
from .. import session
from ..errors import ExitCode, refused, unwritable, usage
from ..options import DEFAULT_ROBOT, Options, add_robot
from ..output import note

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from roburoc4 import Robot

    from ...first_contact.contact import Contact
    from ...first_contact.terminal import TerminalWorld

_STATE, _FILE = "contact.json", "robot.txt"
_CHECKLIST = (
    "Two people: one here, one at the robot with the remote emergency stop in hand.",
    "No people, animals, stairs, edges or cables near the robot; the charger is unplugged.",
    "Main switch on, battery not nearly empty, brakes selector on Automatic, both stops released.",
    "The remote's green button, then the green button of the panel; the game pad is on.",
    "Nobody else's program talks to the robot.",
)
_LIFT_DOWN = (
    "Robot on the ground, 5 m free all around. It will move 1 m, turn left by 90 degrees, and stop "
    "from 0.3 and 0.6 m/s. If not: emergency stop."
)
_LIBRARY_SUBSCRIPTIONS = 12
"""Room for those of the library that stay, and for those of the steps."""


class ContactOptions(Options):
    """Options of this command."""

    folder: Path
    again: str | None


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "first-contact",
        help="find out, with two people, what a robot answers where its manual is silent",
        description="Ask, watch and measure step by step, first with the wheels off the ground, "
        "and write a robot file for the option --robot-file, a page, and a recording without "
        "addresses. Nothing moves unless the space bar is held. Interrupted, it goes on where it "
        "was. docs/first-contact.md describes each step.",
    )
    parser.add_argument("folder", metavar="FOLDER", type=Path, help="where the results are kept")
    parser.add_argument("--again", metavar="STEP", help="repeat a step that was done, by its name")
    add_robot(parser)
    parser.set_defaults(run=_run)


def _run(options: ContactOptions) -> int:
    from roburoc4.protocol import resolve

    from ...first_contact import bundle
    from ...first_contact.contact import STEPS, Contact
    from ...first_contact.terminal import TerminalWorld
    from ...first_contact.wheels import LIFTED_BY
    from ...terminal.keyboard import Keyboard

    if not sys.stdin.isatty():
        raise usage("first-contact needs a terminal: people answer, and hold a key")
    try:
        options.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(options.folder, error) from None
    name = bundle.free_name(options.folder)
    host, _, port = resolve(options.robot or DEFAULT_ROBOT).rpartition(":")
    with unsuspendable(), Keyboard() as keyboard:
        world = TerminalWorld(host, int(port), keyboard)
        contact = Contact(world)
        _resume(contact, options, world)
        try:
            for number, step in enumerate(contact.steps(), len(contact.done) + 1):
                _keep(contact, options.folder, name)  # a killed one goes on from here, too
                title = f"Step {number} of {len(STEPS)}, {step.name}."
                if step.name == LIFTED_BY and not _is_worth_lifting(contact, options, world):
                    break
                world.say(f"\n{title} {step.moves or 'Nothing moves.'}")
        except (KeyboardInterrupt, Signalled):
            _note_interrupted()
            raise
        finally:
            contact.session.leave()
            _keep(contact, options.folder, name)
        if contact.refused is None:
            _ground(contact, options, world, name)
    if contact.refused is not None:
        raise refused(f"{contact.refused} (all answers: {options.folder}/contact.html)")
    note(f"{options.folder / _FILE} is the robot file; send contact.zip to the project, please")
    return ExitCode.FINE


def _note_interrupted() -> None:
    note("interrupted: the same command goes on where this was")


def _resume(contact: Contact, options: ContactOptions, world: TerminalWorld) -> None:
    """Confirm the checklist, and go on where an earlier session was, if there was one."""
    state = options.folder / _STATE
    began = state.exists()
    if began:
        contact.resume(json.loads(state.read_text(encoding="utf-8")))
    if options.again is not None:
        if options.again not in contact.done:
            done = ", ".join(contact.done) or "none"
            raise usage(f"--again: {options.again!r} is no step that was done: {done}")
        contact.done.remove(options.again)
    for number, text in enumerate(_CHECKLIST, 1):
        world.please("checklist", f"{number} of {len(_CHECKLIST)}: {text}")
    if began:
        note(f"going on after {len(contact.done)} steps")
        contact.rejoin()


def _keep(contact: Contact, folder: Path, name: str) -> None:
    from ...first_contact import bundle

    (folder / _STATE).write_text(json.dumps(contact.state(name)), encoding="utf-8")
    if contact.session.known:
        save(folder / _FILE, contact.session.known)
    bundle.write(contact, folder, name, known_robots())


def save(path: Path, known: dict[str, float]) -> None:
    """Write the robot file, without what no robot file can hold."""
    from roburoc4 import robot_file

    robot_file.save(path, {n: v for n, v in known.items() if robot_file.can_hold(n, v)})


def known_robots() -> dict[str, dict[str, float]]:
    """Return what is known about the robots of docs/first-contact.md's table."""
    from roburoc4 import robot_file

    from ... import first_contact

    folder = Path(first_contact.__file__).parent / "known"
    return {path.stem: robot_file.load(path) for path in sorted(folder.glob("*.txt"))}


def _ground(contact: Contact, options: ContactOptions, world: TerminalWorld, name: str) -> None:
    from ...first_contact import bundle
    from ...first_contact.answers import sentence
    from ...first_contact.session import UnsafeError
    from ...recordings.capture import Capture

    def ask(text: str) -> str:
        answer = world.ask("measured", text)
        world.hold("Hold the space bar again.")
        return answer

    unscaled = {"scale_linear": 1.0, "scale_angular": 1.0}
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as private:  # with addresses, which the result has not
        settings = {"robot_file": options.folder / _FILE, "record": Path(private) / "drive.pcapng"}
        try:
            with session.connected(options, **settings, **unscaled) as robot:
                stand_armed(robot, world, contact.session.known, "Leave the robot on its stand.")
                world.please("ground", _LIFT_DOWN)
                drive_on_the_ground(robot, world, ask, found)
        except UnsafeError as reason:
            contact.refused = reason
        except (KeyboardInterrupt, Signalled):
            _note_interrupted()
            raise
        finally:
            for key, value in found.items():
                known = key.startswith("scale_")
                world.say(f"  {sentence(key, value) if known else f'{key}: {value:g}'}")
            scales = {key: value for key, value in found.items() if key.startswith("scale_")}
            contact.session.known |= scales
            contact.session.notes |= {k: v for k, v in found.items() if k not in scales}
            recorded = settings["record"]
            bundle.add_drive(contact.session, Capture(recorded) if recorded.exists() else ())
            _keep(contact, options.folder, name)


def _is_worth_lifting(contact: Contact, options: ContactOptions, world: TerminalWorld) -> bool:
    """Whether the library stays armed with this robot, or people want to lift it nevertheless."""
    from ...first_contact.session import UnsafeError

    s = contact.session
    if s.known.get("delete_refused") and s.most_subscriptions() < _LIBRARY_SUBSCRIPTIONS:
        return True  # those of the library would stay; whether it arms is found out on the stand
    for service in s.usable:
        s.unsubscribe(service)
    try:
        with session.connected(options, robot_file=options.folder / _FILE) as robot:
            stand_armed(robot, world, s.known, "Do not lift the robot yet.")
    except UnsafeError as reason:
        answer = world.ask(
            "lift_nevertheless",
            f"{reason} So it will not leave the stand. Lift and measure it nevertheless? yes or no",
        )
        if answer.lower() not in ("yes", "y"):
            contact.refused = reason
    s.pump(0.0)
    return contact.refused is None


def stand_armed(robot: Robot, world: TerminalWorld, known: Mapping[str, float], where: str) -> None:
    """Ask whether the library stays armed, before anybody lifts the robot."""
    from ...first_contact import ground

    world.say(
        f"\n{where} Does the library stay armed for {ground.STANDING_S:.0f} s? Nothing moves."
    )
    _until_done(robot, world, lambda: ground.stay_armed(robot, known), "")


def drive_on_the_ground(
    robot: Robot, world: TerminalWorld, ask: Callable[[str], str], found: dict[str, float]
) -> None:
    """Drive, and repeat what was not measured yet if the robot was stopped."""
    from ...first_contact import ground

    def drive() -> None:
        world.hold("Hold the space bar; the robot stops when it is let go.")
        robot.arm()
        ground.drive(robot, world.held, ask, found)

    _until_done(robot, world, drive, " Make sure that 5 m are free all around again.")


def _until_done(robot: Robot, world: TerminalWorld, deed: Callable[[], None], remedy: str) -> None:
    """Do it, and once more after what people can mend."""
    from roburoc4 import ClosedError, RobotError

    from ...first_contact.session import ReleasedError

    while True:
        try:
            deed()
        except ReleasedError:
            reason = "the key was let go"
        except ClosedError:
            raise
        except RobotError as error:
            reason = str(error)
        else:
            return
        robot.stop()
        world.please("again", f"Stopped: {reason}.{remedy} Get ready to repeat that.")
