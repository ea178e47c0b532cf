# SPDX-License-Identifier: MIT
"""A planner: commands one speed repeatedly until it is ended. See --help."""

import argparse
import time

import lcm
import roburoc4_lcm


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("url")
    parser.add_argument("--sender", default="planner")
    parser.add_argument("--channel", default="ROBUROC4_DRIVE_CMD")
    parser.add_argument("--linear", type=float, default=0.3)
    parser.add_argument("--angular", type=float, default=0.0)
    options = parser.parse_args()

    network = lcm.LCM(options.url)
    command = roburoc4_lcm.drive_command_t()
    command.sender = options.sender
    command.linear_m_s = options.linear
    command.angular_rad_s = options.angular
    print("planning", flush=True)
    while True:
        command.utime = time.time_ns() // 1000
        network.publish(options.channel, command.encode())
        time.sleep(0.05)


if __name__ == "__main__":
    main()
