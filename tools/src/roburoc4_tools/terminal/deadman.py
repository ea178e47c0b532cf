# SPDX-License-Identifier: MIT
"""Which keys are held now, as far as a terminal reports it. In doubt a key counts as released."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .keyboard import Key

FIRST_S = 0.7  # a keyboard waits at most this long before it repeats a key
REPEAT_S = 0.2  # and then repeats it at least this often


class DeadMan:
    """Give it key events; ask which keys are held. Times are of one monotonic clock.

    If releases are reported, a key is held until then; but the terminal must keep responding (ask
    it for echoes), because a line that hangs does not deliver releases either. Otherwise a key is
    held as long as it repeats.
    """

    def __init__(self, reports_releases: bool) -> None:
        self._reports_releases = reports_releases
        self._held: dict[str, None] = {}  # in the order in which they were pressed
        self._heard_s = 0.0
        self._repeats = False

    def feed(self, key: Key, now_s: float) -> None:
        """One key event."""
        held = self.held(now_s)
        if key.action == "blur":
            self.let_go()
        elif key.action == "release":
            self._held.pop(key.name, None)
        elif key.action != "echo":
            if not self._reports_releases:
                self._held.clear()  # only the last key repeats: nothing is known about others
            self._held[key.name] = None
            self._repeats = key.name in held
        if key.action != "echo" or self._reports_releases:
            self._heard_s = now_s

    def held(self, now_s: float) -> list[str]:
        """List the keys that are held, in the order in which they were pressed."""
        patience_s = REPEAT_S if self._repeats and not self._reports_releases else FIRST_S
        if now_s - self._heard_s > patience_s:
            self.let_go()
        return list(self._held)

    def let_go(self) -> None:
        """Treat all keys as released."""
        self._held.clear()
        self._repeats = False
