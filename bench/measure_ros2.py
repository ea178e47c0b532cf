# SPDX-License-Identifier: MIT
"""Measure the ROS 2 node: its share of a core, and how long a command takes to the robot.

The node, a simulator, and a publisher of cmd_vel over CycloneDDS, as real processes on the loopback
interface; datagrams between node and simulator pass through this program, which notes when.
"""

import contextlib
import pathlib
import platform
import random
import re
import select
import socket
import struct
import subprocess
import sys
import threading
import time
from importlib import metadata

from figures import Part, arguments, median_interval

from roburoc4_ros2.participant import Participant
from roburoc4_tools.ros.cdr import Cdr
from roburoc4_tools.ros.published import Profile

PERIOD_S = 0.05
DIFFERENTIAL_ID = 6
COMMAND = struct.Struct("<BHff")


class Cable(threading.Thread):
    """Passes datagrams on, and remembers when each new speed passed."""

    def __init__(self, robot):
        super().__init__(daemon=True)
        self.node, self.robot = (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _end in range(2)
        )
        self.node.bind(("127.0.0.1", 0))
        self.robot.connect(robot)
        self.passed_s = {}

    def run(self):
        client = None
        while True:
            for end in select.select([self.node, self.robot], [], [])[0]:
                data, sender = end.recvfrom(2048)
                if end is self.robot:
                    self.node.sendto(data, client)
                    continue
                now_s, client = time.monotonic(), sender
                self.robot.send(data)
                if len(data) == COMMAND.size and data[0] == 0xFF:
                    self.passed_s.setdefault(COMMAND.unpack(data)[2], now_s)


@contextlib.contextmanager
def program(*command, **options):
    process = subprocess.Popen([str(part) for part in command], text=True, **options)
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def cpu_s(process):
    """Return the processor time of all threads."""
    tasks = pathlib.Path(f"/proc/{process.pid}/task").glob("*/schedstat")
    return sum(int(task.read_text().split()[0]) for task in tasks) / 1e9


def busy(node, work):
    """Return the node's percentage of a core while this is done."""
    begun_s, before_s = time.monotonic(), cpu_s(node)
    work()
    return 100 * (cpu_s(node) - before_s) / (time.monotonic() - begun_s)


def publish(publisher, count, sent_s):
    """Publish speeds, each of which is another one; fill in when."""
    luck = random.Random(1)
    for number in range(count):
        sign = -1 if number // 40 % 2 else 1  # to and fro, as there are walls
        speed = struct.unpack("<f", struct.pack("<f", sign * (0.2 + 1e-5 * number)))[0]
        message = bytes(Cdr().header(time.time(), "").numbers("d", speed, *[0.0] * 5).data)
        sent_s[speed] = time.monotonic()
        publisher.publish(message)
        time.sleep(PERIOD_S * luck.uniform(0.8, 1.2))


def measure(folder, seconds):
    part = Part(
        "ros2",
        "ROS 2 node",
        "One robot with all topics, as by default, and a node that publishes `cmd_vel` 20 times a "
        "second. From its `write` to the robot's socket, both in one process. Real processes, "
        "CycloneDDS on the loopback interface.",
        [f"cyclonedds {metadata.version('cyclonedds')}", f"Python {platform.python_version()}"],
    )
    domain = random.randrange(100, 200)
    sent_s = {}
    with program(folder / "roburoc4-sim", "--port", 0, stdout=subprocess.PIPE) as simulator:
        port = int(re.search(r"127\.0\.0\.1:(\d+)", simulator.stdout.readline())[1])
        cable = Cable(("127.0.0.1", port))
        cable.start()
        command = pathlib.Path(sys.executable).with_name("roburoc4")
        own = f"127.0.0.1:{cable.node.getsockname()[1]}"
        options = ["--domain", domain, "--interface", "lo", "--enable-drive"]
        with program(
            command,
            "ros2",
            "--robot",
            own,
            *options,
            stderr=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        ) as node:
            participant = Participant(domain, interface="lo")
            ours = participant.node("/", "bench")
            publisher = ours.publisher("cmd_vel", "geometry_msgs/TwistStamped", Profile(10))
            participant.announce()
            time.sleep(8.0)
            watching = busy(node, lambda: time.sleep(seconds))
            count = int(seconds / PERIOD_S)
            driving = busy(node, lambda: publish(publisher, count, sent_s))
            participant.close()
    took_ms = [
        1000 * (cable.passed_s[v] - at_s) for v, at_s in sent_s.items() if v in cable.passed_s
    ]
    if len(took_ms) < 0.9 * count:
        sys.exit(
            f"measure_ros2: {len(took_ms)} of {count} commands arrived; is the machine overloaded?"
        )
    middle, low, high = (round(value, 2) for value in median_interval(took_ms))
    late = round(sorted(took_ms)[int(0.99 * len(took_ms))], 2)
    part.add("processor, watching", "roburoc4", "% of a core", round(watching, 2), aim=2.7)
    part.add("processor, driven", "roburoc4", "% of a core", round(driving, 2))
    part.add("cmd_vel to robot, p50", "roburoc4", "ms", middle, low=low, high=high, aim=0.8)
    part.add("cmd_vel to robot, p99", "roburoc4", "ms", late, note=f"{len(took_ms)} commands")
    return part


def main():
    options = arguments(__doc__)
    part = measure(options.build / "bin", 3.0 if options.quick else 30.0)
    for row in part.results:
        print(f"{row['name']:28} {row['value']:8} {row['unit']}")
    part.write(options.out)


if __name__ == "__main__":
    main()
