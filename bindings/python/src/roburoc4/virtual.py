# SPDX-License-Identifier: MIT
"""Virtual time: one simulated robot, its clients, and the network between them."""

import math
import threading
import weakref
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec

from . import _native
from .manual import ManualConnection
from .settings import Settings, config_of

_P = ParamSpec("_P")
_FLIGHTS = 4096
_LONGEST = 1472
_START_US = 1_000_000
_STUCK_US = 1_000
"""A step where somebody's deadline stays in the past."""


class Network:
    """Two channels between one client and the simulator."""

    def __init__(self, seed: int, faults: "_native.Faults") -> None:
        self.up = _native.roburoc4_sim_channel_create(faults, seed, _FLIGHTS, _LONGEST)
        self.down = _native.roburoc4_sim_channel_create(faults, seed + 1, _FLIGHTS, _LONGEST)

    def set_faults(self, faults: "_native.Faults") -> None:
        """Change both directions."""
        _native.roburoc4_sim_channel_set_faults(self.up, faults)
        _native.roburoc4_sim_channel_set_faults(self.down, faults)

    def next_deadline_us(self) -> int:
        """Return when the next datagram arrives."""
        return min(
            _native.roburoc4_sim_channel_next_deadline(self.up),
            _native.roburoc4_sim_channel_next_deadline(self.down),
        )


class World:
    """The clock, the simulator, and who talks with it."""

    def __init__(self, sim: "_native.Simulation", faults: "_native.Faults") -> None:
        self.lock = threading.RLock()
        self.sim = sim
        self.faults = faults
        self.now_us = _START_US
        self.closed = False
        self._peers = 0
        self._connections: dict[int, weakref.ref[VirtualConnection]] = {}
        _native.roburoc4_sim_advance(sim, self.now_us)

    def add(self, connection: "VirtualConnection") -> int:
        """Let a client in; return its number."""
        self._peers += 1
        self._connections[self._peers] = weakref.ref(connection)
        return self._peers

    def connections(self) -> "list[VirtualConnection]":
        """Return the clients that still live, in the order in which they came."""
        living = {peer: ref() for peer, ref in self._connections.items()}
        for peer in [peer for peer, connection in living.items() if connection is None]:
            del self._connections[peer]
        return [connection for connection in living.values() if connection is not None]

    def exchange(self) -> None:
        """Carry all that can arrive at this moment."""
        _native.roburoc4_sim_advance(self.sim, self.now_us)
        connections = self.connections()
        moved = True
        while moved:
            moved = sum(connection.send() for connection in connections) > 0
            while (sent := _native.roburoc4_sim_poll_transmit(self.sim)) is not None:
                moved = True
                ref = self._connections.get(sent[0])
                connection = ref() if ref else None
                if connection is not None:
                    _native.roburoc4_sim_channel_push(
                        connection.network.down, sent[0], sent[1], self.now_us
                    )
            moved |= sum(connection.receive() for connection in connections) > 0

    def _next_us(self, end_us: int) -> int:
        next_us = min(end_us, _native.roburoc4_sim_next_deadline(self.sim))
        for connection in self.connections():
            next_us = min(
                next_us, connection.next_deadline_us(), connection.network.next_deadline_us()
            )
        return next_us if next_us > self.now_us else min(end_us, self.now_us + _STUCK_US)

    def run(self, end_us: int, until: Callable[[], object] = lambda: False) -> None:
        """Let time pass to ``end_us``, or until something is true."""
        with self.lock:
            self.exchange()
            while self.now_us < end_us and not self.closed and not until():
                self.now_us = self._next_us(end_us)
                for connection in self.connections():
                    connection.set_time(self.now_us)
                self.exchange()


class VirtualConnection(ManualConnection):
    """A client in a world's time."""

    def __init__(self, world: World, settings: Settings) -> None:
        super().__init__(_native.connect_virtual(config_of(settings), world.now_us), settings)
        self.address = "the simulator"
        self.lock = world.lock
        self._world = world
        self._watchdog_us = settings.get("robot_watchdog_ms", 1000) * 1000
        with self.lock:
            self._peer = world.add(self)
            self.network = Network(2 * self._peer, world.faults)
            world.exchange()

    def __del__(self) -> None:
        # Time does not go on because of garbage: one zero is sent, the watchdog does the rest.
        if hasattr(self, "network") and not self._world.closed:
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

    def set_time(self, now_us: int) -> None:
        """Set the client's clock."""
        _native.connection_set_time(self.handle, now_us)

    def send(self) -> bool:
        """Push what is due, and give the simulator what has arrived; whether there was any."""
        now_us = self._world.now_us
        moved = False
        while (datagram := _native.roburoc4_client_poll_transmit(self.handle)) is not None:
            _native.roburoc4_sim_channel_push(self.network.up, self._peer, datagram, now_us)
            moved = True
        self.collect()
        while (sent := _native.roburoc4_sim_channel_poll(self.network.up, now_us)) is not None:
            _native.roburoc4_sim_receive(self._world.sim, self._peer, sent[1])
            moved = True
        return moved

    def receive(self) -> bool:
        """Take in what has arrived; whether there was any."""
        now_us = self._world.now_us
        moved = False
        while (came := _native.roburoc4_sim_channel_poll(self.network.down, now_us)) is not None:
            _native.roburoc4_client_receive(self.handle, came[1])
            self.collect(came[1])
            moved = True
        return moved

    def next_deadline_us(self) -> int:
        """Return when the client wants to be called."""
        return _native.roburoc4_client_next_deadline(self.handle)

    def flush(self) -> None:
        self.send()
        self._world.exchange()

    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        self.check_open()
        # At least a microsecond, or who waits for the rest of a rounded time waits forever.
        self._world.run(self._world.now_us + max(0, math.ceil(seconds * 1e6)), until)

    def _leave(self) -> None:
        if not self._world.closed:
            self._world.run(self._world.now_us + 2 * self._watchdog_us, self._is_idle)
