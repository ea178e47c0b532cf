# SPDX-License-Identifier: MIT
"""Many planners, good ones and bad ones, for the robots R0, R1, ... until it is ended.

Each sender uses its own speeds, so that the speed shows who drives.
"""

import argparse
import math
import random
import time
from collections import deque
from dataclasses import dataclass

import lcm
import roburoc4_lcm

TURN_S = 0.1
REMEMBERED_S = 3.0


@dataclass
class Planner:
    name: str
    robot: int
    speed: float
    stubborn: bool = False
    until_s: float = 0.0
    streams: bool = False

    def turn(self, luck: random.Random, now_s: float) -> bool:
        """Whether it commands now: it streams for seconds, and pauses, unless it is stubborn."""
        if now_s >= self.until_s:
            self.streams = self.stubborn or not self.streams
            self.until_s = (
                now_s + luck.uniform(1, 5) if self.streams else now_s + luck.uniform(0.6, 4)
            )
        return self.streams


def drive(planner: Planner, now_s: float, **other: float) -> roburoc4_lcm.drive_command_t:
    command = roburoc4_lcm.drive_command_t()
    command.utime = round((now_s - other.get("age_s", 0.0)) * 1e6)
    command.sender = planner.name
    command.linear_m_s = other.get("linear", planner.speed)
    return command


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("url")
    parser.add_argument("--robots", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    luck = random.Random(options.seed)
    network = lcm.LCM(options.url)
    planners = [
        Planner(f"planner {robot}", robot, 0.2 + 0.001 * robot) for robot in range(options.robots)
    ]
    planners += [  # every third robot has a rival, every tenth a planner that never pauses
        Planner(f"rival {robot}", robot, 0.4 + 0.001 * robot)
        for robot in range(0, options.robots, 3)
    ]
    planners += [
        Planner(f"stubborn {robot}", robot, 0.6 + 0.001 * robot, stubborn=True)
        for robot in range(9, options.robots, 10)
    ]
    sent: deque[tuple[float, str, bytes]] = deque()
    print("planning", flush=True)
    next_s = time.time()
    while True:
        now_s = time.time()
        for planner in planners:
            if planner.turn(luck, now_s):
                channel, message = (
                    f"R{planner.robot}_DRIVE_CMD",
                    drive(planner, time.time()).encode(),
                )
                network.publish(channel, message)
                if luck.random() < 0.05:
                    sent.append((now_s + REMEMBERED_S, channel, message))
        while sent and sent[0][0] <= now_s:  # a log that is replayed
            network.publish(*sent.popleft()[1:])
        some = luck.choice(planners)
        for bad in (
            drive(some, now_s, age_s=10.0, linear=0.9),
            drive(some, now_s, age_s=-10.0, linear=0.91),
            drive(some, now_s, linear=math.nan),
        ):
            bad.sender = "nonsense"
            network.publish(f"R{some.robot}_DRIVE_CMD", bad.encode())
        if luck.random() < 0.05:
            stop = roburoc4_lcm.stop_command_t()
            stop.sender = "operator"
            network.publish(f"R{luck.randrange(options.robots)}_STOP_CMD", stop.encode())
        next_s += TURN_S
        time.sleep(max(0.0, next_s - time.time()))


if __name__ == "__main__":
    main()
