# SPDX-License-Identifier: MIT
"""What is wrong with the link, why the robot is not armed, and what to try."""

from __future__ import annotations

from typing import NamedTuple

from roburoc4.constants import Fault, Result, State
from roburoc4.records import Link

LOSS_SHARE = 0.02
ROUND_TRIP_MS = 50.0
STALE_MS = 300.0
_SILENT_MS = 1000.0


class Advice(NamedTuple):
    """The quality of the link."""

    level: str
    """good, weak or bad."""
    say: str
    attempt: str
    """What to try; empty if nothing is wrong."""


_FAULTS = {
    Fault.REFUSED: "check that the robot's UDP server is running and that the port is right",
    Fault.UNREACHABLE: "give this computer an address of the robot's network (192.168.0.10/24)",
    Fault.DOWN: "plug in the network cable, switch the network on",
    Fault.DENIED: "let this program through the firewall",
}
_CABLE = "check the robot's main power, the cable and the switches between"


def advise(
    state: State, fault: Fault, link: Link, heard: int, address: str, age_ms: float
) -> Advice:
    """Judge the link; ``age_ms`` is the age of the oldest status that is overdue, else 0."""
    if state is not State.READY:
        return _without_link(state, fault, link, heard, address)
    if fault is not Fault.NONE:
        return Advice("bad", fault.text, _FAULTS.get(fault, _CABLE))
    if age_ms > STALE_MS:
        return Advice("bad", "statuses come too late", _CABLE)
    if link.loss > LOSS_SHARE:
        return Advice(
            "weak",
            f"{link.loss:.0%} of the statuses are lost",
            "use a cable instead of radio, end other heavy traffic, check the plugs",
        )
    if link.round_trip_us > ROUND_TRIP_MS * 1000:
        return Advice(
            "weak",
            f"answers take {link.round_trip_us / 1000:.0f} ms",
            "use a cable instead of radio; do not drive through a network that buffers",
        )
    return Advice("good", "link good", "")


def _without_link(state: State, fault: Fault, link: Link, heard: int, address: str) -> Advice:
    if fault is not Fault.NONE:
        text = fault.text
        return Advice("bad", f"{address}: {text}", _FAULTS.get(fault, _CABLE))
    if state is State.LOST or (heard and link.silence_us > _SILENT_MS * 1000):
        return Advice(
            "bad",
            "the robot fell silent; the dashboard keeps asking it",
            _CABLE,
        )
    if not heard:
        return Advice(
            "bad",
            f"no answer from {address} yet",
            "switch the robot on, plug in the cable, give this computer an address of the "
            "robot's network (192.168.0.10/24), let UDP through the firewall",
        )
    return Advice("weak", f"{state.name.lower()}: the robot answers", "wait a moment")


_PAST = {
    Result.OVERRIDE: "somebody held [A] on the robot's game pad",
    Result.INHIBITED: "the robot did not follow its commands: check emergency stops, brakes "
    "selector and bumpers, then arm again",
    Result.STOP_CALLED: "the robot was stopped",
    Result.LAPSED: "inputs came too late, so the robot was stopped",
    Result.LOST: "the robot was lost",
    Result.REBOOT: "the robot restarted",
    Result.OTHER_COMMANDER: "another program commanded the robot",
    Result.MOVING: "the robot moved without a command from here",
    Result.OVERRIDE_UNKNOWN: "it was not known whether the robot's game pad was in use",
}


def why_disarmed(code: int) -> str:
    """Return why it was disarmed, as something past: the reason may have gone meanwhile."""
    return _PAST.get(Result(code)) or f"it was disarmed: {why_not_armed(code).partition(':')[0]}"


def why_not_armed(code: int) -> str:
    """Return why the robot is not armed, and what to do; empty if nothing prevents arming."""
    if code in (Result.OK, Result.DISARMED):
        return ""
    if code == Result.STOP_CALLED:
        return "the robot was stopped"
    if code == Result.LAPSED:
        return "inputs came too late, so the robot was stopped: arm it again"
    if code == Result.MOVING:
        return "the robot moves, or has a target: wait until it is at rest, or stop it"
    if code == Result.OVERRIDE_UNKNOWN:
        return (
            "it is not known whether the robot's game pad is in use: run roburoc4 doctor, or start "
            "the dashboard with --allow-unknown-override"
        )
    return Result(code).text


def why_refused(code: int) -> str:
    """Return why it was not armed, for a while afterwards: nothing that was says what is."""
    if code == Result.MOVING:
        return "the robot moved, or had a target: arm it when it is at rest"
    return why_not_armed(code)
