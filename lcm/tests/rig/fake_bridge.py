# SPDX-License-Identifier: MIT
"""A bridge's states for roburoc4 doctor, until it is ended. See --help."""

import argparse
import select
import socket
import struct
import time

import roburoc4_lcm

IP_RECVTTL = 12  # of Linux; Python has no name for it


def open_ear(group: str, port: int) -> socket.socket:
    ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    ear.setsockopt(socket.IPPROTO_IP, IP_RECVTTL, 1)
    ear.bind(("", port))
    member = socket.inet_aton(group) + socket.inet_aton("0.0.0.0")
    ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
    return ear


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--least-ttl", type=int, default=0, help="it hears commands with this one")
    parser.add_argument("--ahead-s", type=float, default=0.0, help="its clock is so far ahead")
    parser.add_argument("--lose", type=int, default=0, help="packets that are lost before a state")
    options = parser.parse_args()
    ear = open_ear("239.255.76.67", 7667)
    state = roburoc4_lcm.bridge_state_t()
    number = 0
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    while True:
        state.utime = int((time.time() + options.ahead_s) * 1e6)
        number += 1 + options.lose
        head = struct.pack(">II", 0x4C433032, number) + b"ROBUROC4_BRIDGE_STATE\0"
        end.sendto(head + state.encode(), ("239.255.76.67", 7667))
        while select.select([ear], [], [], 0.2)[0]:
            packet, about, _, _ = ear.recvmsg(65535, 1024)
            (ttl,) = (
                struct.unpack("i", data)[0] for _, kind, data in about if kind == socket.IP_TTL
            )
            channel, _, data = packet[8:].partition(b"\0")
            if channel == b"ROBUROC4_DRIVE_CMD" and ttl >= options.least_ttl:
                state.rejected_sender = roburoc4_lcm.drive_command_t.decode(data).sender
                break


if __name__ == "__main__":
    main()
