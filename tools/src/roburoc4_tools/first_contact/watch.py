# SPDX-License-Identifier: MIT
"""Watching: a person presses and measures, and the robot reports."""

import math
import struct

from . import wire
from .identify import NOT_ENDED, restart
from .session import Session, UnsafeError, number

_BUMPERS = (
    ("front_bumper_index", "front_bumper", "the front bumper"),
    ("rear_bumper_index", "rear_bumper", "the rear bumper"),
    ("override_index", "pad_a", "button [A] of the game pad"),
)


_PAD = (
    (
        "sticks",
        "Push the left stick up, down, left, right, then the right one likewise, then pull "
        "the left and the right trigger, each fully. Do not touch [A].",
    ),
    (
        "buttons",
        "Press each other button of the game pad but [A], one after another: B, X, Y, "
        "Back, Start, the four arrows, both sticks, LB, RB.",
    ),
)
_BATTERY_STATES = ("charging", "charged", "in use", "nearly empty")
_AWAY = 0.5
_MOST_OF_PAD = 1.05


def decoded(s: Session, payload: bytes) -> tuple[list[float], list[bool]]:
    """Return the analog and the digital inputs of a status."""
    analog = min(int(s.known["analog_inputs"]), len(payload) // 4)
    values = list(struct.unpack_from(f"<{analog}f", payload))
    return values, wire.bits_of(payload[4 * analog :], int(s.known["digital_inputs"]))


def _inputs(s: Session) -> tuple[list[float], list[bool]]:
    heard = s.hear("iocard", 1.6)
    return decoded(s, heard[-1].payload) if heard else ([], [])


def changed_inputs(before: list[bool], after: list[bool]) -> str:
    """Name the digital inputs that differ."""
    changes = [
        f"{k} went {'on' if b else 'off'}"
        for k, (a, b) in enumerate(zip(before, after, strict=False))
        if a != b
    ]
    return "digital inputs: " + (", ".join(changes) or "none changed")


def digital_inputs(s: Session) -> list[bool]:
    """Return the digital inputs as they are now."""
    return _inputs(s)[1]


def inputs(s: Session) -> None:
    """Find each input by hand, whatever the texts say."""
    if "iocard" not in s.usable:
        raise UnsafeError(
            "no_inputs",
            "The robot does not report its inputs: it would not be seen that the pad is in use.",
        )
    s.subscribe("iocard", 10)
    for name, key, what in _BUMPERS:
        s.begin()
        before = _inputs(s)[1]
        s.please(f"press_{key}", f"Press {what} and keep it pressed.")
        during = _inputs(s)[1]
        s.please(f"release_{key}", f"Let {what} go.")
        after = _inputs(s)[1]
        changed = [
            k
            for k, (b, d, a) in enumerate(zip(before, during, after, strict=False))
            if d and not b and not a
        ]
        if changed:
            s.learn(name, changed[0])
        s.watched.append([f"Pressed {what}.", changed_inputs(before, during)])
    s.begin()
    shown_v = number(
        lambda text: s.ask("battery_v", text), "Which voltage does the panel's display show?"
    )
    values = _inputs(s)[0]
    s.watched.append([f"The display showed {shown_v:g} V.", _battery(s, values)])
    near = [k for k, v in enumerate(values) if abs(v - shown_v) < 0.5]
    if len(near) == 1:
        s.learn("battery_voltage_index", near[0])
    if "override_index" not in s.known:
        raise UnsafeError(
            "no_game_pad",
            "No input changed with [A], so nobody could see that the game pad is in use. Was the "
            "game pad off? Then switch it on: the same command asks again.",
        )


def _end(s: Session, service: str) -> None:
    """End a subscription, by a restart if the robot does not let us and its list is short."""
    s.unsubscribe(service)
    if s.known.get("delete_refused") and s.most_subscriptions() < len(s.usable):
        restart(s, NOT_ENDED, 1)
        s.subscribe("iocard", 10)


def _battery(s: Session, values: list[float]) -> str:
    said = "analog inputs: " + ", ".join(f"{k}: {v:.2f}" for k, v in enumerate(values))
    if "battery" not in s.usable:
        return said
    s.subscribe("battery", 20)
    heard = s.hear("battery", 1.5)
    _end(s, "battery")
    if not heard or heard[-1].payload[0] >= len(_BATTERY_STATES):
        return said
    state, percent = heard[-1].payload[:2]
    return f"{said}; the battery: {percent} %, {_BATTERY_STATES[state]}"


def sticks(s: Session) -> None:
    """List what changes with the sticks and the buttons, in this order."""
    s.begin()
    for key, text in _PAD:
        rest = _inputs(s)
        s.statuses.clear()
        s.please(key, text)
        s.pump(0.3)
        heard = [decoded(s, x.payload) for x in s.heard_of("iocard")]
        s.watched.append([text, _sequence(rest, heard)])


def _sequence(
    rest: tuple[list[float], list[bool]], heard: list[tuple[list[float], list[bool]]]
) -> str:
    """Name each input that leaves its rest, whenever it does, and how far."""
    peaks: list[list[float]] = []  # index, value; of digital inputs beyond the analog ones
    away: dict[int, list[float]] = {}
    analog = len(rest[0])
    axes = [k for k in range(analog) if all(abs(x[0][k]) <= _MOST_OF_PAD for x in (rest, *heard))]
    for values, bits in heard:
        now = {k: values[k] for k in axes if abs(values[k] - rest[0][k]) > _AWAY}
        now |= {analog + k: 1.0 for k, on in enumerate(bits) if on and not rest[1][k]}
        for k, value in now.items():
            if k not in away:
                away[k] = [k, value]
                peaks.append(away[k])
            elif abs(value) > abs(away[k][1]):
                away[k][1] = value
        away = {k: peak for k, peak in away.items() if k in now}
    return (
        ", ".join(
            f"analog {k:g} to {v:+.2f}" if k < analog else f"digital {k - analog:g}"
            for k, v in peaks
        )
        or "no input changed"
    )


def telemeters(s: Session) -> None:
    """Hold a board in front of each."""
    if not s.known.get("reported_distances"):
        return
    s.begin()
    answer = s.request(wire.GET, s.ids["telemeter"])
    angles = wire.telemeter_angles(answer.payload) if answer is not None else []
    s.subscribe("telemeter", 10)
    count = int(s.known["reported_distances"])
    for k in range(count):
        points = (
            f", which points to {round(math.degrees(angles[k]))} degrees" if k < len(angles) else ""
        )
        before = _distances(s)
        s.please(
            f"board_{k}",
            f"Hold a board 0.5 m in front of telemeter {k}{points} (0 is forward, 90 left): "
            f"{k + 1} of {count}.",
        )
        during = _distances(s)
        s.watched.append(
            [
                f"A board 0.5 m in front of telemeter {k}{points}.",
                f"{before} m before, {during} m then",
            ]
        )
    s.please("board_away", "Take the board away.")
    _end(s, "telemeter")


def _distances(s: Session) -> str:
    heard = s.hear("telemeter", 1.6)
    count = int(s.known["reported_distances"])
    if not heard:
        return "nothing"
    return ", ".join(f"{x:.2f}" for x in struct.unpack_from(f"<{count}f", heard[-1].payload))
