# SPDX-License-Identifier: MIT
"""What doctor found, and the resulting verdict: a number, a sentence, a remedy."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..errors import ExitCode

# Beyond these limits a robot still answers, but driving by its statuses is no longer sound.
LOSS_SHARE = 0.02
DAMAGED_SHARE = 0.005
REPEATED_SHARE = 0.02
ROUND_TRIP_MS = 50.0
JITTER_MS = 25.0
RATE_SHARE = 0.9
BY_CHANCE = 0.001


@dataclass
class Stream:
    """The statuses of one service while they were watched."""

    service: str
    asked_hz: float
    received: int = 0
    lost: int = 0
    rate_hz: float = 0.0
    jitter_ms: float = 0.0

    @property
    def loss(self) -> float:
        """Share of the statuses that were lost."""
        return self.lost / max(1, self.received + self.lost)


@dataclass
class Findings:
    """What was measured, in order. Later parts are empty if an earlier one failed.

    `fault`: "" or what keeps datagrams away: name, route, denied, refused, silence.
    """

    robot: str
    address: str = ""
    fault: str = ""
    fault_detail: str = ""
    asked: int = 0
    answered: int = 0
    malformed: int = 0  # answers that do not follow this protocol
    altered: int = 0  # answers that differ from others to the same request
    round_trip_ms: float = 0.0
    connected: bool = False
    missing: list[str] = field(default_factory=list)
    watched_s: float = 0.0
    streams: list[Stream] = field(default_factory=list)
    received: int = 0  # datagrams of the robot
    damaged: int = 0  # of them, too short or with invalid contents
    repeated: int = 0  # of them, not newer than the one before
    refused: list[str] = field(default_factory=list)  # services whose subscription was refused
    other_source: str | None = None  # where the statuses come from, if not from the address
    interruptions: int = 0  # losses of the link and reboots while it was watched
    notes: list[str] = field(default_factory=list)

    @property
    def loss(self) -> float:
        """Share of all statuses that were lost."""
        lost = sum(stream.lost for stream in self.streams)
        return lost / max(1, lost + sum(stream.received for stream in self.streams))


@dataclass(frozen=True)
class Verdict:
    """One of a numbered list, which docs/cli.md repeats."""

    number: int
    name: str
    code: ExitCode
    sentence: str
    remedy: str


def _contact(found: Findings) -> Verdict | None:
    gone = ExitCode.UNREACHABLE
    where = found.address or found.robot
    faults = {
        "name": Verdict(
            1,
            "name",
            gone,
            f"the name '{found.robot}' has no address ({found.fault_detail})",
            "give the robot's numeric address: --robot 192.168.0.2",
        ),
        "route": Verdict(
            2,
            "route",
            gone,
            f"this computer has no route to {where} ({found.fault_detail})",
            "plug in the cable and give this computer an address of the robot's network, "
            "such as 192.168.0.10/24",
        ),
        "denied": Verdict(
            3,
            "denied",
            gone,
            f"this computer forbids sending to {where} ({found.fault_detail})",
            "allow outgoing UDP to it in this computer's firewall, or correct the address",
        ),
        "refused": Verdict(
            4,
            "refused",
            gone,
            f"the host of {where} is there, but {found.asked} of {found.asked} requests were "
            "refused: nothing listens on this port",
            "check the port (60000 on a RobuROC4); if it is right, restart the robot",
        ),
        "silence": Verdict(
            5,
            "silence",
            gone,
            f"{found.asked} requests to {where}, 0 answers",
            "check that the robot is on and this is its address, then the firewalls between "
            "(UDP must pass both ways)",
        ),
    }
    return faults.get(found.fault)


def _discovery(found: Findings) -> Verdict | None:
    if not found.connected:
        return Verdict(
            6,
            "discovery",
            ExitCode.REFUSED,
            f"something answers at {found.address} ({found.answered} of {found.asked} requests, "
            f"{found.malformed} of them not understood), but its services cannot be found",
            "check that the address and port are the robot's; if they are, restart the robot",
        )
    # What else goes wrong then, such as a restart, may be damage, too.
    damaged, of = found.damaged, found.received
    if damaged <= DAMAGED_SHARE * of:
        damaged, of = found.altered, found.answered
    if damaged > DAMAGED_SHARE * of:
        return Verdict(
            14,
            "damaged",
            ExitCode.REFUSED,
            f"{damaged} of {of} datagrams arrive with damaged contents",
            "replace what changes datagrams between here and the robot: a tunnel, a converter, a "
            "faulty switch or network card",
        )
    if found.missing:
        names = ", ".join(found.missing)
        return Verdict(
            7,
            "service missing",
            ExitCode.REFUSED,
            f"{len(found.missing)} of 5 services are not in the robot's directory: {names}",
            "check the robot's configuration; what needs these services will not work",
        )
    return None


def _streams(found: Findings) -> Verdict | None:
    mute = [
        stream.service
        for stream in found.streams
        if stream.received == 0 and found.loss ** (stream.asked_hz * found.watched_s) < BY_CHANCE
    ]
    if found.other_source is not None:
        return _no_statuses(found, mute)
    if found.interruptions:
        return Verdict(
            8,
            "interrupted",
            ExitCode.REFUSED,
            f"the robot fell silent or restarted {found.interruptions} times in these seconds",
            "check its power supply and cable, and run doctor again",
        )
    if mute:
        return _no_statuses(found, mute)
    if found.loss > LOSS_SHARE:
        return Verdict(
            10,
            "loss",
            ExitCode.REFUSED,
            f"{found.loss:.0%} of the statuses do not arrive",
            "use the cable, or a radio link with less traffic nearer to the robot",
        )
    return _steadiness(found)


def _no_statuses(found: Findings, mute: list[str]) -> Verdict:
    sentence = f"{len(mute)} of {len(found.streams)} subscriptions bring nothing: {', '.join(mute)}"
    remedy = "end other programs that use the robot, restart it, and run doctor again"
    if found.refused:
        sentence += f"; the robot refused {', '.join(found.refused)}"
        remedy = f"its list of subscriptions may be full: {remedy}"
    if found.other_source is not None:
        sentence += f"; statuses come from {found.other_source} instead of {found.address}"
        remedy = "correct the robot's configuration, or the address translation between, so that "
        remedy += "statuses come from the port that answers"
    return Verdict(9, "no statuses", ExitCode.REFUSED, sentence, remedy)


def _steadiness(found: Findings) -> Verdict | None:
    unsteady = max(found.streams, key=lambda stream: stream.jitter_ms)
    if unsteady.jitter_ms > JITTER_MS:
        return Verdict(
            11,
            "jitter",
            ExitCode.REFUSED,
            f"statuses come {unsteady.jitter_ms:.0f} ms early or late (up to {JITTER_MS:.0f} is "
            f"fine), most of all those of {unsteady.service}",
            "use the cable; switch off the power saving of the radio link; check the load of "
            "this computer",
        )
    if found.round_trip_ms > ROUND_TRIP_MS:
        return Verdict(
            12,
            "slow",
            ExitCode.REFUSED,
            f"an answer takes {found.round_trip_ms:.0f} ms (up to {ROUND_TRIP_MS:.0f} is fine)",
            "use the cable, or a network that does not queue: no VPN, no shared radio link",
        )
    slow = min(found.streams, key=lambda stream: stream.rate_hz / stream.asked_hz)
    if slow.rate_hz < RATE_SHARE * slow.asked_hz:
        return Verdict(
            13,
            "rate",
            ExitCode.REFUSED,
            f"{slow.service} comes {slow.rate_hz:.1f} times a second instead of "
            f"{slow.asked_hz:.1f}",
            "end other programs that subscribe with other periods, and run doctor again",
        )
    return None


def judge(found: Findings) -> Verdict:
    """Return the first problem, in the order in which one would fix them."""
    return (
        _contact(found)
        or _discovery(found)
        or _streams(found)
        or Verdict(
            0,
            "healthy",
            ExitCode.FINE,
            f"{sum(stream.received for stream in found.streams)} statuses, "
            f"{found.loss:.1%} lost, answers in {found.round_trip_ms:.1f} ms",
            "nothing to fix: try roburoc4 monitor",
        )
    )
