# SPDX-License-Identifier: MIT
"""A robot's current state as messages: bumpers, inhibition, and a diagnosis."""

import contextlib
import importlib.metadata

from roburoc4 import __version__
from roburoc4.constants import BatteryState, Fault, State, StopOutcome
from roburoc4.latest import latest
from roburoc4.records import BatteryStatus, Facts
from roburoc4.robot import Robot

from .topics import Diagnosis, yes_or_no

_FINE, _WARNING, _ERROR = 0, 1, 2
_MUCH_LOSS = 0.05
_VERSIONS = {"roburoc4": __version__}
with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # not for recordings
    _VERSIONS["cyclonedds"] = importlib.metadata.version("cyclonedds")
_UNCONFIRMED = (StopOutcome.TIMED_OUT, StopOutcome.OVERRIDDEN)


def conditions(robot: Robot) -> dict[str, bool]:
    """Return bumpers and inhibition, by topic; without bumpers that are not known."""
    facts = robot.facts
    found = {
        "inhibited": facts.inhibited,
        "bumpers/front": facts.front_bumper,
        "bumpers/rear": facts.rear_bumper,
    }
    return {topic: fact for topic, fact in found.items() if fact is not None}


def diagnoses(robot: Robot, node: str, *, watches: bool = False) -> list[Diagnosis]:
    """Return a robot's entry in /diagnostics.

    For who only ``watches``, it is no fault that another client commands.
    """
    found = [_link(robot), _driving(robot, watches=watches), _battery(robot)]
    found.append(Diagnosis(_FINE, "versions", __version__, _VERSIONS))
    return [one._replace(name=f"{node}: {one.name}") for one in found]


def _link(robot: Robot) -> Diagnosis:
    link, state, fault, facts = robot.link, robot.state, robot.fault, robot.facts
    level, text = _ERROR, "no answer yet: run roburoc4 doctor"
    if state is State.READY:
        level, text = _FINE, "connected"
        if link.loss > _MUCH_LOSS:
            level, text = _WARNING, f"{link.loss:.0%} of the statuses do not arrive"
    elif state is State.LOST:
        text = "the robot fell silent: check power and cable"
    values = {
        "state": state.name.lower(),
        "address": robot.address,
        "round_trip_ms": f"{link.round_trip_us / 1000:.1f}",
        "silence_ms": f"{link.silence_us / 1000:.0f}",
        "received": str(link.received),
        "lost": str(link.lost),
        "loss": f"{link.loss:.3f}",
        "missing": " ".join(service.name.lower() for service in facts.missing),
        "network": "fine" if fault is Fault.NONE else fault.text,
    }
    return Diagnosis(level, "link", text, values)


def _driving(robot: Robot, *, watches: bool) -> Diagnosis:
    facts = robot.facts
    level, text = _FINE, "armed" if facts.armed else "not armed"
    if facts.inhibited:
        level, text = _WARNING, "the robot does not follow its commands"
    elif facts.other_commander:
        level = _FINE if watches else _WARNING
        text = "another client commands the robot"
    elif facts.overridden:
        level, text = _WARNING, "somebody drives with the game pad"
    elif facts.stop_outcome in _UNCONFIRMED and not facts.armed:
        level, text = _WARNING, "the robot did not confirm the stop: watch it"
    values = {
        "armed": yes_or_no(facts.armed),
        "disarm_cause": "" if facts.armed else facts.disarm_cause.text,
        "arming": "possible" if not facts.arm_refusal else facts.arm_refusal.text,
        "overridden": _overridden(facts),
        "other_commander": yes_or_no(facts.other_commander),
        "inhibited": yes_or_no(facts.inhibited),
        "stop_outcome": facts.stop_outcome.name.lower(),
        "linear_m_s": f"{facts.sent_linear_m_s:.3f}",
        "angular_rad_s": f"{facts.sent_angular_rad_s:.3f}",
    }
    return Diagnosis(level, "driving", text, values)


def _overridden(facts: Facts) -> str:
    return "unknown" if facts.overridden is None else yes_or_no(facts.overridden)


def _battery(robot: Robot) -> Diagnosis:
    status = latest(robot, BatteryStatus)
    if status is None:
        return Diagnosis(_WARNING, "battery", "not reported yet", {})
    level = _WARNING if robot.facts.battery_low else _FINE
    if status.state == BatteryState.CRITICAL:
        level = _ERROR
    text = f"{status.remaining_percent} %, {status.state_name}"
    values = {"remaining_percent": str(status.remaining_percent), "state": status.state_name}
    return Diagnosis(level, "battery", text, values)
