# SPDX-License-Identifier: MIT
"""Move half a metre ahead through the bridge, and print how that ended."""

import time

import lcm
from roburoc4_lcm import move_command_t, move_status_t

network, command, statuses = lcm.LCM(), move_command_t(), []
command.sender, command.move_id = f"move.py {time.time_ns()}", 1
command.kind, command.distance_m = command.KIND_BY, 0.5
command.clearance_m = -1.0  # the default, 0.5 m


def show(channel: str, data: bytes) -> None:
    status = move_status_t.decode(data)
    if status.sender == command.sender:
        statuses.append(status)


network.subscribe("ROBUROC4_MOVE_STATUS", show)
begun = time.monotonic()
while not (statuses and statuses[-1].result) and time.monotonic() < begun + (20 if statuses else 3):
    command.utime = time.time_ns() // 1000
    network.publish("ROBUROC4_MOVE_CMD", command.encode())
    network.handle_timeout(50)
REMEDY = "not obeyed: see rejected_message, or roburoc4 doctor --lcm"
print(statuses[-1].message if statuses else REMEDY)
