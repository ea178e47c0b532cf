# SPDX-License-Identifier: MIT
"""The order of the steps: each can be interrupted, and is not repeated after it is done."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from . import identify, network, watch, wheels
from .answers import sentence
from .response import Response
from .session import LET_GO, MissedError, ReleasedError, Session, SilentError, UnsafeError
from .world import World


class Step(NamedTuple):
    """What is done, and what the person is told before it."""

    name: str
    moves: str
    """What moves, how far, and what to do if it does something else; "": nothing moves."""
    run: Callable[[Session], None]


_WHEELS = "In the air, the wheels turn {}. If they do not stop: emergency stop."

STEPS = (
    Step("directory", "", identify.directory),
    Step("network", "", network.network),
    Step("errors", "", identify.errors),
    Step("texts", "", identify.texts),
    Step("subscriptions", "", identify.subscriptions),
    Step("inputs", "", watch.inputs),
    Step("sticks", "", watch.sticks),
    Step("telemeters", "", watch.telemeters),
    Step("may be driven", "", wheels.may_be_driven),
    Step(
        "stops",
        _WHEELS.format("forward, backward, to the left and to the right, at up to 0.1 m/s"),
        wheels.stops,
    ),
    Step(
        "responses",
        _WHEELS.format("forward at up to 0.4 m/s, then in place at up to 0.8 rad/s"),
        wheels.responses,
    ),
    Step("reports", _WHEELS.format("with changing speeds for 40 s"), wheels.reports),
    Step("watchdog", _WHEELS.format("until the robot stops them by itself"), wheels.watchdog),
    Step("outage", _WHEELS.format("forward, at 0.1 m/s, until the cable is out"), network.outage),
    Step("pad", _WHEELS.format("while [A] is pressed and released"), wheels.pad),
    Step(
        "motors",
        "No motor power: the wheels must not turn. If they do: emergency stop.",
        wheels.motors,
    ),
    Step("power on", _WHEELS.format("forward, at 0.1 m/s, for 2 s"), wheels.power_on),
    Step(
        "odometry",
        _WHEELS.format("forward at up to 0.4 m/s, then in place at up to 0.8 rad/s, for 3 s each"),
        wheels.odometry,
    ),
    Step("may leave the stand", "", wheels.may_leave_the_stand),
)


class Contact:
    """A first contact, as far as it has come."""

    def __init__(self, world: World) -> None:
        self.session = Session(world)
        self.done: list[str] = []
        self.refused: UnsafeError | None = None

    def state(self, recording: str = "") -> dict[str, Any]:
        """Return what resume() needs, as JSON can hold it."""
        s = self.session
        proofs = {
            name: f"{recording}: {first + 1} to {end}" for name, (first, end) in s.proof.items()
        }
        return {
            "done": self.done,
            "known": s.known,
            "proofs": s.earlier | proofs,
            "ids": s.ids,
            "restarts": s.restarts,
            "fixed": s.fixed,
            "usable": s.usable,
            "notes": s.notes,
            "watched": s.watched,
            "traces": s.traces,
            "responses": {str(axis): list(found) for axis, found in s.responses.items()},
        }

    def resume(self, state: dict[str, Any]) -> None:
        """Go on where an interrupted contact was."""
        s = self.session
        self.done = list(state["done"])
        s.known, s.ids, s.fixed = dict(state["known"]), dict(state["ids"]), state["fixed"]
        s.usable, s.notes = list(state["usable"]), dict(state["notes"])
        s.watched, s.traces = list(state["watched"]), dict(state["traces"])
        s.earlier = dict(state.get("proofs", {}))
        s.restarts = state.get("restarts", 0)
        s.responses = {int(axis): Response(*found) for axis, found in state["responses"].items()}

    def rejoin(self) -> None:
        """Bring the robot to where the next step may begin, whoever had it meanwhile."""
        s = self.session
        restarts_left = int(wheels.RESTARTED_BY not in self.done)
        identify.restart(s, "The robot may still report to the interrupted session.", restarts_left)
        if all(step.name in self.done for step in STEPS):
            s.please("motors_on", "Press the green button: after a restart the motors may need it.")
        elif wheels.LIFTED_BY in self.done:
            wheels.lift(s)
        if "iocard" in s.usable:
            network.hear_clock(s)

    def steps(self) -> Iterable[Step]:
        """Yield each step that is left, before it runs; ends early where one refuses to go on."""
        for step in STEPS:
            if step.name in self.done:
                continue
            yield step
            before = dict(self.session.known)
            is_done = self._run(step)
            for name, value in self.session.known.items():
                if before.get(name) != value:
                    self.session.world.say(f"  {sentence(name, value)}")
            if not is_done:
                return
            self.done.append(step.name)

    def _run(self, step: Step) -> bool:
        s = self.session
        while True:
            try:
                step.run(s)
            except ReleasedError:
                s.world.please("again", LET_GO)
            except MissedError as missed:
                s.please("missed", f"{missed} Get ready to repeat that.")
            except SilentError:
                s.please("silent", "The robot was not heard: check its power and the cable.")
            except UnsafeError as refused:
                self.refused = refused
                return False
            else:
                return True
