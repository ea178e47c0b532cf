# SPDX-License-Identifier: MIT
"""The network and the robot's clock; what a broken link does."""

import statistics
from itertools import pairwise

from . import wire
from .session import ANSWER_S, MissedError, Session, UnsafeError
from .wire import CYCLE_S

_REQUESTS = 100
_EVERY_S = 0.05
_SHORTEST_S = 20.0
_ENDS_S = 10.0
_OUTAGE_S = 1.5
_PULLED_S = 10.0
_DRIVES_S = 0.5
_BACK_S = 15.0
_SILENT_S = 1.0


def network(s: Session) -> None:
    """Ask a hundred times, and look for programs of others."""
    s.begin()
    trips_ms: list[float] = []
    commanded = 0
    for k in range(_REQUESTS):
        s.progress("Questions", k + 1, _REQUESTS)
        due_s = s.world.now_s + _EVERY_S
        sent_s = s.world.now_s
        answer = s.request(wire.GET, wire.DIRECTORY, patience_s=1.0, tries=1)
        if answer is not None:
            trips_ms.append(1000 * (answer.at_s - sent_s))
        if k % 10 == 0:
            commanded += _is_commanded(s)
        s.pump(max(due_s - s.world.now_s, 0.0))
    s.notes[f"lost, of {_REQUESTS} requests"] = _REQUESTS - len(trips_ms)
    if trips_ms:
        s.notes["round trip, least, ms"] = round(min(trips_ms), 1)
        s.notes["round trip, usually, ms"] = round(statistics.median(trips_ms), 1)
        s.notes["round trip, most, ms"] = round(max(trips_ms), 1)
        changes = [abs(b - a) for a, b in pairwise(trips_ms)]
        s.notes["jitter of round trips, ms"] = round(statistics.fmean(changes or [0.0]), 1)
    answer = s.request(wire.GET, wire.NOTIFICATION)
    if answer is not None and not answer.error:
        s.notes["subscriptions of other programs"] = len(answer.payload) // 3
    if commanded > 1:
        raise UnsafeError("other_sender", "Another program commands this robot: end that first.")


def _is_commanded(s: Session) -> bool:
    """Whether the robot has a target, though nobody here sent one."""
    if "differential" not in s.ids:
        return False
    answer = s.request(wire.GET, s.ids["differential"], patience_s=1.0, tries=1)
    if answer is None or answer.error or len(answer.payload) != wire.DIFFERENTIAL_BYTES:
        return False
    return max(map(abs, wire.speeds_of(0.0, answer.payload).target)) > 1e-3


# ---- the clock


def hear_clock(s: Session) -> None:
    """Hear the robot's clock, which each status of the inputs shows."""
    s.subscribe("iocard", 10)


def between_restarts(clock: list[tuple[float, int]]) -> list[tuple[float, int]]:
    """Return the longest piece in which the robot's clock went on."""
    pieces: list[list[tuple[float, int]]] = [[]]
    for at_s, cycles in clock:
        if pieces[-1]:
            passed_s = at_s - pieces[-1][-1][0]
            counted_s = CYCLE_S * (cycles - pieces[-1][-1][1])
            if counted_s < 0 or abs(passed_s - counted_s) > 1.0:
                pieces.append([])
        pieces[-1].append((at_s, cycles))
    return max(pieces, key=lambda piece: piece[-1][0] - piece[0][0] if piece else 0.0)


def keep_clock(s: Session) -> None:
    """Compare the robot's clock with ours, by the quickest statuses of begin and end."""
    clock = between_restarts(s.clock)
    if not clock or clock[-1][0] - clock[0][0] < _SHORTEST_S:
        hear_clock(s)
        s.lasts("The robot's clock is compared with this computer's", 1.1 * _SHORTEST_S)
        s.pump(1.1 * _SHORTEST_S)
        clock = between_restarts(s.clock)
    if not clock or clock[-1][0] - clock[0][0] < _SHORTEST_S:
        return
    first_s, last_s = clock[0][0], clock[-1][0]
    first = clock[0][1]  # robots count further than floats do
    ends = [
        min(part, key=lambda x: x[0] - CYCLE_S * (x[1] - first))
        for part in (
            [x for x in clock if x[0] <= first_s + min(_ENDS_S, _SHORTEST_S / 2)],
            [x for x in clock if x[0] >= last_s - min(_ENDS_S, _SHORTEST_S / 2)],
        )
    ]
    passed_s = ends[1][0] - ends[0][0]
    counted_s = CYCLE_S * (ends[1][1] - ends[0][1])
    s.learn("clock_ppm", round(min(max(1e6 * (counted_s / passed_s - 1), -1000), 1000)))
    s.proof["clock_ppm"] = (0, len(s.log))
    s.notes["robot's clock compared for, s"] = round(last_s - first_s)
    every = max(1, len(clock) // 1000)
    s.traces["clock"] = {
        "robot's clock ahead of this computer's": [
            [round(at_s - first_s, 2), round(1000 * (CYCLE_S * (n - first) - (at_s - first_s)), 2)]
            for at_s, n in clock[::every]
        ]
    }


# ---- an outage


def outage(s: Session) -> None:
    """Lose the link in mid-drive: the robot must have stopped when it comes back."""
    s.begin()
    is_silent = s.world.now_s - s.heard_s > _SILENT_S
    if is_silent and s.request(wire.GET, wire.DIRECTORY) is None:
        _plug_in(s)  # the key was let go while the cable was out
    hear_clock(s)
    s.please(
        "at_cable",
        "Take hold of the plug of the network cable: you pull it after a countdown of 1.5 s.",
    )
    drove_s = _pulled(s)
    _plug_in(s)
    if drove_s < _DRIVES_S:
        raise MissedError("The cable was out before the wheels turned.")
    statuses = len(s.hear("iocard", 1.5))
    since_s = s.world.now_s
    s.run(1.0, None)
    speed = max((abs(x.speed[0]) for x in s.sampled(since_s, None)), default=0.0)
    s.stop()
    s.watched.append(
        [
            "The network cable was pulled while the wheels turned.",
            f"Afterwards the wheels turned at {speed:.2f} m/s; "
            + ("statuses went on." if statuses else "there were no statuses until asked again."),
        ]
    )
    if speed > 0.03:
        raise UnsafeError("drives_on", "The robot drove on although the link was broken.")


def _plug_in(s: Session) -> None:
    answer = None
    while answer is None:
        s.please("cable_in", "Plug the network cable in again, and wait for its lamp.")
        s.lasts("Waiting until the robot answers", _BACK_S)
        answer = s.request(wire.GET, wire.DIRECTORY, tries=round(_BACK_S / ANSWER_S))


def _pulled(s: Session) -> float:
    """Drive until the cable was out for longer than the watchdog's time; return how long before."""
    s.hold()
    s.stop()
    began_s = s.world.now_s
    longest_s = s.known["robot_watchdog_ms"] / 1000 + _OUTAGE_S
    s.world.countdown("cable_out", "Pull the network cable at 0, and leave it out.", 1.5)
    s.lasts("It stays out until you are asked to plug it in", _PULLED_S + longest_s)
    s.run(
        _PULLED_S + longest_s,
        (0.1, 0.0),
        lambda: s.world.now_s - s.heard_s > longest_s + s.known["queue_answer_ms"] / 1000,
    )
    pulled = s.world.now_s - s.heard_s > _OUTAGE_S
    s.command(0.0, 0.0)  # whatever still waits somewhere, a zero comes last
    if not pulled:
        s.stop()
        raise MissedError("The cable was not pulled: the robot was heard all the time.")
    return s.heard_s - began_s - s.known["queue_answer_ms"] / 1000


def restarted(s: Session) -> None:
    """Keep what a restart, which just was, did to clock and subscriptions."""
    before = s.clock[-1][1] if s.clock else 0
    went_on = len(s.listen(1.5)["iocard"])
    hear_clock(s)
    s.pump(1.0)
    after = s.clock[-1][1] if s.clock else 0
    s.watched.append(
        [
            "The robot was switched off and on.",
            f"Its clock went from {before * CYCLE_S:.0f} s to {after * CYCLE_S:.0f} s; "
            + ("subscriptions outlived it." if went_on else "no subscription outlived it."),
        ]
    )
