# SPDX-License-Identifier: MIT
"""An LCM network for one test: a listener on all channels, and planners that command."""

import random
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import lcm
import roburoc4_lcm
from processes import Program, until

# Outputs, by the end of their channels' names.
OUTPUTS = {
    "DIFFERENTIAL": roburoc4_lcm.differential_status_t,
    "LOCALIZATION": roburoc4_lcm.localization_status_t,
    "BATTERY": roburoc4_lcm.battery_status_t,
    "TELEMETER": roburoc4_lcm.telemeter_status_t,
    "IOCARD": roburoc4_lcm.iocard_status_t,
    "PROPERTIES": roburoc4_lcm.robot_properties_t,
    "BRIDGE_STATE": roburoc4_lcm.bridge_state_t,
    "BRIDGE_STATISTICS": roburoc4_lcm.bridge_statistics_t,
    "MOVE_STATUS": roburoc4_lcm.move_status_t,
}


class Message(NamedTuple):
    time_us: int
    """When this process received it, in epoch microseconds."""
    channel: str
    data: bytes


def now_us() -> int:
    return time.time_ns() // 1000


def free_port() -> int:
    """A free port below the system's ephemeral ports."""
    while True:
        port = random.randrange(20000, 32000)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                continue
            return port


class Bus:
    """An LCM network on this machine only (ttl 0), on a port of its own."""

    def __init__(self) -> None:
        self.port = free_port()
        self.group = "239.255.76.67"
        self.url = f"udpm://{self.group}:{self.port}?ttl=0"
        self.messages: list[Message] = []
        self._listen()

    def _listen(self) -> None:
        self._lcm = lcm.LCM(self.url)
        self._lcm.subscribe(".*", self._hear).set_queue_capacity(0)
        self._ended = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended = True
        self._thread.join()

    @contextmanager
    def deaf(self) -> Iterator[None]:
        """Stop listening for a while: LCM's Python module crashes on some packets."""
        self.close()
        del self._lcm
        yield
        self._listen()

    def _run(self) -> None:
        while not self._ended:
            self._lcm.handle_timeout(50)

    def _hear(self, channel: str, data: bytes) -> None:
        if channel != "LCM_SELF_TEST":
            self.messages.append(Message(now_us(), channel, data))

    def publish(self, channel: str, data: bytes) -> None:
        self._lcm.publish(channel, data)

    def of(self, channel: str) -> list[Message]:
        return [message for message in list(self.messages) if message.channel == channel]

    def decoded(self, channel: str) -> list[Any]:
        """All messages of a channel that ends in one of OUTPUTS."""
        kind = next(kind for end, kind in OUTPUTS.items() if channel.endswith("_" + end))
        return [kind.decode(message.data) for message in self.of(channel)]

    def last(self, channel: str) -> Any:
        found = self.decoded(channel)
        return found[-1] if found else None

    def hears(self, channel: str, seconds: float = 10.0) -> None:
        """Wait for the first message of a channel."""
        until(lambda: self.of(channel), f"a message on {channel}", seconds)

    def raw(self, packet: bytes) -> None:
        """Send a UDP packet with any content, as LCM would."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
            end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            end.sendto(packet, (self.group, self.port))


def drive_command(linear_m_s: float, *, sender: str = "planner", utime: int | None = None) -> Any:
    command = roburoc4_lcm.drive_command_t()
    command.utime = now_us() if utime is None else utime
    command.sender = sender
    command.linear_m_s = linear_m_s
    return command


class Planner(Program):
    """planner.py as a process, which can be killed or stopped."""

    def __init__(self, python: str, folder: Path, bus: Bus, **options: object) -> None:
        self.sender = str(options.get("sender", "planner"))
        arguments = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
        super().__init__(
            folder / f"{self.sender}.log",
            python,
            Path(__file__).with_name("planner.py"),
            bus.url,
            *arguments,
        )
