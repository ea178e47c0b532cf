# SPDX-License-Identifier: MIT
"""A whole first contact in real time, as an owner has it: a terminal, UDP, and people with time.

person.py [--seed SEED] FOLDER: `roburoc4 first-contact FOLDER` of this Python's environment, with a
simulated robot, and a person who reads each line and does what it asks. Robot and person are in
network namespaces of their own, with a cable that can be pulled; so it needs Linux and root. Takes
about 25 minutes; leave the machine idle, because a keyboard that stutters counts as released.
"""

import argparse
import math
import os
import pty
import random
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

ROBOT = "192.0.2.2"
REPEAT_S, FIRST_S = 0.033, 0.5
"""How a keyboard repeats a key that is held."""
PLUG = "ip link set robot {}"
ALONE = "--alone"
INSIDE = """mount --make-rprivate / && mkdir -p /run/netns && mount -t tmpfs none /run/netns &&
exec "$@" """

# What a line asks for: words of it, seconds that it takes, and what happens to the robot then.
DEEDS: tuple[tuple[str, float, tuple[str, ...]], ...] = (
    ("the robot off by its main switch", 5.0, ("power off", "sleep 5", "power on", "sleep 10")),
    ("Press the front bumper", 4.0, ("front bumper press",)),
    ("Let the front bumper go", 1.5, ("front bumper release",)),
    ("Press the rear bumper", 6.0, ("rear bumper press",)),
    ("Let the rear bumper go", 1.5, ("rear bumper release",)),
    ("Press button [A]", 4.0, ("pad a down",)),
    ("Let button [A]", 1.5, ("pad a up", "pad release")),
    ("Push the left stick up", 8.0, ("sticks",)),
    ("Press each other button", 8.0, ("buttons",)),
    ("Hold a board 0.5 m", 15.0, ("board",)),
    ("Take the board away", 4.0, ("box clear",)),
    ("Wheels off the ground", 180.0, ("box clear",)),
    ("Press the remote emergency stop", 3.0, ("estop remote press",)),
    ("Release it", 3.0, ("estop remote release",)),
    ("Press the green button", 4.0, ("motor on",)),
    ("brakes selector to Released", 5.0, ("brakes released",)),
    ("Turn it to Automatic", 3.0, ("brakes automatic",)),
    ("Let it go. Get ready", 1.5, ("pad a up", "pad release")),
    ("Plug the network cable in", 8.0, ("plug up",)),
    ("Hold [A] again", 2.0, ("pad a down",)),
    ("Press the right trigger", 2.0, ("pad rt -0.6",)),
    ("Let both go", 1.0, ("pad release",)),
    ("Robot on the ground", 180.0, ("box clear", "place 0 0 0", "motor on")),
)
# What is done at the end of a countdown.
AT_ZERO: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Pull the network cable", ("plug down",)),
    ("Hold [A] from 0 on", ("pad a down",)),
    ("Let [A] go", ("pad a up", "pad release")),
    ("Tap [A] shortly", ("pad a down", "sleep 0.15", "pad a up", "pad release")),
)
STICKS = ("lj_y 1", "lj_y -1", "lj_x -1", "lj_x 1", "rj_y 1", "rj_y -1", "rj_x -1", "rj_x 1")
BUTTONS = ("b", "x", "y", "back", "start", "d_up", "d_down", "d_left", "d_right", "lj", "rj")
READS_S, MEASURES_S = 3.0, 30.0


class Robot:
    """The simulated robot's panel, and its cable."""

    def __init__(self, simulator: str, options: list[str]) -> None:
        self.before = (0.0, 0.0, 0.0)
        self._process = subprocess.Popen(
            ["ip", "netns", "exec", "robot", simulator, "--panel", "--bind", ROBOT, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

        self.drawn = {"telemeters": 2.0, "telemeter_turn_rad": 0.0}
        assert self._process.stdout
        for line in self._process.stdout:
            print(line, end="", flush=True)
            for name, value in re.findall(r"--(\w+) (\S+)", line):
                self.drawn[name] = float(value)
            if "ready on" in line:
                break

    def tell(self, line: str) -> str:
        """Type a line at the simulator's panel; return its answer."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        while True:
            answer = self._process.stdout.readline()
            if not answer:
                raise SystemExit("the simulator ended")
            if answer.startswith(("ok", "power ", "usage", "no ", "unknown", "robot and")):
                return answer.strip()

    def pose(self) -> tuple[float, ...]:
        """Where it really is."""
        found = re.search(r"pose (\S+) (\S+) (\S+),", self.tell("status"))
        assert found
        return tuple(map(float, found.groups()))

    def battery_v(self) -> str:
        """What the panel's display shows."""
        found = re.search(r"battery \S+ % (\S+) V", self.tell("status"))
        assert found
        return found.group(1)

    def end(self) -> None:
        """Switch everything off."""
        self._process.terminate()


class Person:
    """Reads a terminal, types, and has a helper at the robot."""

    def __init__(self, robot: Robot, terminal: int) -> None:
        self._robot, self._terminal = robot, terminal
        self._text = ""
        self._holds_since_s = math.inf
        self._repeated_s = 0.0
        self._at_zero: tuple[str, ...] = ()
        self._people = random.Random(39)
        self.steps: list[tuple[str, float]] = []

    def listen(self) -> bool:
        """Read, hold the key, and do what a line asks; False at the end."""
        if select.select([self._terminal], [], [], 0.01)[0]:
            try:
                data = os.read(self._terminal, 4096)
            except OSError:
                return False
            self._text += data.decode(errors="replace")
        self._hold()
        while "\n" in self._text:
            line, _, self._text = self._text.partition("\n")
            line = re.sub(r"\x1b\[[0-9;?<>]*[A-Za-z]", "", line).strip()
            if line:
                print(f"{time.monotonic() - BEGUN_S:7.1f} {line}", flush=True)
                self._obey(line)
        return True

    def _hold(self) -> None:
        now_s = time.monotonic()
        held_s = now_s - self._holds_since_s
        first = held_s >= 0 and self._repeated_s < self._holds_since_s
        if first or (held_s > FIRST_S and now_s - self._repeated_s >= REPEAT_S):
            self._repeated_s = now_s
            os.write(self._terminal, b" ")

    def _obey(self, line: str) -> None:
        if line.startswith("Step "):
            self.steps.append((line.partition(".")[0], time.monotonic() - BEGUN_S))
        elif line.startswith("Let the space bar go"):
            self._holds_since_s = math.inf
        elif line.startswith("Hold the space bar"):
            self._holds_since_s = time.monotonic() + self._people.uniform(1.0, 3.0)
        elif line.startswith("0 - now"):
            time.sleep(self._people.uniform(0.0, 0.08))
            self._do(self._at_zero, line)
        elif found := next((deeds for words, deeds in AT_ZERO if words in line), None):
            self._at_zero = found
        elif line.endswith("Then press Enter."):
            self._answer(line, "", *self._asked(line))
        elif "yes or no" in line or "is the way free" in line:
            self._answer(line, "yes", READS_S)
        elif "display show" in line:
            self._answer(line, self._robot.battery_v, 5.0)
        elif line.startswith(("How many metres", "By how many degrees")):
            self._answer(line, lambda: self._measured(line), MEASURES_S)

    @staticmethod
    def _asked(line: str) -> tuple[float, tuple[str, ...]]:
        return next(((s, deeds) for words, s, deeds in DEEDS if words in line), (READS_S, ()))

    def _answer(
        self,
        line: str,
        answer: str | Callable[[], str],
        seconds: float,
        deeds: tuple[str, ...] = (),
    ) -> None:
        self._holds_since_s = math.inf
        time.sleep(seconds * self._people.uniform(0.7, 1.2))
        self._do(deeds, line)
        time.sleep(self._people.uniform(0.5, 1.5))
        text = answer() if callable(answer) else answer
        os.write(self._terminal, f"{text}\n".encode())

    def _measured(self, line: str) -> str:
        before, self._robot.before = self._robot.before, self._robot.pose()
        if "metres" in line:
            return f"{math.dist(before[:2], self._robot.before[:2]):.2f}"
        return f"{math.degrees(self._robot.before[2] - before[2]):.0f}"

    def _do(self, deeds: tuple[str, ...], line: str) -> None:
        for deed in deeds:
            what, _, value = deed.partition(" ")
            if what == "sleep":
                time.sleep(float(value))
            elif what == "plug":
                subprocess.run(PLUG.format(value).split(), check=True)
            elif what == "sticks":
                self._touch([f"pad {each}" for each in STICKS], "0")
                self._touch(["pad lt 1", "pad rt 1"], "-1")
            elif what == "buttons":
                self._touch([f"pad {each} down" for each in (*BUTTONS, "lb", "rb")], "up")
            elif what == "board":
                self._board(int(re.findall(r"telemeter (\d+)", line)[0]))
            else:
                answer = self._robot.tell(deed)
                assert answer.startswith("ok"), (deed, answer)
                if what == "place":
                    self._robot.before = self._robot.pose()

    def _touch(self, deeds: list[str], rest: str) -> None:
        for deed in deeds:
            self._robot.tell(deed)
            time.sleep(0.6)
            self._robot.tell(f"{deed.rpartition(' ')[0]} {rest}")
            time.sleep(0.6)

    def _board(self, index: int) -> None:
        x, y, theta = self._robot.pose()
        drawn = self._robot.drawn
        place = 2 * math.pi * index / drawn["telemeters"]
        angle = place + (index + 1) * drawn["telemeter_turn_rad"]
        ahead = 0.655 * math.cos(place) + 0.505 * math.cos(angle)
        left = 0.375 * math.sin(place) + 0.505 * math.sin(angle)
        self._robot.tell("box clear")
        at = (
            x + ahead * math.cos(theta) - left * math.sin(theta),
            y + ahead * math.sin(theta) + left * math.cos(theta),
        )
        self._robot.tell(f"box add {at[0]:.4f} {at[1]:.4f} 0.01 0.01 0")


BEGUN_S = time.monotonic()


def wire() -> None:
    """Lay a cable between this namespace and the robot's."""
    for command in (
        "ip link set lo up",
        "ip netns add robot",
        "ip link add robot type veth peer name eth0 netns robot",
        "ip addr add 192.0.2.1/24 dev robot",
        "ip link set robot up",
        f"ip -n robot addr add {ROBOT}/24 dev eth0",
        "ip -n robot link set eth0 up",
        "ip -n robot link set lo up",
    ):
        subprocess.run(command.split(), check=True)


def main() -> int:
    """Make first contact; the exit status is the command's."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", help="of the family; default: the simulator's defaults")
    parser.add_argument("--simulator", default="roburoc4-sim")
    parser.add_argument(ALONE, action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if not options.alone:
        inside = ["sh", "-c", INSIDE, "sh", sys.executable, *sys.argv, ALONE]
        os.execvp("unshare", ["unshare", "--net", "--mount", *inside])
    wire()
    extra = ["--family", options.seed] if options.seed else []
    robot = Robot(options.simulator, extra)
    child, terminal = pty.fork()
    if child == 0:
        command = str(Path(sys.executable).with_name("roburoc4"))
        os.execv(command, [command, "first-contact", str(options.folder), "--robot", ROBOT])
    person = Person(robot, terminal)
    try:
        while person.listen():
            pass
    finally:
        robot.end()
    _pid, status = os.waitpid(child, 0)
    person.steps.append(("", time.monotonic() - BEGUN_S))
    for (name, begin_s), (_next, end_s) in pairwise(person.steps):
        print(f"{end_s - begin_s:6.0f} s {name}")
    code = os.waitstatus_to_exitcode(status)
    print(f"{(time.monotonic() - BEGUN_S) / 60:.1f} minutes, exit status {code}")
    return code


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(main())
