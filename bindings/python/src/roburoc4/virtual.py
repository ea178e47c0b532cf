# SPDX-License-Identifier: MIT
"""Connections in virtual time: the world of roburoc4_sim.h moves datagrams and the clock."""

import math
import threading
import weakref
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec

from . import _native
from .manual import ManualConnection
from .settings import Settings, config_of

_P = ParamSpec("_P")


class World:
    """One simulated robot, its clients and the networks between them; one thread at a time."""

    def __init__(self, simulation: "_native.Simulation") -> None:
        self.lock = threading.RLock()
        self.simulation = simulation
        self.closed = False
        self._connections: weakref.WeakValueDictionary[int, VirtualConnection] = (
            weakref.WeakValueDictionary()
        )

    @property
    def now_us(self) -> int:
        """The time."""
        return _native.roburoc4_world_now_us(self.simulation)

    def add(self, number: int, connection: "VirtualConnection") -> None:
        """Keep the statuses and events of a client that joined."""
        self._connections[number] = connection

    def _step(self, end_us: int) -> bool:
        """Let time go on to the next news of a client; whether there were any."""
        number, datagram = _native.roburoc4_world_step(self.simulation, end_us)
        connection = self._connections.get(number)
        if connection is not None:
            connection.collect(datagram)
        return number != 0

    def run(self, end_us: int, until: Callable[[], object] = lambda: False) -> None:
        """Let time pass to ``end_us``, or until something is true."""
        with self.lock:
            self.exchange()
            while self.now_us < end_us and not self.closed and not until():
                self._step(end_us)
            self.exchange()

    def exchange(self) -> None:
        """Carry all that can arrive at this moment."""
        with self.lock:
            while self._step(self.now_us):
                pass


class VirtualConnection(ManualConnection):
    """A client in a world's time."""

    def __init__(self, world: World, settings: Settings) -> None:
        with world.lock:
            handle = _native.connect_virtual(world.simulation, config_of(settings))
            super().__init__(handle, settings)
            self.address = "the simulator"
            self.lock = world.lock
            self._world = world
            self._watchdog_us = settings.get("robot_watchdog_ms", 1000) * 1000
            world.add(_native.connection_number(handle), self)
            world.exchange()

    def __del__(self) -> None:
        # Time does not go on because of garbage: one zero is sent, the watchdog does the rest.
        if hasattr(self, "_watchdog_us") and not self._world.closed:
            with self.lock:
                self.disarm_for_good()

    def unlock_in_child(self) -> None:
        super().unlock_in_child()
        self._world.lock = self.lock

    @property
    def closed(self) -> bool:
        return self._world.closed or super().closed

    def command(
        self,
        function: "Callable[Concatenate[_native.Connection, _P], Any]",
        *arguments: _P.args,
        **names: _P.kwargs,
    ) -> None:
        with self.lock:
            if self._world.closed:
                self.check_open()
            try:
                super().command(function, *arguments, **names)
            finally:
                self.flush()

    def flush(self) -> None:
        self._world.exchange()

    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        self.check_open()
        # At least a microsecond, or who waits for the rest of a rounded time waits forever.
        self._world.run(self._world.now_us + max(0, math.ceil(seconds * 1e6)), until)

    def _leave(self) -> None:
        if not self._world.closed:
            self._world.run(self._world.now_us + 2 * self._watchdog_us, self._is_idle)
