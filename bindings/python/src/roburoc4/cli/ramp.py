# SPDX-License-Identifier: MIT
"""A gentle drive: up to speed, along, and down again, always on the same curve."""

from __future__ import annotations

import math
from dataclasses import dataclass

GENTLE_LINEAR_M_S2 = 0.5
GENTLE_ANGULAR_RAD_S2 = 1.0


def gentle(ceiling: float, *limits: float) -> float:
    """Return the lowest of the ceiling and those of the robot's limits that make sense."""
    return min([ceiling, *(abs(x) for x in limits if math.isfinite(x) and x != 0.0)])


@dataclass(frozen=True)
class Ramp:
    """Speeds over time: `seconds` of drive, ramp up included, then the ramp down."""

    linear_m_s: float
    angular_rad_s: float
    seconds: float
    linear_m_s2: float = GENTLE_LINEAR_M_S2
    angular_rad_s2: float = GENTLE_ANGULAR_RAD_S2

    @property
    def rise_s(self) -> float:
        """The time from rest to full speed."""
        return max(
            abs(self.linear_m_s) / self.linear_m_s2,
            abs(self.angular_rad_s) / self.angular_rad_s2,
        )

    @property
    def peak(self) -> float:
        """The share of the asked speeds that is reached: 1, or less in a short drive."""
        return min(1.0, self.seconds / self.rise_s) if self.rise_s > 0.0 else 1.0

    @property
    def total_s(self) -> float:
        """The time until the speeds are 0 again."""
        return self.seconds + self.peak * self.rise_s

    def at(self, elapsed_s: float) -> tuple[float, float]:
        """Linear and angular speed at this time."""
        return self.speeds(self.share(elapsed_s))

    def speeds(self, share: float) -> tuple[float, float]:
        """Linear and angular speed at this share of those that were asked for."""
        return self.linear_m_s * share, self.angular_rad_s * share

    def share(self, elapsed_s: float) -> float:
        """Return how much of the asked speeds to drive with at this time: 0 to 1."""
        if not 0.0 <= elapsed_s < self.total_s:
            return 0.0
        if self.rise_s == 0.0:
            return 1.0
        if elapsed_s <= self.seconds:
            return min(1.0, elapsed_s / self.rise_s)
        return max(0.0, self.peak - (elapsed_s - self.seconds) / self.rise_s)
