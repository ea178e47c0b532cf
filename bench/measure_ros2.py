# SPDX-License-Identifier: MIT
"""Measure the ROS 2 node: how long a status takes to become a DDS sample, and what it costs.

Called by scripts/test-ros2 --bench, which has its programs: a simulated robot, a relay before it
that notes when it passes each datagram on, the node, and a subscriber on Fast DDS that notes when
it has each sample; real processes, in a network namespace of their own.
"""

import pathlib
import re
import select
import socket
import sys
import tempfile
import threading
import time

import figures

sys.path[:0] = [str(figures.TOP / "tests"), str(figures.TOP / "tests" / "ros2")]

from processes import Program, Programs  # noqa: E402
from ros import Listener, Node  # noqa: E402

ABOUT = (
    "From passing a datagram of the robot to the node until a subscriber on Fast DDS (reliable, as "
    "rclcpp's default) has decoded the message. Processor time is that of the whole node, which "
    "publishes all of its topics to one subscriber each."
)
SOURCES = {"odom": 5, "cmd_vel_applied": 6, "pad/joy": 2}
"""Topic -> the service whose statuses it is made from."""


class Relay:
    """Passes datagrams on, and notes when it did so with each status."""

    def __init__(self, robot: str) -> None:
        host, port = robot.rsplit(":", 1)
        self._robot = (host, int(port))
        self._front, self._back = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in "ab")
        self._front.bind(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._front.getsockname()[1]}"
        self.left_us: dict[int, list[float]] = {}
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        client = None
        while True:
            for end in select.select([self._front, self._back], [], [])[0]:
                data, sender = end.recvfrom(65536)
                if end is self._front:
                    client = sender
                    self._back.sendto(data, self._robot)
                elif client:
                    if data[0] == 0xFF:
                        self.left_us.setdefault(data[1], []).append(time.time_ns() / 1000)
                    self._front.sendto(data, client)


def percentile(values: list[float], share: float) -> float:
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def delays(listener: Listener, topic: str, left_us: list[float]) -> list[float]:
    """Return the microseconds from the last datagram before each sample to the sample."""
    found, index = [], 0
    for sample in listener.samples(topic):
        while index + 1 < len(left_us) and left_us[index + 1] < sample.time_us:
            index += 1
        if left_us and left_us[index] < sample.time_us:
            found.append(sample.time_us - left_us[index])
    return found


def cpu_s(node: Node) -> float:
    """Return the processor time of all threads."""
    tasks = pathlib.Path(f"/proc/{node.process.pid}/task").glob("*/schedstat")
    return sum(int(task.read_text().split()[0]) for task in tasks) / 1e9


def measure(part: figures.Part, robots: int, seconds: float) -> None:
    """Measure a node with this many robots, the first of them behind the relay."""
    folder = pathlib.Path(tempfile.mkdtemp())
    simulator = Program(
        folder / "sim.log", Programs()("roburoc4-sim"), "--port", "0", "--robots", str(robots)
    )
    simulator.says("ready")
    addresses = re.findall(r"127\.0\.0\.1:\d+", simulator.output)
    relay = Relay(addresses[0])
    addresses[0] = relay.address
    listener = Listener(folder / "listen.log", 30)
    names = [f"R{index}={address}" for index, address in enumerate(addresses)]
    node = Node(folder, 30, *[word for name in names for word in ("--robot", name)])
    listener.hears("rt/R0/odom", 30)
    time.sleep(4)
    begun, before = time.monotonic(), cpu_s(node)
    time.sleep(seconds)
    share = (cpu_s(node) - before) / (time.monotonic() - begun)
    rate = f"{71 * robots} statuses a second"
    part.add(f"{rate}: processor", "roburoc4", "% of a core", round(100 * share, 2))
    for topic, service in SOURCES.items():
        times = delays(listener, f"rt/R0/{topic}", relay.left_us[service])
        for share, word in ((0.5, "p50"), (0.99, "p99")):
            part.add(
                f"{rate}: datagram to {topic}, {word}",
                "roburoc4",
                "us",
                round(percentile(times, share)),
                note=f"of {len(times)}",
            )
    for program in (node, listener, simulator):
        program.end()


def main() -> None:
    given = figures.arguments(__doc__)
    part = figures.Part("ros2", "ROS 2 node", ABOUT, [figures.packaged("libfastrtps-dev")])
    for robots in (1, 5):
        measure(part, robots, 3 if given.quick else 20)
    part.write(given.out)


if __name__ == "__main__":
    main()
