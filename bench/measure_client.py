# SPDX-License-Identifier: MIT
"""What the client's state machine costs: a status, what it refuses, and many clients."""

import json

import figures

ABOUT = (
    "Nanoseconds of processor time for `receive` and the `poll_transmit` after it: median of the "
    "repetitions, and their smallest and largest. `N clients`: a differential status through each "
    "of N clients in turn, in one process."
)
ONE_CLIENT = 60  # ns: what a status through the client should cost at most


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
        times.sort()
        values[name] = [round(t, 2) for t in (times[len(times) // 2], times[0], times[-1])]
    return values, payload_bytes


def place(item):
    """Order of rows: statuses, what is refused, many clients, payloads; numbers by size."""
    group, case = item[0]
    groups = ("status", "refused", "poll", "clients", "payload")
    return groups.index(group), int(case) if case.isdigit() else 0, case


def main():
    given = figures.arguments(__doc__)
    values, payload_bytes = measure(given.build, given.quick)
    part = figures.Part("client", "Client", ABOUT, [])
    one = values["clients", "1"][0]
    for (group, case), (value, low, high) in sorted(values.items(), key=place):
        more = {"low": low, "high": high}
        if group == "status":
            more["aim"] = ONE_CLIENT
        elif group == "clients" and case != "1":
            # 256 clients of 2 kB are within a second-level cache, 4096 beyond it.
            more["aim"] = round(one * (1.1 if int(case) <= 256 else 2), 2)
            more["note"] = f"× {value / one:.2f} of one client"
        if group == "payload":
            continue
        name = {"status": f"status, {case}", "clients": f"{case} clients"}.get(group, case)
        part.add(name, "roburoc4", "ns", value, **more)
    part.write(given.out)
    payload = figures.Part(
        "payload",
        "Growth: payload",
        "An IO card's status of so many bytes, decoded and every analog input copied out.",
        [],
    )
    for (group, case), (value, low, high) in sorted(values.items(), key=place):
        if group == "payload":
            payload.add(
                f"{payload_bytes[group, case]} bytes", "roburoc4", "ns", value, low=low, high=high
            )
    payload.write(given.out)


if __name__ == "__main__":
    main()
