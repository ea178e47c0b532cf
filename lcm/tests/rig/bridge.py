# SPDX-License-Identifier: MIT
"""roburoc4-lcm as a process."""

from pathlib import Path
from typing import Any, Self

from processes import Program, Programs, until

from .bus import Bus


class Bridge(Program):
    """A bridge of one robot, or of those of a file (``--config``)."""

    def __init__(
        self,
        programs: Programs,
        folder: Path,
        bus: Bus,
        robot: str | None,
        *options: str,
    ) -> None:
        self.bus = bus
        super().__init__(
            folder / "bridge.log",
            programs("roburoc4-lcm"),
            "--lcm-url",
            bus.url,
            *(("--robot", robot) if robot else ()),
            *options,
        )

    @property
    def state(self) -> Any:
        """The last bridge_state_t, or None."""
        return self.bus.last("ROBUROC4_BRIDGE_STATE")

    @property
    def statistics(self) -> Any:
        """A bridge_statistics_t published from now on: it counts everything until now."""
        channel = "ROBUROC4_BRIDGE_STATISTICS"
        before = len(self.bus.of(channel))
        until(lambda: len(self.bus.of(channel)) > before, "statistics")
        return self.bus.last(channel)

    def connects(self, seconds: float = 10.0) -> Self:
        """Wait until statuses of all five services are on the bus."""
        channels = [
            f"ROBUROC4_{end}"
            for end in ("DIFFERENTIAL", "LOCALIZATION", "BATTERY", "TELEMETER", "IOCARD")
        ]

        def connected() -> bool:
            assert self.running, f"the bridge ended with {self.process.returncode}:\n{self.output}"
            return all(self.bus.of(channel) for channel in channels)

        until(connected, "statuses of all services are on the bus", seconds)
        return self

    def arms(self) -> Self:
        """Wait until the next drive command would drive."""
        self.connects()
        until(
            lambda: self.state and self.state.can_drive,
            f"the robot can be driven; the bridge said:\n{self.output}",
        )
        return self
