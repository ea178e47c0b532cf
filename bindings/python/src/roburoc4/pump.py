# SPDX-License-Identifier: MIT
"""A connection with a native thread, which keeps the link alive without Python.

It never renews a drive command: if the program hangs, the robot is stopped. The thread has no
references to the objects here, so dropping the last one (the robot, and what iterates over its
events and statuses) ends it; it sends a stop sequence if needed.
"""

import contextlib

from . import _native
from .connection import Connection, EventReader, open_host
from .errors import ClosedError
from .log import Log, unwatch, watch
from .settings import Settings


class PumpConnection(Connection):
    """A pump of roburoc4_pump.h."""

    own_thread = True

    def __init__(self, host: str, settings: Settings) -> None:
        super().__init__(*open_host(host, True, settings))
        self.close_at_exit()
        self.log = Log(self)
        watch(self.log)

    def reader(self) -> EventReader:
        return EventReader(self.handle)

    def sleep(self, seconds: float) -> None:
        self.reader().wait(0, seconds)

    def close(self) -> None:
        open_here = not self.closed
        if open_here:
            self.log.end()
        with contextlib.suppress(ClosedError):  # a forked child has nothing to end
            _native.roburoc4_pump_close(self.handle)
        if open_here:
            unwatch()
        self.end_recording()
