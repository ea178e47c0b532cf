# SPDX-License-Identifier: MIT
"""Measure the client's hottest calls: keep the figures that bench/client-cost prints."""

import re

import figures

ABOUT = (
    "Machine instructions of x86-64 at -O2, counted by callgrind without the kernel; they do not "
    "depend on what else the machine does. By `bench/client-cost`."
)
CALLS = {
    "receive-differential": "receive a differential status",
    "receive-iocard": "receive an IO card's status",
    "receive-battery": "receive a battery status",
    "poll-idle": "poll with nothing due",
    "renew": "renew a lease",
    "facts": "read the facts",
    "watching": "all calls for each status, watching",
    "driving": "all calls for each status, driving",
    "udp-differential": "differential status through the UDP adapter",
}


def main():
    given = figures.arguments(__doc__)
    tools = [figures.first_line("gcc", "--version"), figures.packaged("valgrind")]
    part = figures.Part("client_cost", "Client: instructions", ABOUT, tools)
    counted = figures.run(figures.BENCH / "client-cost")
    for kind, count, aim in re.findall(r"^(\S+) +(\d+) +(\d+|-)$", counted, re.MULTILINE):
        part.add(
            CALLS[kind],
            "roburoc4",
            "instructions",
            int(count),
            aim=None if aim == "-" else int(aim),
        )
    part.write(given.out)


if __name__ == "__main__":
    main()
