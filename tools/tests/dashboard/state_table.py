# SPDX-License-Identifier: MIT
"""All states that the page knows, most urgent first, each with a frame that shows it."""

import copy
from typing import Any

Frame = dict[str, Any]

CALM: Frame = {
    "state": "ready",
    "mine": True,
    "offered": True,
    "everReady": True,
    "why": "",
    "must_let_go": False,
    "going": None,
    "link": {"level": "good", "say": "link good", "attempt": ""},
    "battery": {"state": "ok"},
    "speeds": [0.0, 0.0, 0.0, 0.0],
    "facts": {
        "armed": False,
        "driving": False,
        "overridden": False,
        "other_commander": False,
        "inhibited": False,
        "front_bumper": False,
        "rear_bumper": False,
        "battery_low": False,
        "stop_unconfirmed": False,
        "at_rest": True,
        "charger": False,
        "pose_error": False,
        "blocked": "",
    },
}
MOVES: Frame = {"speeds": [0.0, 1.28, 0.0, 0.0], "facts": {"at_rest": False}}
LOST = {"level": "bad", "say": "the robot fell silent", "attempt": "check the cable"}
BAD = {"level": "bad", "say": "statuses come too late", "attempt": "check the cable"}
WEAK = {"level": "weak", "say": "20% of the statuses are lost", "attempt": "use a cable"}


def merged(one: Frame, other: Frame) -> Frame:
    """Return both in one frame; where they differ, the second counts."""
    both = copy.deepcopy(one)
    for name, value in other.items():
        both[name] = merged(both.get(name, {}), value) if isinstance(value, dict) else value
    return both


def conflict(one: Frame, other: Frame) -> bool:
    """Whether no robot can be in both states at once."""
    return any(
        conflict(one[name], value) if isinstance(value, dict) else one[name] != value
        for name, value in other.items()
        if name in one
    )


UNCONFIRMED = {"facts": {"stop_unconfirmed": True, "armed": False, "overridden": False}}
UNCOMMANDED = {
    "facts": {
        "armed": False,
        "overridden": False,
        "other_commander": False,
        "stop_unconfirmed": False,
    }
}
STATES: list[tuple[str, Frame]] = [
    ("STOP NOT CONFIRMED", merged(MOVES, UNCONFIRMED)),
    ("ROBOT LOST", {"state": "lost", "link": LOST}),
    ("ANOTHER COMMANDER", {"facts": {"other_commander": True}}),
    ("FRONT BUMPER", {"facts": {"front_bumper": True}}),
    ("OVERRIDE", {"facts": {"overridden": True}}),
    ("MOTION INHIBITED", {"facts": {"inhibited": True}}),
    ("CHARGER PLUGGED IN", merged(MOVES, {"facts": {"charger": True}})),
    ("BATTERY CRITICAL", {"battery": {"state": "critical"}}),
    ("LINK BAD", {"link": BAD}),
    ("POSE WRONG", {"facts": {"pose_error": True}}),
    ("BATTERY LOW", {"battery": {"state": "ok"}, "facts": {"battery_low": True}}),
    ("LINK WEAK", {"link": WEAK}),
    (
        "LET GO",
        {
            "why": "inputs arrived too late",
            "must_let_go": True,
            "facts": {"armed": True, "driving": False},
        },
    ),
    ("DRIVING", {"facts": {"armed": True, "driving": True}}),
    ("ARMED", {"facts": {"armed": True, "driving": False}}),
    ("MOVING", merged(MOVES, UNCOMMANDED)),
    ("DISARMED", {"facts": {"armed": False, "at_rest": True}}),
]
