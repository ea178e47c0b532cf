# SPDX-License-Identifier: MIT
"""The firmware of docs/firmware.md in QEMU drives a simulated robot over emulated Ethernet.

test_board.py FOLDER SIMULATOR: FOLDER has the firmware's files; scripts/test-board makes it. All is
measured at the simulator.
"""

import functools
import json
import pathlib
import re
import shlex
import socket
import subprocess
import sys
import tempfile
import time
import typing
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))

from judged import TRIES, judged

PAGE = pathlib.Path(__file__).parents[2] / "docs/firmware.md"
FOLDER = pathlib.Path(sys.argv.pop(1)).resolve()
SIMULATOR = pathlib.Path(sys.argv.pop(1)).resolve()
BOARDS = {
    "mps2-an385": ["-mcpu=cortex-m3"],
    "mps2-an500": ["-mcpu=cortex-m7", "-mfloat-abi=hard", "-mfpu=fpv5-sp-d16"],
}
COUNTER = 0x40028018  # of examples/board/mps2.h
LIMIT_S = 30  # what takes so long does not happen
WATCHDOG_S = 1.0
BRAKING_M = 0.38  # from 0.5 m/s


class State(typing.NamedTuple):
    """The robot, by the simulator's panel."""

    cycles: int  # of 10 ms
    x_m: float
    y_m: float
    heading_rad: float
    speed_m_s: float
    target_m_s: float


class Robot:
    """A simulated robot, and the person beside it."""

    def __init__(self):
        self.process = subprocess.Popen(
            [SIMULATOR, "--port", "0", "--panel"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.port = int(self.process.stdout.readline().rsplit(":", 1)[1])

    def panel(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline()

    def restart(self):
        for line in ("power off", "place 0 0 0", "power on"):
            answer = self.panel(line)
            if answer.startswith("error"):
                raise RuntimeError(f"{line}: {answer}")

    def state(self):
        line = self.panel("status")
        number = r"(-?[\d.]+)"
        cycles = re.search(r"(\d+) cycles", line)[1]
        pose = re.search(rf" pose {number} {number} {number}", line).groups()
        speed = re.search(rf"speed {number} m/s", line)[1]
        target = re.search(rf"target {number} m/s", line)[1]
        return State(int(cycles), *map(float, (*pose, speed, target)))

    def wait(self, what, condition):
        """The first state in which condition() holds, after at most LIMIT_S of the robot's time."""
        begun = state = self.state()
        while not condition(state):
            if state.cycles - begun.cycles > LIMIT_S * 100:
                raise AssertionError(f"not seen within {LIMIT_S} s: {what}; now {state}")
            time.sleep(0.005)
            state = self.state()
        return state

    def end(self):
        self.process.communicate("quit\n")


class Board:
    """A board in QEMU, by the command of the page; its keys and its monitor."""

    def __init__(self, machine):
        command = re.search(r"^qemu-system-arm .*?[^\\]$", PAGE.read_text("utf-8"), re.M | re.S)[0]
        words = shlex.split(command.replace("\\\n", " ").replace("mps2-an385", machine))
        self.folder = tempfile.TemporaryDirectory()
        monitor = f"{self.folder.name}/monitor"
        self.process = subprocess.Popen(
            [*words, "-qmp", f"unix:{monitor},server=on,wait=off"],
            cwd=FOLDER / machine,
            stdin=subprocess.PIPE,
        )
        self.socket = socket.socket(socket.AF_UNIX)
        while self.socket.connect_ex(monitor) != 0:
            if self.process.poll() is not None:
                raise RuntimeError("QEMU ended")
            time.sleep(0.005)
        self.lines = self.socket.makefile("rw", encoding="utf-8")
        self.lines.readline()
        self.order("qmp_capabilities")

    def order(self, execute, **arguments):
        self.lines.write(json.dumps({"execute": execute, "arguments": arguments}) + "\n")
        self.lines.flush()
        while True:
            answer = json.loads(self.lines.readline())
            if "error" in answer:
                raise RuntimeError(answer["error"]["desc"])
            if "return" in answer:
                return answer["return"]

    def press(self, key):
        self.process.stdin.write(key.encode())
        self.process.stdin.flush()

    def cable(self, plugged):
        self.order("set_link", name="lan9118.0", up=plugged)

    def timer_us(self):
        line = self.order("human-monitor-command", **{"command-line": f"xp /1xw {COUNTER}"})
        return int(line.split()[1], 16)

    def kill(self):
        if self.process.poll() is not None:
            return
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.lines.close()
        self.socket.close()
        self.folder.cleanup()


@functools.cache
def robot():
    made = Robot()
    unittest.addModuleCleanup(made.end)
    return made


@functools.cache
def build(machine):
    """Build the firmware as the page says, for this robot's port."""
    folder = FOLDER / machine
    subprocess.run(["rm", "-rf", folder], check=True)
    subprocess.run(["cp", "-r", FOLDER / "firmware", folder], check=True)
    flags = [*BOARDS[machine], f"-DROBOT_PORT={robot().port}"]
    subprocess.run(["sh", "build.sh", *flags], cwd=folder, check=True)


def is_at_rest(state):
    return state.speed_m_s == 0 and state.target_m_s == 0


class Drives:
    """What each board promises."""

    machine = ""

    def start(self):
        build(self.machine)
        robot().restart()
        board = Board(self.machine)
        self.addCleanup(board.kill)
        return board

    def drive_off(self, board, key):
        """Press the switch until the board can arm; wait until the robot has the key's speed."""
        pressed = -LIMIT_S * 100

        def moves(state):
            nonlocal pressed
            if state.target_m_s == 0 and state.cycles - pressed > 60:
                board.press("x" + key)
                pressed = state.cycles
            return state.speed_m_s > 0.09 * int(key)

        robot().wait("it drives", moves)

    def drive_to(self, x_m):
        def there(state):
            assert state.target_m_s > 0, f"it stopped: {state}"
            return state.x_m >= x_m

        robot().wait(f"{x_m} m", there)

    def check_watchdog_stops(self, last):
        """Nothing is sent after the state `last`."""
        at_rest = robot().wait("it stops", is_at_rest)
        assert at_rest.x_m - last.x_m < 0.5 * WATCHDOG_S + BRAKING_M, (last, at_rest)
        return at_rest

    def keep_target(self, target_m_s, condition):
        def checked(state):
            assert state.target_m_s == target_m_s, state
            return condition(state)

        return robot().wait("the end of this time", checked)

    @judged
    def test_it_drives_a_straight_metre(self):
        for _ in range(TRIES):  # where this machine is busy, the key is released late
            board = self.start()
            self.drive_off(board, "5")
            self.drive_to(0.4)
            board.press("1")
            self.drive_to(0.94)
            board.press("x")
            at_rest = robot().wait("it stops", is_at_rest)
            assert abs(at_rest.y_m) < 0.02, at_rest
            assert abs(at_rest.heading_rad) < 0.05, at_rest
            if abs(at_rest.x_m - 1) < 0.03:
                return
            board.kill()
        self.fail(f"not a metre: {at_rest}")

    @judged
    def test_the_robot_stops_within_its_watchdog_when_the_board_dies(self):
        board = self.start()
        self.drive_off(board, "5")
        board.kill()
        self.check_watchdog_stops(robot().state())

    @judged
    def test_the_robot_stops_when_the_cable_is_cut_and_drives_again_only_when_told(self):
        board = self.start()
        self.drive_off(board, "5")
        board.cable(plugged=False)
        stopped = self.check_watchdog_stops(robot().state())
        board.cable(plugged=True)
        # The switch is still held.
        self.keep_target(0, lambda state: state.cycles - stopped.cycles > 200)
        self.drive_off(board, "5")

    @judged
    def test_it_drives_on_when_the_timer_wraps(self):
        for _ in range(TRIES):  # the timer wraps 5 s after the start, and this machine may be slow
            board = self.start()
            self.drive_off(board, "1")
            if board.timer_us() > 2**31:
                break
            board.kill()
        assert board.timer_us() > 2**31
        wrapped = self.keep_target(0.1, lambda state: board.timer_us() < 2**31)
        self.keep_target(0.1, lambda state: state.cycles - wrapped.cycles > 100)


class TestCortexM3(Drives, unittest.TestCase):
    machine = "mps2-an385"


class TestCortexM7(Drives, unittest.TestCase):
    machine = "mps2-an500"


if __name__ == "__main__":
    unittest.main(verbosity=2)
