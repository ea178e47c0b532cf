# SPDX-License-Identifier: MIT
"""Watching: a person presses and measures, and the robot reports."""

import struct

from . import wire
from .session import Session, UnsafeError, number

_BUMPERS = (
    ("front_bumper_index", "front_bumper", "the front bumper"),
    ("rear_bumper_index", "rear_bumper", "the rear bumper"),
    ("override_index", "pad_a", "button [A] of the game pad"),
)


def _inputs(s: Session) -> tuple[list[float], list[bool]]:
    heard = s.listen(1.6)["iocard"]
    if not heard:
        return [], []
    analog = int(s.known["analog_inputs"])
    payload = heard[-1].payload
    values = list(struct.unpack_from(f"<{analog}f", payload))
    return values, wire.bits_of(payload[4 * analog :], int(s.known["digital_inputs"]))


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
    s.begin()
    shown_v = number(
        lambda text: s.ask("battery_v", text), "Which voltage does the panel's display show?"
    )
    values = _inputs(s)[0]
    near = [k for k, v in enumerate(values) if abs(v - shown_v) < 0.5]
    if len(near) == 1:
        s.learn("battery_voltage_index", near[0])
    if "override_index" not in s.known:
        raise UnsafeError(
            "no_game_pad",
            "No input changed with [A], so nobody could see that the game pad is in use.",
        )
