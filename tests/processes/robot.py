# SPDX-License-Identifier: MIT
"""roburoc4-sim as a process, its panel, and the tap before it."""

import re
import time
from pathlib import Path

from .process import Program
from .programs import Programs
from .tap import Tap
from .waiting import until

_POSE = re.compile(r" pose (\S+) (\S+) (\S+), odometry")
_SPEED = re.compile(r" speed (\S+) m/s (\S+) rad/s, target (\S+) m/s (\S+) rad/s")
_LONG_ON_S = 3.0  # longer than the silence until its statuses come again


class Robot:
    """A simulated robot behind a tap."""

    def __init__(self, programs: Programs, folder: Path, *options: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.program = Program(
            folder / "sim.log", programs("roburoc4-sim"), "--port", "0", "--panel", *options
        )
        self.program.says("\n")
        addresses = re.findall(r"127\.0\.0\.1:\d+", self.program.output.splitlines()[0])
        self.past_the_tap = addresses[0]
        self.taps = [Tap(address) for address in addresses]
        self.tap = self.taps[0]
        self._on_s = time.monotonic()

    @property
    def address(self) -> str:
        return self.tap.address

    def close(self) -> None:
        for tap in self.taps:
            tap.close()
        self.program.end()

    def tell(self, line: str) -> str:
        """Say a line to its panel, and wait for the reply."""
        stdin = self.program.process.stdin
        assert stdin is not None
        before = len(self.program.output)
        stdin.write(line.encode() + b"\n")
        stdin.flush()
        until(lambda: self.program.output[before:].endswith("\n"), f"the panel replies to {line!r}")
        reply = self.program.output[before:]
        assert not reply.startswith("error"), f"{line!r}: {reply}"
        return reply

    def reboot(self, dark_s: float = 0.3) -> None:
        """Switch it off and on, so late that its clock goes back for all to see."""
        time.sleep(max(0.0, self._on_s + _LONG_ON_S - time.monotonic()))
        self.tell("power off")
        time.sleep(dark_s)
        self.tell("power on")
        self._on_s = time.monotonic()

    def true_pose(self) -> tuple[float, float, float]:
        found = _POSE.search(self.tell("status"))
        assert found
        return float(found[1]), float(found[2]), float(found[3])

    def speeds(self) -> tuple[float, float, float, float]:
        """Linear and angular speed of its body, linear and angular target."""
        found = _SPEED.search(self.tell("status"))
        assert found
        return float(found[1]), float(found[2]), float(found[3]), float(found[4])

    def stands(self) -> bool:
        linear, angular, target_linear, target_angular = self.speeds()
        # Its body creeps on for a while after the target is zero; noise is not motion.
        still = abs(linear) < 0.005 and abs(angular) < 0.01
        return still and target_linear == 0 and target_angular == 0
