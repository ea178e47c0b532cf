# SPDX-License-Identifier: MIT
"""`roburoc4 doctor`: checks the link to the robot step by step, and names what to fix first."""

from __future__ import annotations

import argparse
import time
from dataclasses import asdict
from typing import TYPE_CHECKING

from .. import session
from ..options import Options, add_robot, add_seconds
from ..output import print_json
from ..progress import Show, progress
from . import lcm_doctor
from .probe import Probe, other_source
from .verdict import REPEATED_SHARE, Findings, Stream, Verdict, judge

if TYPE_CHECKING:
    from collections.abc import Callable

    from roburoc4 import Robot

    Say = Callable[[str, str, str], None]

_WATCH_S = 5.0
_ASK_EVERY_S = 0.2
_LISTEN_S = 1.0
_POLL_S = 0.05
_FIRST_CONTACT_TRIES = 8
_FIRST_CONTACT_S = 0.5
_SERVICES = ("iocard", "telemeter", "battery", "localization", "differential")
_PERIODS_MS: dict[str, int | None] = {
    "iocard": 50,
    "telemeter": 100,
    "battery": 1000,
    "localization": 50,
    "differential": 50,
}
_LOW = "the battery is low: charge it"


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "doctor",
        help="check the link to the robot, and name what to fix",
        description="Check name, route, port, silence, discovery, and each subscription's rate, "
        "loss and jitter. Ends in one verdict with a number (docs/cli.md lists them). Nothing is "
        "commanded.",
    )
    parser.add_argument(
        "--lcm",
        metavar="URL",
        nargs="?",
        const="",
        help="check the way to roburoc4-lcm instead (default: $LCM_DEFAULT_URL, else LCM's own)",
    )
    add_seconds(parser, f"how long to watch the statuses (default {_WATCH_S:g})")
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Check, and report."""
    if options.lcm is not None:
        return lcm_doctor.run(options.lcm, as_json=options.json)
    say = _silent if options.json else _say
    found = Findings(options.robot)
    if _resolve(found, say):
        host, _, port = found.address.rpartition(":")
        with Probe((host.strip("[]"), int(port))) as probe:
            if _contact(found, probe, say):
                _watch(found, options, probe, say)
    verdict = judge(found)
    if options.json:
        print_json(_document(found, verdict))
    else:
        _print_streams(found)
        _print_verdict(verdict)
    return verdict.code


class _Mark:
    OK = "ok  "
    BAD = "BAD "
    NOTE = "note"


def _say(mark: str, check: str, text: str) -> None:
    print(f"{mark}  {check:<10} {text}", flush=True)


def _silent(mark: str, check: str, text: str) -> None:
    del mark, check, text


# ----------------------------------------------------------------------------------- the checks


def _resolve(found: Findings, say: Say) -> bool:
    from roburoc4 import ArgumentError, NetworkError

    from ..errors import usage

    try:
        found.address = session.address_of(found.robot)
    except ArgumentError as error:
        raise usage(f"--robot: {error}") from None
    except NetworkError:
        found.fault, found.fault_detail = "name", "unknown to this computer's name service"
        say(_Mark.BAD, "name", f"{found.robot} is unknown")
        return False
    say(_Mark.OK, "name", found.address)
    return True


def _contact(found: Findings, probe: Probe, say: Say) -> bool:
    for _ in range(_FIRST_CONTACT_TRIES):
        probe.ask()
        probe.listen(_FIRST_CONTACT_S, until_answered=True)
        if probe.fault or probe.answered >= _FIRST_CONTACT_TRIES // 2:
            break
    _note_probe(found, probe)
    if probe.answered:
        say(_Mark.OK, "answer", f"{found.answered} of {found.asked} requests")
        return True
    found.fault = probe.fault or ("refused" if probe.refused else "silence")
    found.fault_detail = probe.fault_detail
    texts = {
        "route": f"none: {found.fault_detail}",
        "denied": f"not allowed: {found.fault_detail}",
        "refused": "refused: nothing listens there",
        "silence": f"0 of {found.asked} requests",
    }
    check = "route" if probe.fault else "answer"
    say(_Mark.BAD, check, texts[found.fault])
    return False


def _note_probe(found: Findings, probe: Probe) -> None:
    found.asked, found.answered, found.malformed = probe.asked, probe.answered, probe.malformed
    found.altered, found.round_trip_ms = probe.altered, probe.round_trip_ms


def _watch(found: Findings, options: Options, probe: Probe, say: Say) -> None:
    from ..errors import CommandError

    try:
        with session.connected(options, period_ms=_PERIODS_MS) as robot:
            found.connected = True
            _check_services(found, robot, say)
            with progress("watching", options.seconds or _WATCH_S) as show:
                _measure(found, robot, probe, options.seconds or _WATCH_S, show)
            _look_elsewhere(found, robot, probe.address)
            _check_robot(found, robot, say)
    except CommandError as error:
        say(_Mark.BAD, "discovery", error.message)


def _missing(robot: Robot) -> list[str]:
    listed = {entry.service for entry in robot.properties.services}
    return [service for service in _SERVICES if service not in listed]


def _check_services(found: Findings, robot: Robot, say: Say) -> None:
    until_s = time.monotonic() + _LISTEN_S
    while _missing(robot) and time.monotonic() < until_s:
        time.sleep(_POLL_S)  # what one is may be asked a little later
    found.missing = _missing(robot)
    text = f"{len(robot.properties.services)} services"
    if found.missing:
        text += f", without {', '.join(found.missing)}"
    say(_Mark.BAD if found.missing else _Mark.OK, "discovery", text)


def _measure(found: Findings, robot: Robot, probe: Probe, length_s: float, show: Show) -> None:
    from roburoc4 import Count

    breaks = (Count.LOST, Count.REBOOTS)
    services = [service for service in _SERVICES if service not in found.missing]
    before = {service: robot.service_link(service) for service in services}
    breaks_before = sum(robot.counts[count] for count in breaks)
    begun_s = time.monotonic()
    while (elapsed_s := time.monotonic() - begun_s) < length_s:
        show(elapsed_s, "watching the statuses")
        probe.ask()
        probe.listen(_ASK_EVERY_S)
    found.watched_s = elapsed_s
    _note_probe(found, probe)
    _count(found, robot)
    found.interruptions = sum(robot.counts[count] for count in breaks) - breaks_before
    for service in services:
        after, old = robot.service_link(service), before[service]
        found.streams.append(
            Stream(
                service,
                1e3 / (_PERIODS_MS[service] or 1),
                after.received - old.received,
                max(0, after.lost - old.lost),
                1e6 / after.period_us if after.period_us else 0.0,
                after.jitter_us / 1e3,
            )
        )


def _count(found: Findings, robot: Robot) -> None:
    from roburoc4 import Count

    counts = robot.counts
    found.received, found.repeated = counts[Count.RECEIVED], counts[Count.OLD]
    found.damaged = counts[Count.SHORT] + counts[Count.MALFORMED]


def _look_elsewhere(found: Findings, robot: Robot, address: tuple[str, int]) -> None:
    """Where statuses are missing, find out whether another port sends them."""
    found.refused = [
        stream.service
        for stream in found.streams
        if not robot.service_link(stream.service).subscribed
    ]
    mute = {s.service for s in found.streams if s.received == 0 and s.service not in found.refused}
    ids = [entry.id for entry in robot.properties.services if entry.service in mute]
    if ids:
        found.other_source = other_source(address, ids[0], _LISTEN_S)


def _check_robot(found: Findings, robot: Robot, say: Say) -> None:
    from roburoc4 import Result

    facts = robot.facts
    notes = {
        "somebody drives with the game pad": facts.overridden,
        "the robot does not report its game pad: it cannot be driven": facts.overridden is None,
        "it is not known whether a bumper is pressed": None
        in (facts.front_bumper, facts.rear_bumper),
        "another client commands the robot": facts.other_commander,
        f"{found.repeated} of {found.received} datagrams were repeated on their way, or overtaken: "
        "look for a loop in the network": found.repeated > REPEATED_SHARE * found.received,
        "its speed limits are not usable: it cannot be driven": facts.arm_refusal == Result.LIMITS,
        "the front bumper is pressed": facts.front_bumper,
        "the rear bumper is pressed": facts.rear_bumper,
        _LOW: facts.battery_low,
    }
    found.notes = [text for text, is_so in notes.items() if is_so]
    for text in found.notes:
        say(_Mark.NOTE, "robot", text)


# ---------------------------------------------------------------------------------- the results


def _document(found: Findings, verdict: Verdict) -> dict[str, object]:
    return {
        **asdict(found),
        "loss": found.loss,
        "streams": [{**asdict(stream), "loss": stream.loss} for stream in found.streams],
        "verdict": asdict(verdict),
    }


def _print_streams(found: Findings) -> None:
    if not found.streams:
        return
    print(f"\n{'service':<12}{'rate':>7}{'asked':>7}{'loss':>6}{'jitter':>8}")  # 40 columns
    for stream in found.streams:
        print(
            f"{stream.service:<12}{stream.rate_hz:>5.1f}/s{stream.asked_hz:>5.1f}/s"
            f"{stream.loss:>6.1%}{stream.jitter_ms:>5.1f} ms"
        )
    print(f"round trip {found.round_trip_ms:.1f} ms, {found.answered} of {found.asked} answered")


def _print_verdict(verdict: Verdict) -> None:
    print(f"\nverdict {verdict.number}, {verdict.name}: {verdict.sentence}")
    print(f"next: {verdict.remedy}")
