# SPDX-License-Identifier: MIT
"""How cost grows: robots in one simulator, and services × rate through one client.

Runs in the virtual environment of scripts/bench, where the Python package is installed.
"""

import contextlib
import pathlib
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
    "services at several periods."
)
# service -> period in cycles of 10 ms
USUAL = {2: 5, 3: 10, 4: 100, 5: 5, 6: 5}
SERVICES = ("differential", "localization", "iocard", "telemeter", "battery")


def processor_s(pid):
    """Seconds that a process (of one thread) has run on a processor."""
    fields = pathlib.Path(f"/proc/{pid}/schedstat").read_text(encoding="utf-8").split()
    return int(fields[0]) / 1e9


@contextlib.contextmanager
def simulator(program, robots):
    """A simulator, and its robots' ports."""
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


def measure_robots(part, program, counts, seconds):
    for robots in counts:
        with (
            simulator(program, robots) as (pid, ports),
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as subscriber,
        ):
            for port in ports:
                for service, period in USUAL.items():
                    insert = struct.pack("<BBHHB", 1, 4, 1, service, period)
                    subscriber.sendto(insert, ("127.0.0.1", port))
                time.sleep(0.0005)  # so that no queue is full
            time.sleep(0.3)
            before, begun = processor_s(pid), time.monotonic()
            time.sleep(seconds)
            used = (processor_s(pid) - before) / (time.monotonic() - begun)
        part.add(
            f"{robots} robots",
            "simulator",
            "ms/s",
            round(used * 1000, 2),
            note=f"{used * 1e6 / robots:.0f} us for each",
        )


def measure_services(part, program, periods_ms, seconds):
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
                    before, begun = time.process_time(), time.monotonic()
                    time.sleep(seconds)
                    used = (time.process_time() - before) / (time.monotonic() - begun)
                rate = count * 1000 / period_ms
                part.add(
                    f"{count} services, {period_ms} ms",
                    "client",
                    "ms/s",
                    round(used * 1000, 3),
                    note=f"{used * 1e6 / rate:.1f} us for each of {rate:.0f} statuses a second",
                )


def main():
    given = figures.arguments(__doc__)
    program = given.build / "bin/roburoc4-sim"
    part = figures.Part("growth", "Growth: robots, services × rate", ABOUT, [])
    measure_robots(
        part,
        program,
        (1, 10) if given.quick else (1, 3, 10, 30, 100, 300, 1000),
        0.3 if given.quick else 4,
    )
    measure_services(
        part, program, (100,) if given.quick else (10, 20, 50, 100), 0.3 if given.quick else 2
    )
    part.write(given.out)


if __name__ == "__main__":
    main()
