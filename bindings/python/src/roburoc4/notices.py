# SPDX-License-Identifier: MIT
"""Events as sentences, for the dashboard's list and for recordings."""

from typing import Protocol

from .constants import Event

_TEXTS: tuple[tuple[Event, str, str], ...] = (
    (Event.LOST, "bad", "the robot fell silent: lost"),
    (Event.REBOOT, "bad", "the robot was restarted"),
    (Event.READY, "good", "the robot is ready"),
    (Event.DISARMED, "weak", "disarmed"),
    (Event.ARMED, "good", "armed"),
    (Event.LEASE_OVER, "weak", "no fresh input: the lease ended and the robot was stopped"),
    (Event.BATTERY_LOW, "weak", "battery low"),
    (Event.BATTERY_CRITICAL, "bad", "battery critical"),
    (Event.RELOCALIZED, "plain", "odometry was set anew"),
    (Event.SUBSCRIPTION_REFUSED, "weak", "the robot refused a subscription"),
    (Event.FIXED_ID, "plain", "the robot answers every request with the id 1"),
    (Event.CLOCK, "weak", "this computer slept, or its clock jumped"),
    (Event.CAPACITY, "weak", "the robot has more channels than are shown"),
)


# These events report that a fact changed, but not how.
_CHANGES: tuple[tuple[Event, str, str, str], ...] = (
    (
        Event.OVERRIDE,
        "overridden",
        "[A] is held on the robot's game pad: it drives",
        "[A] on the robot's game pad was released",
    ),
    (
        Event.OTHER_COMMANDER,
        "other_commander",
        "another program commands the robot",
        "no other program commands the robot any more",
    ),
    (
        Event.INHIBITED,
        "inhibited",
        "motion inhibited: a speed is asked for, but the robot stands still",
        "the robot moves again, or no speed is asked for any more",
    ),
)


class Dangers(Protocol):
    """Those of the robot's facts that are dangers, and end."""

    @property
    def overridden(self) -> bool:
        """Somebody drives with the robot's own game pad."""

    @property
    def other_commander(self) -> bool:
        """Another program commands it."""

    @property
    def inhibited(self) -> bool:
        """It stands still against a command."""


def texts_of(events: Event, before: Dangers, now: Dangers) -> list[tuple[str, str]]:
    """Name events between two looks at the robot for the list: level and text."""
    found = [(level, text) for event, level, text in _TEXTS if events & event]
    for event, fact, begun, ended in _CHANGES:
        if events & event:
            was, is_now = getattr(before, fact), getattr(now, fact)
            if is_now or not was:  # it may have come and gone between the two
                found.append(("bad", begun))
            if not is_now:
                found.append(("plain", ended))
    return found
