# SPDX-License-Identifier: MIT
"""roburoc4-lcm as a process."""

from pathlib import Path
from typing import Any, Self

from .bus import Bus
from .process import Program
from .programs import Programs
from .waiting import until


class Bridge(Program):
    """A bridge of one robot, on channels that begin with ``prefix``."""

    def __init__(
        self,
        programs: Programs,
        folder: Path,
        bus: Bus,
        robot: str,
        *options: str,
        environment: dict[str, str] | None = None,
    ) -> None:
        self.bus = bus
        self.prefix = "ROBUROC4"
        super().__init__(
            folder / "bridge.log",
            programs("roburoc4-lcm"),
            "--lcm-url",
            bus.url,
            "--robot",
            robot,
            *options,
            environment=environment,
        )

    def channel(self, end: str) -> str:
        return f"{self.prefix}_{end}"

    @property
    def status(self) -> Any:
        """The last bridge_status_t, or None."""
        return self.bus.last(self.channel("BRIDGE_STATUS"))

    def connects(self, seconds: float = 10.0) -> Self:
        """Wait until statuses of all five services are on the bus."""
        channels = [
            self.channel(end)
            for end in ("DIFFERENTIAL", "LOCALIZATION", "BATTERY", "TELEMETER", "IOCARD")
        ]

        def connected() -> bool:
            assert self.running, f"the bridge ended with {self.process.returncode}:\n{self.output}"
            return all(self.bus.of(channel) for channel in channels)

        until(connected, "statuses of all services are on the bus", seconds)
        return self

    def arms(self) -> Self:
        """Wait until the next drive command would drive.

        On a machine that is too busy to read statuses in time it may have been armed and disarmed
        since; then the next command arms it again.
        """
        self.connects()

        def ready() -> bool:
            status = self.status
            return status and (status.armed or ("armed: " in self.output and not status.waiting))

        until(
            ready,
            f"the bridge arms; it said:\n{self.output}",
        )
        return self
