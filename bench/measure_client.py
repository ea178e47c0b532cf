# SPDX-License-Identifier: MIT
"""Measure the client: its time, its instructions, many clients, and growing payloads."""

import json
import re

import figures

ABOUT = (
    "Nanoseconds of processor time for `receive` and the `poll_transmit` after it: median of the "
    "repetitions, and its 95 % interval. `N clients`: a differential status through each of N "
    "clients in turn, in one process; its ratio to one client, with an interval as wide as both "
    "allow."
)


ABOUT_COST = (
    "Machine instructions of x86-64 at -O2, counted by callgrind without the kernel; they do not "
    "depend on what else the machine does. By `bench/client-cost`."
)
CALLS = {
    "receive-differential": "receive a differential status",
    "receive-iocard": "receive an IO card's status",
    "receive-battery": "receive a battery status",
    "poll-idle": "poll with nothing due",
    "udp-differential": "differential status through the UDP adapter",
    "udp-recorded": "differential status through the UDP adapter, recorded",
}


def measure(build, quick):
    options = ["--benchmark_format=json", "--benchmark_enable_random_interleaving=true"]
    options += (
        ["--benchmark_min_time=0.001"]
        if quick
        else ["--benchmark_min_time=0.05", "--benchmark_repetitions=15"]
    )
    samples, payload_bytes = {}, {}
    for one in json.loads(figures.run(build / "bin/client_bench", *options))["benchmarks"]:
        if one["run_type"] == "iteration":
            group, case = one["name"].split("/", 1)
            samples.setdefault((group, case.split("/repeats")[0]), []).append(one["cpu_time"])
            if "bytes" in one:
                payload_bytes[group, case.split("/repeats")[0]] = int(one["bytes"])
    values = {}
    for name, times in samples.items():
        values[name] = [round(t, 2) for t in figures.median_interval(times)]
    return values, payload_bytes


def place(item):
    """Sort key of rows: statuses, rejected datagrams, many clients, payloads; numbers by size."""
    group, case = item[0]
    groups = ("status", "refused", "poll", "clients", "payload")
    return groups.index(group), int(case) if case.isdigit() else 0, case


def main():
    given = figures.arguments(__doc__)
    values, payload_bytes = measure(given.build, given.quick)
    versions = [figures.compiler(given.build), figures.packaged("libbenchmark-dev")]
    part = figures.Part("client", "Client: time", ABOUT, versions)
    one = values["clients", "1"]
    for (group, case), (value, low, high) in sorted(values.items(), key=place):
        if group == "payload":
            continue
        many = f"{case} client" + ("" if case == "1" else "s")
        name = {"status": f"status, {case}", "clients": many}.get(group, case)
        part.add(name, "roburoc4", "ns", value, low=low, high=high)
        if group == "clients" and case != "1":
            part.add(
                f"{many}, ratio to one",
                "roburoc4",
                "×",
                round(value / one[0], 3),
                low=round(low / one[2], 3),
                high=round(high / one[1], 3),
                # 256 clients of 2 kB are within a second-level cache, 4096 beyond it.
                aim=1.1 if int(case) <= 256 else 2,
            )
    part.write(given.out)
    payload = figures.Part(
        "payload",
        "Growth: payload",
        "An IO card's status of so many bytes, decoded and every analog input copied out: "
        "nanoseconds, median of the repetitions, and its 95 % interval.",
        versions,
    )
    for (group, case), (value, low, high) in sorted(values.items(), key=place):
        if group == "payload":
            payload.add(
                f"{payload_bytes[group, case]} bytes", "roburoc4", "ns", value, low=low, high=high
            )
    payload.write(given.out)
    tools = [figures.first_line("gcc", "--version"), figures.packaged("valgrind")]
    cost = figures.Part("client_cost", "Client: instructions", ABOUT_COST, tools)
    counted = figures.run(figures.BENCH / "client-cost")
    for kind, count, aim in re.findall(r"^(\S+) +(\d+) +(\d+)$", counted, re.MULTILINE):
        cost.add(CALLS[kind], "roburoc4", "instructions", int(count), aim=int(aim))
    cost.write(given.out)


if __name__ == "__main__":
    main()
