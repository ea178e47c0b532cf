# SPDX-License-Identifier: MIT
"""Measure how cost grows with robots in one simulator, and with services × rate in one client.

Runs in the virtual environment of scripts/bench, where the Python package is installed.
"""

import contextlib
import pathlib
import platform
import re
import socket
import struct
import subprocess
import time

import figures

ABOUT = (
    "Processor time in milliseconds for each second, of one process. *simulator*: `roburoc4-sim "
    "--robots N`, every robot sending the five services at the client's usual periods (71 statuses "
    "a second). *client*: a program with the pump, the UDP adapter and the client, for 1 to 5 "
    "services at several periods. At least 95 % of the statuses arrived."
)
LEAST = 0.95  # share of the statuses that must arrive
# service -> period in cycles of 10 ms
USUAL = {2: 5, 3: 10, 4: 100, 5: 5, 6: 5}
STATUS = 0xFF
SERVICES = ("differential", "localization", "iocard", "telemeter", "battery")


def processor_s(pid):
    """Return the processor time of a process with one thread."""
    fields = pathlib.Path(f"/proc/{pid}/schedstat").read_text(encoding="utf-8").split()
    return int(fields[0]) / 1e9


@contextlib.contextmanager
def simulator(program, robots):
    """Run a simulator; give its process id and its robots' ports."""
    process = subprocess.Popen(
        [program, "--port", "0", "--robots", str(robots)], text=True, stdout=subprocess.PIPE
    )
    try:
        ports = [int(p) for p in re.findall(r"127\.0\.0\.1:(\d+)", process.stdout.readline())]
        if len(ports) != robots:
            raise SystemExit(f"measure_growth: asked for {robots} robots, got {len(ports)}")
        yield process.pid, ports
    finally:
        process.terminate()
        process.wait()


def steady(measure, due, what, least):
    """Call measure() until enough statuses arrived, at most three times.

    It returns how many arrived, the time and the processor time. Something else may have needed the
    processor, and the cost of statuses that were lost would be missing: then return None.
    """
    for _ in range(3):
        arrived, took, used = measure()
        if arrived >= least * due:
            return arrived, took, used
    print(f"{what}: {arrived} of {due} statuses arrived: too many for this machine, or it is busy")
    return None


def count_statuses(subscriber, seconds):
    """Read for some seconds; return how many statuses arrived, and how long it took."""
    end = begun = time.monotonic()
    arrived = 0
    while end - begun < seconds:
        with contextlib.suppress(TimeoutError):
            arrived += subscriber.recv(512)[0] == STATUS
        end = time.monotonic()
    return arrived, end - begun


def many(count, what):
    return f"{count} {what}" + ("" if count == 1 else "s")


def measure_robots(part, program, counts, seconds, least):
    for robots in counts:
        with (
            simulator(program, robots) as (pid, ports),
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as subscriber,
        ):
            subscriber.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
            subscriber.settimeout(0.1)
            for port in ports:
                for service, period in USUAL.items():
                    insert = struct.pack("<BBHHB", 1, 4, 1, service, period)
                    subscriber.sendto(insert, ("127.0.0.1", port))
                time.sleep(0.0005)  # so that no queue overflows
            count_statuses(subscriber, 0.5)  # what is in the queue by now

            def measure(pid=pid, subscriber=subscriber):
                before = processor_s(pid)
                arrived, took = count_statuses(subscriber, seconds)
                return arrived, took, processor_s(pid) - before

            due = robots * sum(int(seconds * 100 / period) for period in USUAL.values())
            found = steady(measure, due, many(robots, "robot"), least)
        if found is None:
            return
        _, took, used = found
        part.add(
            many(robots, "robot"),
            "simulator",
            "ms/s",
            round(used / took * 1000, 2),
            note=f"{used / took * 1e6 / robots:.0f} us for each",
        )


def measure_services(part, program, periods_ms, seconds, least):
    import roburoc4

    with simulator(program, 1) as (_, ports):
        for count in (1, 3, 5):
            for period_ms in periods_ms:
                with roburoc4.connect(f"127.0.0.1:{ports[0]}") as robot:
                    for service in SERVICES[count:]:
                        robot.unsubscribe(service)
                    for service in SERVICES[:count]:
                        robot.subscribe(service, period_ms)
                    time.sleep(0.2)

                    def measure(robot=robot):
                        known = robot.link.received
                        before, begun = time.process_time(), time.monotonic()
                        time.sleep(seconds)
                        took, used = time.monotonic() - begun, time.process_time() - before
                        return robot.link.received - known, took, used

                    what = f"{many(count, 'service')}, {period_ms} ms"
                    due = count * int(seconds * 1000 / period_ms)
                    found = steady(measure, due, what, least)
                if found is None:
                    continue
                arrived, took, used = found
                part.add(
                    what,
                    "client",
                    "ms/s",
                    round(used / took * 1000, 3),
                    note=f"{used * 1e6 / arrived:.1f} us for each of {arrived / took:.0f} "
                    "statuses a second",
                )


def main():
    given = figures.arguments(__doc__)
    program = given.build / "bin/roburoc4-sim"
    part = figures.Part(
        "growth",
        "Growth: robots, services × rate",
        ABOUT,
        [figures.compiler(given.build), f"Python {platform.python_version()}"],
    )
    # A quick run is not judged, and may be on a busy machine.
    least = 0.01 if given.quick else LEAST
    measure_robots(
        part,
        program,
        (1, 10) if given.quick else (1, 10, 100, 1000),
        1 if given.quick else 4,
        least,
    )
    measure_services(
        part,
        program,
        (100,) if given.quick else (10, 20, 50, 100),
        0.5 if given.quick else 2,
        least,
    )
    part.write(given.out)


if __name__ == "__main__":
    main()
