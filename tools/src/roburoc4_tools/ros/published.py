# SPDX-License-Identifier: MIT
"""What the node publishes: topics, types and quality of service."""

from typing import NamedTuple

from .topics import TOPICS


class Profile(NamedTuple):
    """Quality of service; publishers are reliable, so that all listeners match."""

    depth: int
    latched: bool = False
    """Transient local: late subscribers get the last messages, too."""
    reliable: bool = True
    """Of a subscription: whether it only matches reliable publishers."""
    lifespan_s: int = 0
    """Late subscribers do not get older messages; 0: all."""

    @property
    def text(self) -> str:
        """As `ros2 topic info --verbose` names it."""
        durability = "transient local" if self.latched else "volatile"
        reliability = "reliable" if self.reliable else "best effort"
        return f"{reliability}, {durability}, keep last {self.depth}"


DEFAULT = Profile(10)
TRANSFORMS = Profile(100)
LATCHED = Profile(1, latched=True)
LOG = Profile(1000, latched=True, lifespan_s=10)
# A command that was lost is not worth a second try: the next one is newer.
COMMANDS = Profile(10, reliable=False)


class Topic(NamedTuple):
    """A topic of one robot."""

    name: str
    """Absolute, or relative to the robot's namespace."""
    kind: str
    profile: Profile


def _of_statuses(key: str, name: str = "", profile: Profile = DEFAULT) -> tuple[str, Topic]:
    return key, Topic(name or key, TOPICS[key], profile)


# By the key that ros_topics.Messages gives; /tf and /diagnostics are absolute by custom.
PUBLISHED: dict[str, Topic] = dict(
    (
        _of_statuses("odom"),
        _of_statuses("tf", "/tf", TRANSFORMS),
        _of_statuses("tf_static", "/tf_static", LATCHED),
        _of_statuses("cmd_vel_applied"),
        _of_statuses("battery_state"),
        _of_statuses("range/front"),
        _of_statuses("range/rear"),
        _of_statuses("pad/joy"),
        _of_statuses("bumpers/front", profile=LATCHED),
        _of_statuses("bumpers/rear", profile=LATCHED),
        _of_statuses("inhibited", profile=LATCHED),
        _of_statuses("diagnostics", "/diagnostics"),
        ("rosout", Topic("/rosout", "rcl_interfaces/Log", LOG)),
        _of_statuses("robot_description", profile=LATCHED),
    )
)

# A stop is worth a second try, and comes from publishers of all kinds. The latched subscription
# gets the single stop of a program that has only just appeared, as `ros2 topic pub --once`.
STOPS = (
    Topic("stop", "std_msgs/Empty", DEFAULT),
    Topic("stop", "std_msgs/Empty", COMMANDS),
    Topic("stop", "std_msgs/Empty", LATCHED),
)
CMD_VEL = Topic("cmd_vel", "geometry_msgs/TwistStamped", COMMANDS)
CMD_VEL_UNSTAMPED = Topic("cmd_vel", "geometry_msgs/Twist", COMMANDS)
