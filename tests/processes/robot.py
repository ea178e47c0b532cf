# SPDX-License-Identifier: MIT
"""roburoc4-sim as a process, its panel, and the tap before it."""

import re
from pathlib import Path

from .process import Program
from .programs import Programs
from .tap import Tap
from .waiting import until

_POSE = re.compile(r" pose (\S+) (\S+) (\S+), odometry")
_SPEED = re.compile(r" speed (\S+) m/s (\S+) rad/s, target (\S+) m/s (\S+) rad/s")


class Robot:
    """A simulated robot behind a tap."""

    def __init__(self, programs: Programs, folder: Path, *options: str) -> None:
        self.program = Program(
            folder / "sim.log", programs("roburoc4-sim"), "--port", "0", "--panel", *options
        )
        self.program.says("\n")
        addresses = re.findall(r"127\.0\.0\.1:\d+", self.program.output.splitlines()[0])
        self.taps = [Tap(address) for address in addresses]
        self.tap = self.taps[0]

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
