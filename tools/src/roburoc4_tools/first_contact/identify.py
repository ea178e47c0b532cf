# SPDX-License-Identifier: MIT
"""Before anything moves: what the robot is, and how it answers."""

import math
import re
import struct
from itertools import pairwise

from . import wire
from .session import ANSWER_S, Session, SilentError, UnsafeError
from .wire import CYCLE_S

_TEXT_S = 3.5
_HEARD_S = 1.5
_PERIOD_S = 4.0
_CLOSED_S = 15.0
_START_S = 120.0
_NO_SERVICE = 0xFFFE
_NO_ACTION = 0x7E
_SILENT_IN_A_ROW = 4
_LONGEST_QUEUE_MS = 5000
_CLEANED = 3
"""How often all subscriptions are ended after one another's."""
NOT_ENDED = "The robot ends no subscription when asked to; only a restart does."
_MEANS = {
    "iocard": "nobody would see that [A] is held, so it ends before the wheels turn",
    "telemeter": "the step telemeters is left out, and on the ground you look out for obstacles",
    "localization": "no pose shows how far it moved, so it ends before it leaves the stand",
    "differential": "it takes no speeds or does not show them, so it ends before the wheels turn",
}
"""What it means for the steps that follow if a service is missing."""
_INPUTS = {0: "analog_inputs", 2: "digital_inputs"}


def directory(s: Session) -> None:
    """Find the services, by the layout of their properties."""
    s.begin()
    s.fixed = True  # any id is accepted here
    answer = s.request(wire.GET, wire.DIRECTORY, patience_s=1.0, tries=3)
    if answer is None:
        s.known["only_id_fixed"] = 1
        answer = s.request(wire.GET, wire.DIRECTORY, patience_s=1.0, tries=3)
        if answer is None:
            raise UnsafeError(
                "silent", "The robot does not answer: check its address and the cable."
            )
        s.learn("only_id_fixed", 1)
    else:
        s.learn("only_id_fixed", 0)
        s.fixed = answer.id == wire.MANUAL_ID
        s.learn("answer_id_fixed", int(s.fixed))
    entries = [
        struct.unpack_from("<HH", answer.payload, at) for at in range(0, len(answer.payload) - 3, 4)
    ]
    for kind, number in entries:
        properties = None
        if number > wire.NOTIFICATION:
            properties = s.request(wire.GET, number)
        if properties is None or properties.error:
            continue
        service = wire.service_of_properties(properties.payload)
        if service is not None and service not in s.ids:
            s.ids[service] = number
            s.learn(f"{service}_id", number)
            s.learn(f"{service}_type", kind)
            _keep(s, service, properties.payload)
    missing = {name: f"The robot has no {name}" for name in _MEANS if name not in s.ids}
    if s.known.get("digital_inputs") == 0:
        missing["iocard"] = "The iocard has no digital inputs"
    _tell_missing(s, missing)
    hidden = sum(4 << k for k, name in enumerate(wire.SERVICES) if name not in s.ids)
    s.learn("hidden_services", hidden)


def _tell_missing(s: Session, missing: dict[str, str]) -> None:
    for service, text in missing.items():
        s.world.say(f"  {text}: {_MEANS[service]}.")
        s.watched.append([f"{text}.", f"{_MEANS[service]}."])


def _keep(s: Session, service: str, payload: bytes) -> None:
    if service == "iocard":
        names = ("analog_inputs", "analog_outputs", "digital_inputs", "digital_outputs")
        for name, count in zip(names, struct.unpack("<4i", payload), strict=True):
            s.learn(name, count)
    elif service == "telemeter":
        count = int.from_bytes(payload[:4], "little")
        s.learn("telemeters", count)
        if count:
            theta = struct.unpack_from("<f", payload, 4 + 8)[0]  # the first points to the front
            s.learn("telemeter_turn_rad", round(theta, 4))
    elif service == "differential":
        for name, value in wire.limits_of(payload).items():
            if math.isfinite(value):
                s.learn(name, value)


def errors(s: Session) -> None:
    """Ask for what does not exist, in two ways, and compare the errors."""
    s.begin()
    found = [
        s.request(wire.GET, _NO_SERVICE),
        s.request(_NO_ACTION, wire.DIRECTORY),
    ]
    if found[0] is None or found[1] is None:
        return
    bare = found[0].action is None
    s.learn("error_header", 2 if bare else 1 if found[0].id == 0 else 0)
    if not bare:
        same = found[0].error == found[1].error
        s.learn("error_code", found[0].error if same else 0)


def texts(s: Session) -> None:
    """Read all texts: who answers, how late, and in which manner."""
    s.begin()
    trip_s = _round_trip(s)
    asked = [(wire.DIRECTORY, k.to_bytes(2, "little"), -1) for k in range(2 + len(s.ids))]
    if "iocard" in s.ids:
        for kind, name in _INPUTS.items():
            asked += [
                (s.ids["iocard"], bytes([kind]) + index.to_bytes(4, "little"), index)
                for index in range(int(s.known[name]))
            ]
    answered: dict[tuple[int, bytes], wire.Answer] = {}
    silent_in_a_row = doubled = 0
    late_s = math.inf
    for number, (target, payload, _index) in enumerate(asked, 1):
        s.progress("Texts", number, len(asked))
        if silent_in_a_row == _SILENT_IN_A_ROW:
            break
        sent_s = s.world.now_s
        answer = s.request(wire.QUERY, target, payload, patience_s=_TEXT_S, tries=1)
        if answer is None:
            silent_in_a_row += 1
            continue
        silent_in_a_row = 0
        late_s = min(late_s, answer.at_s - sent_s)
        answered[target, payload] = answer
        s.pump(2 * CYCLE_S)
        doubled += any(a.action in (None, wire.QUERY) for a in s.answers())
    _keep_mode(s, asked, answered)
    if answered:
        s.learn("texts", _manner(answered) + (16 if doubled else 0))
    if answered and not all(a.error for a in answered.values()):
        s.learn("queue_text_ms", max(0, round((late_s - trip_s) * 1000)))


def _round_trip(s: Session) -> float:
    sent_s = s.world.now_s
    answer = s.request(wire.GET, wire.DIRECTORY)
    trip_s = answer.at_s - sent_s if answer is not None else 0.0
    s.learn("queue_answer_ms", round(trip_s * 1000))
    return trip_s


def _keep_mode(
    s: Session,
    asked: list[tuple[int, bytes, int]],
    answered: dict[tuple[int, bytes], wire.Answer],
) -> None:
    refused = [key for key, a in answered.items() if a.error]
    silent = [(t, p) for t, p, _i in asked if (t, p) not in answered]
    if not answered:
        mode = 1
    elif len(refused) == len(asked):
        mode = 2
    elif len(silent) == 1 and silent[0][1][:1] == b"\x02":
        mode = 3
    elif len(refused) == 1 and refused[0][1][:1] == b"\x02":
        mode = 4
    elif not any(a.payload for a in answered.values()):
        mode = 5
    else:
        mode = 0
    s.learn("query_mode", mode)


def _manner(answered: dict[tuple[int, bytes], wire.Answer]) -> int:
    raw = [a.payload for (t, _p), a in answered.items() if not a.error]
    words = [set(re.findall(r"[a-z]+", t.decode("latin-1").lower())) for t in raw]
    return (
        (1 if any(re.match(rb"^\w+, ", t) for t in raw) else 0)
        + (2 if any(b"\xab" in t or b"\xbb" in t for t in raw) else 0)
        + (4 if sum({"front", "bumper"} <= w for w in words) > 1 else 0)
        + (8 if any({"a", "led"} <= w for w in words) else 0)
    )


# ---- subscriptions


def _clean(s: Session, ports: int, restarts_left: int) -> None:
    """End all subscriptions, by a restart if the robot does not let us."""
    if s.known.get("delete_refused"):
        restart(s, NOT_ENDED, restarts_left)
        return
    for port in range(ports):
        for service in s.ids:
            s.unsubscribe(service, port)


def restart(s: Session, why: str, left: int) -> None:
    """Switch the robot off and on, without its motors, and wait until it answers.

    So many more are still to come, as far as is known.
    """
    s.restarts += 1
    most = s.restarts + left
    switch = f"Restart {s.restarts} of about {most}: switch" if most > 1 else "Switch"
    s.please(
        "restart",
        f"{why} {switch} the robot off by its main switch, wait 5 s, switch it on. Press no green "
        "button.",
    )
    s.lasts("Waiting until the robot answers", _START_S)
    while not _answers_within(s, _START_S):
        s.please("silent", "The robot does not answer: check its power and the cable.")
    s.pump(1.0)


def _answers_within(s: Session, seconds: float) -> bool:
    end_s = s.world.now_s + seconds
    while s.world.now_s < end_s:
        if s.request(wire.GET, wire.DIRECTORY, patience_s=1.0, tries=1) is not None:
            return True
    return False


def _is_heard(s: Session, service: str, port: int = 0, seconds: float = _HEARD_S) -> bool:
    return bool(s.hear(service, seconds, port))


def subscriptions(s: Session) -> None:
    """Find out which services send, how often, and whether they can be stopped."""
    s.begin()
    refused = 0
    accepted: list[str] = []
    silent: list[str] = []
    lengths: dict[str, int] = {}
    kept = False
    for number, service in enumerate(sorted(s.ids, key=lambda name: name != "differential"), 1):
        s.lasts(
            f"Subscribing to {service}, and ending that, {number} of {len(s.ids)}",
            2 * (_HEARD_S + _LONGEST_QUEUE_MS / 1000),
        )
        is_refused, asked_s, first_s = _subscribed(s, service)
        if first_s is None and kept:
            restart(s, "Those before may fill the robot's list, and cannot be ended.", _CLEANED + 2)
            kept = False
            is_refused, asked_s, first_s = _subscribed(s, service)
        if is_refused:
            refused |= 4 << wire.SERVICES.index(service)
        elif first_s is not None:
            accepted.append(service)
            lengths[service] = len(s.heard_of(service)[-1].payload)
            if len(accepted) == 1:
                s.lasts(
                    "How often its statuses come, and whether they end",
                    _PERIOD_S + 2 * _HEARD_S + first_s - asked_s,
                )
                _keep_period(s, service)
            asked_to_end_s = s.world.now_s
            answer = s.unsubscribe(service)
            if len(accepted) == 1:
                s.learn("delete_refused", int(answer is None or bool(answer.error)))
            kept = bool(s.known["delete_refused"])
            if not kept:
                s.pump(_HEARD_S + first_s - asked_s)
            _keep_queue(s, service, first_s - asked_s, asked_to_end_s)
        else:
            silent.append(service)
            s.unsubscribe(service)
    if silent and not accepted:
        raise UnsafeError(
            "no_statuses",
            "The robot accepts subscriptions, but no status arrives: does a firewall drop them?",
        )
    s.learn("refused_inserts", refused)
    refusing = [x for k, x in enumerate(wire.SERVICES) if refused & 4 << k and x in _MEANS]
    _tell_missing(s, {name: f"The robot does not report its {name}" for name in refusing})
    for service in silent:
        s.watched.append([f"Subscribed to {service}.", "Accepted, but no status arrived."])
    s.usable = accepted
    _keep_lengths(s, lengths)
    if accepted:
        if kept:
            restart(s, NOT_ENDED, _CLEANED + 1)
        _lists(s, accepted)
        _size(s, accepted)
        _closed_port(s, accepted[0])
        _clean(s, 2, 1)


def _subscribed(s: Session, service: str) -> tuple[bool, float, float | None]:
    """Subscribe; return whether that was refused, when it was asked, and the first arrival."""
    s.statuses.clear()
    asked_s = s.world.now_s
    answer = s.subscribe(service, 1)
    s.pump(_HEARD_S)
    is_refused = answer is None or bool(answer.error)
    return is_refused, asked_s, None if is_refused else _first_arrival(s, service)


def _first_arrival(s: Session, service: str) -> float | None:
    """When its first status arrives, be it as late as the longest queue."""
    end_s = s.world.now_s + _LONGEST_QUEUE_MS / 1000
    while not (found := _arrivals(s, service)) and s.world.now_s < end_s:
        s.pump(0.1)
    return found[0] if found else None


def _arrivals(s: Session, service: str) -> list[float]:
    return [x.at_s for x in s.heard_of(service)]


def _keep_queue(s: Session, service: str, first_s: float, asked_to_end_s: float) -> None:
    """Keep how late statuses arrive, in whole cycles, with the way of requests to the robot.

    It is less than from INSERT to the first one, and more than from DELETE to the last one.
    """
    least_s = first_s - CYCLE_S * (s.known["min_period_cycles"] + 1)
    if not s.known["delete_refused"]:
        least_s = max(least_s, _arrivals(s, service)[-1] - asked_to_end_s)
    cycles = math.floor((max(least_s, 0.0) + first_s) / 2 / CYCLE_S)
    s.learn(f"queue_{service}_ms", min(10 * cycles, _LONGEST_QUEUE_MS))


def _keep_period(s: Session, service: str) -> None:
    heard = s.listen(_PERIOD_S)[service]
    spans = [b.at_s - a.at_s for a, b in pairwise(heard)]
    if not spans:
        raise SilentError
    s.learn("min_period_cycles", max(1, round(sum(spans) / len(spans) / CYCLE_S)))
    s.learn("other_status_port", int(any(h.other_port for h in heard)))


def _period_of(statuses: list[wire.Status]) -> int:
    if len(statuses) < 3:
        return 0
    return round((statuses[-1].at_s - statuses[0].at_s) / (len(statuses) - 1) / CYCLE_S)


def _lists(s: Session, accepted: list[str]) -> None:
    """Subscribe from two ports, each with its own period."""
    s.begin()
    service = accepted[0]
    s.lasts(
        "Subscribing from two ports", 2 * (_HEARD_S + _PERIOD_S) + ANSWER_S + 3 * s.lag_s(service)
    )
    s.subscribe(service, 25, 0)
    answer = s.subscribe(service, 50, 1)
    s.pump(_HEARD_S + s.lag_s(service))
    first, second = (_period_of(s.listen(_PERIOD_S, port)[service]) for port in (0, 1))
    if answer is not None and not answer.error and first and second:
        s.learn("subscription_lists", 0 if abs(first - 25) < 5 else 1)
    elif answer is not None and not answer.error and second and len(accepted) > 1:
        # Did the first go because statuses go to the last one, or because there is room for one?
        s.subscribe(accepted[1], 50, 1)
        s.pump(_HEARD_S + s.lag_s(service))
        if _is_heard(s, service, 1):
            s.learn("subscription_lists", 2)
    _clean(s, 2, _CLEANED)


def _size(s: Session, accepted: list[str]) -> None:
    """Subscribe from more and more ports, until the list is full."""
    s.begin()
    most, last = 30, s.known.get("subscription_lists") == 2
    entries: list[tuple[int, str]] = []
    for count in range(most):
        s.progress("Subscriptions, until the robot's list is full", count + 1, most)
        port, service = count // len(accepted), accepted[count % len(accepted)]
        answer = s.subscribe(service, 20, port)
        if answer is None or answer.error:
            s.learn("max_subscriptions", count)
            s.learn("full_list", 0)
            break
        s.pump(1.0 + s.lag_s(*accepted))
        everyone = s.listen(0.6, None)
        heard = {(h.port, name) for name, hs in everyone.items() for h in hs}
        if (port, service) not in heard:
            s.learn("max_subscriptions", count)
            s.learn("full_list", 1)
            break
        entries.append((port, service))
        alive = entries[-len(accepted) :] if last else entries
        if any(entry not in heard for entry in alive):
            s.learn("max_subscriptions", count)
            s.learn("full_list", 2)
            break
    else:
        if not last:  # such a list has one place for each service, and its end is not seen
            s.learn("max_subscriptions", 448)
        if s.known.get("delete_refused") and s.known.get("subscription_lists") == 0:
            return  # there is room for what follows
    _clean(s, most // len(accepted) + 1, 2)


def _closed_port(s: Session, service: str) -> None:
    """Close a port without a word, and see whether the robot still sends to it."""
    s.begin()
    port = 40
    s.lasts(
        "Whether statuses go on to a port that was closed",
        _CLOSED_S + 2 * _HEARD_S + ANSWER_S + 3 * s.lag_s(service),
    )
    s.subscribe(service, 20, port)
    if not _is_heard(s, service, port):
        return
    s.world.close(port)
    s.pump(_CLOSED_S + s.lag_s(service))
    s.world.reopen(port)
    s.learn("keep_subscriptions", int(_is_heard(s, service, port)))
    s.unsubscribe(service, port)


def _keep_lengths(s: Session, lengths: dict[str, int]) -> None:
    """Compare the length of statuses with the manual's."""
    plain = {"battery": 2, "localization": 28, "differential": 16}
    if "analog_inputs" in s.known:
        blocks = (int(s.known["digital_inputs"]) + 7) // 8
        plain["iocard"] = 4 * int(s.known["analog_inputs"]) + blocks
    surplus = next((n - plain[service] for service, n in lengths.items() if service in plain), None)
    if surplus is None:
        return
    s.learn("surplus_bytes", min(max(surplus, 0), 8))
    if "telemeter" in lengths:
        distances = lengths["telemeter"] - int(s.known["surplus_bytes"])
        s.learn("reported_distances", max(0, distances // 4))
