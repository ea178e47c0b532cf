# SPDX-License-Identifier: MIT
"""Whether this machine was too busy for a test to mean anything."""

import threading
import time

_NAP_S = 0.01
_TOO_LATE_S = 0.1
"""The tightest promise that is tested leaves 150 ms for the machine."""


class MachineTooBusyError(Exception):
    """Not a failure: the test is to be run again. Only after several such runs it is one."""


class Strain:
    """Takes naps in a thread of its own: how long it oversleeps shows how busy the machine is."""

    def __init__(self) -> None:
        self.worst_s = 0.0
        threading.Thread(target=self._nap, daemon=True).start()

    def _nap(self) -> None:
        while True:
            begun = time.monotonic()
            time.sleep(_NAP_S)
            self.worst_s = max(self.worst_s, time.monotonic() - begun - _NAP_S)

    def begin(self) -> None:
        self.worst_s = 0.0

    def found(self) -> str:
        """What shows that the machine was too busy since begin(), or ""."""
        if self.worst_s > _TOO_LATE_S:
            return f"a nap of {_NAP_S} s took {self.worst_s:.2f} s more"
        return ""
