# SPDX-License-Identifier: MIT
"""Virtual time: one simulated robot, its clients, and the network between them."""

import math
import threading
import weakref
from collections.abc import Callable

from . import _native
from .constants import Result
from .engine_client import ClientEngine
from .errors import error_of
from .settings import Settings

_FLIGHTS = 4096
_LONGEST = 1472
_START_US = 1_000_000
_STUCK_US = 1_000
"""A step where somebody's deadline stays in the past."""


class Network:
    """Two channels between one client and the simulator."""

    def __init__(self, seed: int, faults: "_native.Faults") -> None:
        self.up = _native.roburoc4_sim_channel_create(faults, seed, _FLIGHTS, _LONGEST)
        self._up_owner = _native.own_channel(self.up)
        self.down = _native.roburoc4_sim_channel_create(faults, seed + 1, _FLIGHTS, _LONGEST)
        self._down_owner = _native.own_channel(self.down)

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

    def __init__(self, sim: "_native.Sim", sim_owner: object, faults: "_native.Faults") -> None:
        self.lock = threading.RLock()
        self.sim = sim
        self._sim_owner = sim_owner
        self.faults = faults
        self.now_us = _START_US
        self.closed = False
        self._peers = 0
        self._engines: dict[int, weakref.ref[SimEngine]] = {}
        _native.roburoc4_sim_advance(sim, self.now_us)

    def add(self, engine: "SimEngine") -> int:
        """Let a client in; return its number."""
        self._peers += 1
        self._engines[self._peers] = weakref.ref(engine)
        return self._peers

    def engines(self) -> "list[SimEngine]":
        """Return the clients that still live, in the order in which they came."""
        living = {peer: ref() for peer, ref in self._engines.items()}
        for peer in [peer for peer, engine in living.items() if engine is None]:
            del self._engines[peer]
        return [engine for engine in living.values() if engine is not None]

    def exchange(self) -> None:
        """Carry all that can arrive at this moment."""
        _native.roburoc4_sim_advance(self.sim, self.now_us)
        engines = self.engines()
        moved = True
        while moved:
            moved = sum(engine.send() for engine in engines) > 0
            while (sent := _native.roburoc4_sim_poll_transmit(self.sim)) is not None:
                moved = True
                ref = self._engines.get(sent[0])
                engine = ref() if ref else None
                if engine is not None:
                    _native.roburoc4_sim_channel_push(
                        engine.network.down, sent[0], sent[1], self.now_us
                    )
            moved |= sum(engine.receive() for engine in engines) > 0

    def _next_us(self, end_us: int) -> int:
        next_us = min(end_us, _native.roburoc4_sim_next_deadline(self.sim))
        for engine in self.engines():
            next_us = min(next_us, engine.next_deadline_us(), engine.network.next_deadline_us())
        return next_us if next_us > self.now_us else min(end_us, self.now_us + _STUCK_US)

    def run(self, end_us: int, until: Callable[[], object] = lambda: False) -> None:
        """Let time pass to ``end_us``, or until something is true."""
        with self.lock:
            self.exchange()
            while self.now_us < end_us and not self.closed and not until():
                self.now_us = self._next_us(end_us)
                self.exchange()


class SimEngine(ClientEngine):
    """A client in a world's time."""

    def __init__(self, world: World, settings: Settings) -> None:
        super().__init__(settings)
        self.lock = world.lock
        self._world = world
        self._watchdog_us = settings.get("robot_watchdog_ms", 1000) * 1000
        with self.lock:
            self._peer = world.add(self)
            self.network = Network(2 * self._peer, world.faults)
            self.address = "the simulator"
            self._start()
            world.exchange()

    def __del__(self) -> None:
        # Time does not go on because of garbage: one zero is sent, the watchdog does the rest.
        if not getattr(self, "_closed", True) and not self._world.closed:
            with self.lock:
                self._begin_to_leave()

    def _now_us(self) -> int:
        return self._world.now_us

    def unlock_in_child(self) -> None:
        super().unlock_in_child()
        self._world.lock = self.lock

    def check_open(self) -> None:
        super().check_open()
        if self._world.closed:
            raise error_of(Result.CLOSED)

    def send(self) -> bool:
        """Push what is due, and give the simulator what has arrived; whether there was any."""
        now_us = self._world.now_us
        moved = False
        while (datagram := _native.roburoc4_client_poll_transmit(self._client, now_us)) is not None:
            _native.roburoc4_sim_channel_push(self.network.up, self._peer, datagram, now_us)
            moved = True
        self.collect(b"")
        while (sent := _native.roburoc4_sim_channel_poll(self.network.up, now_us)) is not None:
            _native.roburoc4_sim_receive(self._world.sim, self._peer, sent[1])
            moved = True
        return moved

    def receive(self) -> bool:
        """Take in what has arrived; whether there was any."""
        now_us = self._world.now_us
        moved = False
        while (came := _native.roburoc4_sim_channel_poll(self.network.down, now_us)) is not None:
            _native.roburoc4_client_receive(self._client, came[1], now_us)
            self.collect(came[1])
            moved = True
        return moved

    def next_deadline_us(self) -> int:
        """Return when the client wants to be called."""
        return _native.roburoc4_client_next_deadline(self._client)

    def _flush(self) -> None:
        self.send()
        self._world.exchange()

    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        self.check_open()
        # At least a microsecond, or who waits for the rest of a rounded time waits forever.
        self._world.run(self._world.now_us + max(0, math.ceil(seconds * 1e6)), until)

    def _leave(self) -> None:
        if not self._world.closed:
            self._world.run(self._world.now_us + 2 * self._watchdog_us, self._is_idle)
