# SPDX-License-Identifier: MIT
"""Move half a metre ahead through the bridge, and print how that ended, or why it rejects that."""

import sys
import time

import lcm
from roburoc4_lcm import bridge_state_t, move_command_t, move_status_t

network, command, states, statuses = lcm.LCM(), move_command_t(), [], []
command.sender, command.move_id = f"move.py {time.time_ns()}", 1
command.kind, command.distance_m = command.KIND_BY, 0.5


def show(channel: str, data: bytes) -> None:
    status = move_status_t.decode(data)
    if status.sender == command.sender:
        statuses.append(status)


network.subscribe("ROBUROC4_MOVE_STATUS", show)
network.subscribe(
    "ROBUROC4_BRIDGE_STATE", lambda _, data: states.append(bridge_state_t.decode(data))
)
end = time.monotonic() + 1
while time.monotonic() < end:  # a bridge that has just started drives only after a pause
    network.handle_timeout(50)
if not states:
    sys.exit("move.py: no bridge on this LCM network: start roburoc4-lcm with --enable-drive")
begun = time.monotonic()
while not (statuses and statuses[-1].outcome):
    command.utime = time.time_ns() // 1000  # old commands are rejected
    network.publish("ROBUROC4_MOVE_CMD", command.encode())
    network.handle_timeout(50)
    if states[-1].rejected_sender == command.sender:
        sys.exit(f"move.py: the bridge rejects the command: {states[-1].rejected_message}")
    if not statuses and time.monotonic() > begun + 0.9:
        sys.exit("move.py: the bridge hears no command: does LCM_DEFAULT_URL have its ttl here?")
    if time.monotonic() > begun + 20:
        sys.exit("move.py: the bridge has not ended the move: is it still running?")
print(statuses[-1].message)
sys.exit(statuses[-1].outcome != statuses[-1].OUTCOME_REACHED)
