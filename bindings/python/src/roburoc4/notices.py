# SPDX-License-Identifier: MIT
"""The events that the dashboard's list and recordings show, and how serious they are."""

from typing import Protocol

from . import _native
from .constants import Event

__all__ = ["FACTS", "Dangers", "change_text", "texts_of"]

_LEVELS = {
    Event.LOST: "bad",
    Event.REBOOT: "bad",
    Event.READY: "good",
    Event.DISARMED: "weak",
    Event.ARMED: "good",
    Event.LAPSED: "weak",
    Event.STOP_UNCONFIRMED: "bad",
    Event.BATTERY_LOW: "weak",
    Event.BATTERY_CRITICAL: "bad",
    Event.RELOCALIZED: "plain",
    Event.SUBSCRIPTION_REFUSED: "weak",
    Event.FIXED_ID: "plain",
    Event.CLOCK: "weak",
    Event.CAPACITY: "weak",
}

FACTS = {
    Event.OVERRIDE: "overridden",
    Event.OTHER_COMMANDER: "other_commander",
    Event.INHIBITED: "inhibited",
}
"""These events report that a fact changed, but not in which direction."""


class Dangers(Protocol):
    """Facts that are dangers, and end."""

    @property
    def overridden(self) -> bool | None:
        """Somebody drives with the robot's own game pad; None: not known."""

    @property
    def other_commander(self) -> bool:
        """Another commander drives it."""

    @property
    def inhibited(self) -> bool:
        """It does not follow its commands: too slow, too fast, or the wrong way."""


def change_text(event: Event, has_begun: bool | None) -> str:
    """Describe that the fact of an event in FACTS began or ended."""
    direction = (
        _native.ROBUROC4_NAME_EVENT_BEGAN if has_begun else _native.ROBUROC4_NAME_EVENT_ENDED
    )
    return _native.roburoc4_name(direction, event)


def texts_of(
    events: Event, before: Dangers, now: Dangers, *, watches: bool = False
) -> list[tuple[str, str]]:
    """Describe the events between two readings of the robot for the list: level and text.

    For a client that only ``watches``, it is no fault that another one drives.
    """
    found = [(level, event.text) for event, level in _LEVELS.items() if events & event]
    for event, fact in FACTS.items():
        if events & event:
            was, is_now = getattr(before, fact), getattr(now, fact)
            if is_now or not was:  # it may have begun and ended between the two
                is_fine = watches and event is Event.OTHER_COMMANDER
                found.append(("plain" if is_fine else "bad", change_text(event, True)))
            if not is_now:
                found.append(("plain", change_text(event, False)))
    return found
