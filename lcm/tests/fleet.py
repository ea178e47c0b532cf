#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A fleet on a bad network: nobody drives who should not.

Four network namespaces on one switch (programs/wire.c, which loses and reorders): two hosts with a
bridge each, one with planners and lcm-logger, and the robots' network. Hosts vanish and return,
bridges are killed, hung and ended, robots are switched off, somebody holds [A], and planners rival,
replay and never pause. Afterwards rig/judge.py judges every speed that reached a robot, the robots
must stand, and log_to_csv.py must understand the log. Needs unshare, nsenter and ip.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

import lcm
import roburoc4_lcm
from processes.robot import _SPEED
from rig import Program, Programs, until
from rig.judge import Host, Judge, Robot, read_record

HERE = Path(__file__).resolve().parent
URL = "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4194304"
BRIDGES = (0, 1)
LAB, FIELD = 2, 3  # planners and logger; robots
HOSTS = 4
SHARED = 4
"""So many robots are driven by the first bridge and watched by the second, too."""


def now_us() -> int:
    return time.time_ns() // 1000


def enter_namespaces() -> None:
    """Run in network and user namespaces of our own, without rights outside of them."""
    if os.environ.get("ROBUROC4_FLEET") != "inside":
        os.environ["ROBUROC4_FLEET"] = "inside"
        os.execvp("unshare", ["unshare", "-rn", sys.executable, *sys.argv])


class Fleet:
    def __init__(self, folder: Path, options: argparse.Namespace, ends: ExitStack) -> None:
        self.folder, self.count, self.ends = folder, options.robots, ends
        self.luck = random.Random(options.seed)
        self.programs = Programs()
        self.robots = {f"R{number}": Robot() for number in range(self.count)}
        self.hosts = {host: Host() for host in BRIDGES}
        self.bridges: dict[int, Program] = {}
        self.done: Counter[str] = Counter()
        self.cut: set[int] = set()
        self.logs = 0
        self._cable()
        self.wire = self.run(
            None, self.programs("wire"), options.seed, options.loss, options.reorder,
            folder / "record", *[f"h{host}" for host in range(HOSTS)],
        )  # fmt: skip
        self.wire.says("ready")
        self.simulator = self.run(
            FIELD, self.programs("roburoc4-sim"), "--bind", "0.0.0.0",
            "--robots", self.count, "--panel",
        )  # fmt: skip
        self.simulator.says("ready")

    def run(self, host: int | None, *command: object) -> Program:
        self.logs += 1
        inside = () if host is None else ("nsenter", "--net", "-t", str(self.holders[host].pid))
        name = Path(str(command[0])).name
        program = Program(
            self.folder / f"{self.logs}-{name}.log", *inside, *[str(word) for word in command]
        )
        self.ends.callback(program.end)
        return program

    def _cable(self) -> None:
        self.holders: list[subprocess.Popen[bytes]] = []
        for host in range(HOSTS):
            holder = subprocess.Popen(
                ["unshare", "-n", "sh", "-c", "echo; exec sleep infinity"], stdout=subprocess.PIPE
            )
            self.ends.callback(holder.wait)
            self.ends.callback(holder.kill)
            self.holders.append(holder)
            assert holder.stdout is not None
            holder.stdout.readline()  # it is in a namespace of its own
            inside = f"nsenter --net -t {holder.pid}"
            commands = [
                f"ip link add h{host} mtu 9000 type veth peer name e0 mtu 9000 netns {holder.pid}",
                f"ip link set h{host} up",
                f"{inside} ip link set lo up",
                f"{inside} ip addr add 10.0.0.{host + 1}/24 dev e0",
                f"{inside} ip link set e0 up",
                f"{inside} ip route add 224.0.0.0/4 dev e0",
            ]
            subprocess.run(" && ".join(commands), shell=True, check=True)

    # ------------------------------------------------------------------------------ bridges

    def write_files(self) -> None:
        """Robots by turns to the bridges; every seventh is only watched; some have two bridges."""
        default = (
            f"[DEFAULT]\nlcm-url = {URL}\nperiod-ms.iocard = 100\nperiod-ms.differential = 100\n"
            "period-ms.localization = 100\nperiod-ms.telemeter = 0\n"
        )
        texts = dict.fromkeys(BRIDGES, default)
        for number, (name, robot) in enumerate(self.robots.items()):
            host = BRIDGES[0] if number < SHARED else number % 2
            drives = number % 7 != 6
            section = f"[{name}]\naddress = 10.0.0.{FIELD + 1}:{60000 + number}\n"
            robot.may_drive = frozenset({host} if drives else ())
            robot.timeout_us = 200_000 if number % 5 == 0 else 300_000
            texts[host] += section + f"lease-ms = {robot.timeout_us // 1000}\n"
            texts[host] += "enable-drive = yes\n" if drives else ""
            if number < SHARED:
                texts[BRIDGES[1]] += section
        for host, text in texts.items():
            (self.folder / f"bridge{host}.ini").write_text(text)

    def start_bridge(self, host: int) -> None:
        self.hosts[host].starts.append(now_us())
        file = self.folder / f"bridge{host}.ini"
        self.bridges[host] = self.run(host, self.programs("roburoc4-lcm"), "--config", file)

    # ------------------------------------------------------------------------------- faults

    def tell(self, robot: int, what: str) -> None:
        stdin = self.simulator.process.stdin
        assert stdin is not None
        stdin.write(f"robot {robot + 1} {what}\n".encode())
        stdin.flush()

    def plug(self, host: int, cut: bool) -> None:
        stdin = self.wire.process.stdin
        assert stdin is not None
        stdin.write(f"{'cut' if cut else 'join'} {host}\n".encode())
        stdin.flush()

    def host_vanishes(self) -> None:
        host = self.luck.choice((*BRIDGES, LAB))
        self.plug(host, cut=True)
        self.sleep(self.luck.uniform(2, 5))
        self.plug(host, cut=False)

    def bridge_ends(self) -> None:
        host = self.luck.choice(BRIDGES)
        ending = self.luck.choice((signal.SIGKILL, signal.SIGTERM))
        self.bridges[host].signal(ending)
        self.bridges[host].ends()
        self.sleep(self.luck.uniform(0, 2))
        self.start_bridge(host)

    def bridge_hangs(self) -> None:
        host = self.luck.choice(BRIDGES)
        begun = now_us()
        self.bridges[host].signal(signal.SIGSTOP)
        self.sleep(self.luck.uniform(0.4, 3))
        self.bridges[host].signal(signal.SIGCONT)
        self.hosts[host].hangs.append((begun, now_us()))

    def robots_fall_silent(self) -> None:
        some = self.luck.sample(range(self.count), max(1, self.count // 10))
        for robot in some:
            self.robots[f"R{robot}"].blackouts.append((now_us(), 0))
            self.tell(robot, "power off")
        self.sleep(self.luck.uniform(1.5, 4))
        for robot in some:
            self.tell(robot, "power on")
            times = self.robots[f"R{robot}"].blackouts
            times[-1] = (times[-1][0], now_us())

    def somebody_holds_a(self) -> None:
        some = self.luck.sample(range(self.count), max(1, self.count // 10))
        for robot in some:
            self.tell(robot, "pad a down")
            self.robots[f"R{robot}"].overrides.append((now_us(), 0))
        self.sleep(self.luck.uniform(1, 4))
        for robot in some:
            times = self.robots[f"R{robot}"].overrides
            times[-1] = (times[-1][0], now_us())
            self.tell(robot, "pad a up")

    def sleep(self, seconds: float) -> None:
        time.sleep(seconds)

    def break_things(self, seconds: float) -> None:
        faults = (
            self.host_vanishes,
            self.bridge_ends,
            self.bridge_hangs,
            self.robots_fall_silent,
            self.somebody_holds_a,
        )
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            fault = self.luck.choice(faults)
            self.done[fault.__name__] += 1
            fault()
            self.sleep(self.luck.uniform(2, 5))

    # ------------------------------------------------------------------------------ the end

    def robots_stand(self) -> None:
        before = len(self.simulator.output)
        for robot in range(self.count):
            self.tell(robot, "status")
        until(lambda: self.simulator.output[before:].count(" target ") == self.count, "they reply")
        for found in _SPEED.finditer(self.simulator.output[before:]):
            linear, angular, target_linear, target_angular = map(float, found.groups())
            assert max(abs(linear), abs(angular)) < 0.02, found[0]
            assert target_linear == target_angular == 0, found[0]


def both_bridges_noticed(log: Path) -> bool:
    fault = roburoc4_lcm.bridge_state_t.FAULT_OTHER_BRIDGE
    seen = set()
    for event in lcm.EventLog(str(log), "r"):
        if event.channel == "R0_BRIDGE_STATE":
            state = roburoc4_lcm.bridge_state_t.decode(event.data)
            if state.faults & fault:
                seen.add(state.drive_enabled)
    return seen == {True, False}


def run(folder: Path, options: argparse.Namespace, ends: ExitStack) -> None:
    fleet = Fleet(folder, options, ends)
    fleet.write_files()
    log = folder / "fleet.lcmlog"
    kept = ".*_(DRIVE_CMD|STOP_CMD|LOCALIZATION|BRIDGE_STATE)"
    logger = fleet.run(
        LAB, Programs.of_lcm("lcm-logger"), "--quiet", "-l", URL, "-c", kept, log
    )  # fmt: skip
    for host in BRIDGES:
        fleet.start_bridge(host)
    time.sleep(3)
    planners = fleet.run(
        LAB, sys.executable, HERE / "rig" / "planners.py", URL,
        f"--robots={options.robots}", f"--seed={options.seed}",
    )  # fmt: skip
    planners.says("planning")
    fleet.break_things(options.seconds)
    assert planners.running, planners.output
    planners.end()
    time.sleep(4)  # the watchdog's second, and braking
    fleet.robots_stand()
    for bridge in fleet.bridges.values():
        assert bridge.running, bridge.output
        bridge.end()
        assert bridge.process.returncode == 0, bridge.output
    logger.end()
    assert fleet.wire.process.stdin is not None
    fleet.wire.process.stdin.close()  # it ends, and its record is whole
    assert fleet.wire.ends() == 0, fleet.wire.output

    read_record(folder / "record", fleet.robots, BRIDGES)
    judge = Judge(fleet.robots, fleet.hosts)
    wrong = list(judge.complaints())
    driven = sum(any(speed.moves for speed in robot.speeds) for robot in fleet.robots.values())
    asked = sum(len(asks) for robot in fleet.robots.values() for asks in robot.asks.values())
    csv = subprocess.run(
        [sys.executable, HERE.parent / "examples" / "log_to_csv.py", log, folder / "csv"],
        capture_output=True,
        text=True,
        check=True,
    )
    files = list((folder / "csv").glob("R*_LOCALIZATION.csv"))
    print(f"faults: {json.dumps(fleet.done)}")
    print(f"{asked} commands were delivered to bridges, {judge.judged} speeds to {driven} robots")
    print(f"{csv.stdout.count(chr(10))} channels in the log; {len(files)} robots have a path")
    for each in wrong[:20]:
        print(each)
    assert not wrong, f"{len(wrong)} speeds that nobody was allowed to ask for"
    may = sum(bool(robot.may_drive) for robot in fleet.robots.values())
    assert driven >= may // 2, f"{driven} of {may} robots drove: the test shows too little"
    assert len(files) == options.robots, csv.stderr
    assert both_bridges_noticed(log), "two bridges for one robot did not notice each other"
    print("nobody drove who should not")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--robots", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--loss", type=float, default=0.02, help="share of datagrams")
    parser.add_argument("--reorder", type=float, default=0.02, help="share of datagrams")
    parser.add_argument("--keep", type=Path, help="a folder for the logs, which are left there")
    options = parser.parse_args()
    enter_namespaces()
    with tempfile.TemporaryDirectory() as scratch, ExitStack() as ends:
        folder = options.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        run(folder, options, ends)


if __name__ == "__main__":
    main()
