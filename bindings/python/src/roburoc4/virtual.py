# SPDX-License-Identifier: MIT
"""Connections in virtual time: roburoc4_sim.h moves the datagrams and the clock."""

import math
from collections.abc import Callable

from . import _native
from .connection import open_alone
from .constants import Result
from .errors import ArgumentError
from .manual import ManualConnection
from .settings import Settings

_SLICE_US = 1_000_000
"""Time passes in slices, between which Python notices Ctrl-C."""


def run(
    simulation: "_native.Simulation", seconds: float, until: Callable[[], object] = lambda: False
) -> None:
    """Let virtual time pass, at most until something is true."""
    # At least a microsecond, or a caller that waits for the rest of a rounded time would never
    # finish.
    end_us = _native.simulation_now_us(simulation) + max(0, math.ceil(seconds * 1e6))
    _native.simulation_exchange(simulation)
    while (now_us := _native.simulation_now_us(simulation)) < end_us and not until():
        if _native.simulation_stopped(simulation):
            return
        _native.simulation_step(simulation, min(end_us, now_us + _SLICE_US))
    _native.simulation_exchange(simulation)


class VirtualConnection(ManualConnection):
    """A client in a simulation's time."""

    def __init__(self, simulation: "_native.Simulation", settings: Settings) -> None:
        if settings.get("record") is not None:
            raise ArgumentError(
                "record: nothing is sent over UDP in virtual time: connect to a Simulator that "
                "serves a port",
                Result.CONFIG,
            )
        super().__init__(open_alone(settings), "the simulator", settings)
        _native.connection_join(self.handle, simulation)
        self._simulation = simulation

    def __del__(self) -> None:
        # Garbage collection must not move time: one zero is sent, the watchdog does the rest.
        if hasattr(self, "_simulation"):
            self.disarm_for_good()

    @property
    def closed(self) -> bool:
        return bool(_native.simulation_stopped(self._simulation)) or super().closed

    def move(self, seconds: float, until: Callable[[], object]) -> None:
        self.check_open()
        run(self._simulation, seconds, until)

    def leave(self) -> None:
        run(self._simulation, 2 * self.watchdog_s, self.is_idle)
