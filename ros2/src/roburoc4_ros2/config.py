# SPDX-License-Identifier: MIT
"""The node's configuration: from options, a YAML file, and the environment."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from roburoc4 import ArgumentError, robot_file
from roburoc4.protocol import STATUS_SERVICES
from roburoc4_tools.ros.odometry import Frames
from roburoc4_tools.ros.published import CMD_VEL, CMD_VEL_UNSTAMPED, PUBLISHED, STOPS, Topic

from .commands import DriveConfig
from .names import is_namespace, is_node, is_topic

DISTROS = ("humble", "iron", "jazzy", "kilted", "lyrical", "rolling")
HIGHEST_DOMAIN = 232
_FRAME = re.compile(r"[\w./-]*", re.ASCII)
_PERIODS_MS = range(10, 2551, 10)


class ConfigError(Exception):
    """Something in the configuration cannot be used; the message has its place and the remedy."""


@dataclass(frozen=True)
class RobotConfig:
    """One robot."""

    address: str
    name: str = ""
    """Empty if there is only one."""
    namespace: str = "/"
    node_name: str = "roburoc4"
    frames: Frames = field(default_factory=Frames)
    tf: bool = True
    """Publish the robot's pose on /tf; off if another node publishes a better estimate."""
    remap: Mapping[str, str] = field(default_factory=dict)
    period_ms: Mapping[str, int] = field(default_factory=dict)
    drive: DriveConfig = field(default_factory=DriveConfig)
    robot_file: str | None = None
    """What roburoc4 first-contact or calibrate wrote for this robot."""

    def topics(self) -> dict[str, Topic]:
        """Return what it publishes, by key, with remapped names."""
        return {
            key: topic._replace(name=self.remap.get(key, topic.name))
            for key, topic in PUBLISHED.items()
            if self.tf or key != "tf"
        }

    def subscriptions(self) -> list[Topic]:
        """Return what it listens to: stop, and cmd_vel if driving is enabled."""
        found = list(STOPS)
        if self.drive.enabled:
            found.append(CMD_VEL if self.drive.stamped else CMD_VEL_UNSTAMPED)
        return [one._replace(name=self.remap.get(one.name, one.name)) for one in found]


@dataclass(frozen=True)
class Config:
    """All robots, and the ROS 2 system that they appear in."""

    robots: tuple[RobotConfig, ...]
    domain: int = 0
    distro: str | None = None
    """The one that the others run; None: derived from what they announce."""
    interface: str | None = None
    peers: tuple[str, ...] = ()
    """Hosts that are also searched for nodes."""
    multicast: bool = True


class _Setting(NamedTuple):
    check: Callable[[Any], Any]
    """Returns the value to use; raises ValueError if there is none."""
    usable: str


def _text(fits: Callable[[str], object]) -> Callable[[Any], str]:
    def check(value: Any) -> str:
        if not isinstance(value, str) or not fits(value):
            raise ValueError(value)
        return value

    return check


def _yes(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(value)  # noqa: TRY004
    return value


def _between(lowest: int, highest: int) -> Callable[[Any], int]:
    def check(value: Any) -> int:
        if isinstance(value, str) and value.isdecimal():
            value = int(value)
        if type(value) is not int or not lowest <= value <= highest:
            raise ValueError(value)
        return value

    return check


def _speed(highest: float) -> Callable[[Any], float]:
    def check(value: Any) -> float:
        if type(value) not in {int, float, str} or not 0.001 <= (found := float(value)) <= highest:
            raise ValueError(value)
        return found

    return check


def _remap(value: Any) -> dict[str, str]:
    if not isinstance(value, dict) or not value.keys() <= _TOPICS:
        raise ValueError(value)
    if not all(isinstance(to, str) and is_topic(to) for to in value.values()):
        raise ValueError(value)
    return value


def _periods_ms(value: Any) -> dict[str, int]:
    periods = value if isinstance(value, dict) else dict.fromkeys(STATUS_SERVICES, value)
    if not periods.keys() <= STATUS_SERVICES.keys():
        raise ValueError(value)
    if not all(type(period) is int and period in _PERIODS_MS for period in periods.values()):
        raise ValueError(value)
    return periods


def _robot_file(value: Any) -> str:
    try:
        robot_file.load(str(value))
    except ArgumentError as error:  # which names line and remedy
        raise ConfigError(f"robot_file: {error}") from None
    return str(value)


_TOPICS = {*PUBLISHED, CMD_VEL.name, STOPS[0].name}
_FRAME_USABLE = "a frame: letters, digits, _ . / -"
ROBOT_SETTINGS = {
    "address": _Setting(_text(bool), "the robot's address, HOST or HOST:PORT"),
    "namespace": _Setting(_text(is_namespace), "a namespace such as /red, or /"),
    "node_name": _Setting(_text(is_node), "letters, digits and _"),
    "odom_frame": _Setting(_text(_FRAME.fullmatch), _FRAME_USABLE),
    "base_frame": _Setting(_text(_FRAME.fullmatch), _FRAME_USABLE),
    "map_frame": _Setting(_text(_FRAME.fullmatch), _FRAME_USABLE),
    "frame_prefix": _Setting(_text(_FRAME.fullmatch), _FRAME_USABLE),
    "tf": _Setting(_yes, "true or false"),
    "remap": _Setting(
        _remap, f"topics such as {{odom: odometry}}, of {', '.join(sorted(_TOPICS))}"
    ),
    "enable_drive": _Setting(_yes, "true or false"),
    "twist": _Setting(_yes, "true for geometry_msgs/Twist, false for TwistStamped"),
    "lease_ms": _Setting(_between(20, 1000), "20 to 1000"),
    "max_age_ms": _Setting(_between(0, 60000), "0 (any age) to 60000"),
    "max_linear_m_s": _Setting(_speed(5.0), "0.001 to 5 m/s"),
    "max_angular_rad_s": _Setting(_speed(10.0), "0.001 to 10 rad/s"),
    "max_linear_m_s2": _Setting(_speed(100.0), "0.001 to 100 m/s2"),
    "max_angular_rad_s2": _Setting(_speed(100.0), "0.001 to 100 rad/s2"),
    "robot_file": _Setting(_robot_file, "a file of roburoc4 first-contact or calibrate"),
    "period_ms": _Setting(
        _periods_ms,
        "a multiple of 10, 10 to 2550, or such by service: " + ", ".join(STATUS_SERVICES),
    ),
}
"""What can be set for each robot, or for all."""
PROGRAM_SETTINGS = {
    "domain": _Setting(_between(0, HIGHEST_DOMAIN), f"0 to {HIGHEST_DOMAIN}"),
    "distro": _Setting(_text(lambda text: text in DISTROS), ", ".join(DISTROS)),
    "interface": _Setting(_text(bool), "a network interface, such as eth0"),
}


def checked(name: str, value: Any, where: str = "") -> Any:
    """Return a setting's value, or raise ConfigError; ``where`` it was found."""
    setting = ROBOT_SETTINGS.get(name) or PROGRAM_SETTINGS[name]
    try:
        return setting.check(value)
    except ValueError:
        raise ConfigError(
            f"{where or name}: {value!r} cannot be used: give {setting.usable}"
        ) from None


def robot_config(name: str, settings: Mapping[str, Any]) -> RobotConfig:
    """Make a robot's configuration from its settings; its name is also its default namespace."""
    defaults = RobotConfig(settings["address"])
    file = settings.get("robot_file")
    known = {} if file is None else robot_file.load(file)
    return RobotConfig(
        settings["address"],
        name,
        settings.get("namespace", f"/{name}"),
        settings.get("node_name", defaults.node_name),
        Frames(
            settings.get("odom_frame", defaults.frames.odom),
            settings.get("base_frame", defaults.frames.base),
            settings.get("frame_prefix", f"{name}/" if name else ""),
            settings.get("map_frame", defaults.frames.map),
        ),
        settings.get("tf", defaults.tf),
        settings.get("remap", defaults.remap),
        settings.get("period_ms", defaults.period_ms),
        DriveConfig(
            settings.get("enable_drive", defaults.drive.enabled),
            not settings.get("twist", not defaults.drive.stamped),
            settings.get("lease_ms", defaults.drive.lease_ms),
            settings.get("max_age_ms", defaults.drive.max_age_ms),
            settings.get("max_linear_m_s", defaults.drive.max_linear_m_s),
            settings.get("max_angular_rad_s", defaults.drive.max_angular_rad_s),
            settings.get("max_linear_m_s2", defaults.drive.max_linear_m_s2),
            settings.get("max_angular_rad_s2", defaults.drive.max_angular_rad_s2),
            known.get("scale_linear", 1.0),
            known.get("scale_angular", 1.0),
        ),
        file,
    )


def whole(robots: tuple[RobotConfig, ...], program: Mapping[str, Any]) -> Config:
    """Make the configuration of these robots and of the program's settings."""
    interface = program.get("interface")
    return Config(
        robots,
        program.get("domain", 0),
        program.get("distro"),
        None if interface is None else checked("interface", interface),
        program.get("peers", ()),
        program.get("multicast", True),
    )


def check_distinct(robots: tuple[RobotConfig, ...]) -> None:
    """Refuse robots whose nodes would have the same name."""
    nodes: dict[str, str] = {}
    for robot in robots:
        node = f"{robot.namespace.rstrip('/')}/{robot.node_name}"
        if node in nodes:
            raise ConfigError(
                f"the robots {nodes[node]} and {robot.name} are both the node {node}: give one of "
                "them another namespace"
            )
        nodes[node] = robot.name


# ------------------------------------------------------------------------------------------- file


class FileSettings(NamedTuple):
    """The contents of a YAML file, checked."""

    program: dict[str, Any]
    common: dict[str, Any]
    """For all robots."""
    robots: dict[str, dict[str, Any]]


def read_file(path: Path) -> FileSettings:
    """Read a YAML file; ConfigError names the line."""
    import yaml

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(
            f"{path} cannot be read ({getattr(error, 'strerror', 'no text')}): give another file"
        ) from None
    try:
        return _YamlFile(path, text).read()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise ConfigError(
            f"{path}, line {line}: {error.problem or error.context}: correct the YAML there"
        ) from None


class _YamlFile:
    """Values with their line numbers."""

    def __init__(self, path: Path, text: str) -> None:
        import yaml

        self._path = path
        self._loader = yaml.SafeLoader(text)

    def read(self) -> FileSettings:
        root = self._loader.get_single_node()
        found = FileSettings({}, {}, {})
        for name, (line, node) in self._members(root, 1).items():
            if name == "robots":
                for robot, (at, its) in self._members(node, line).items():
                    if not is_node(robot):
                        raise self._error(
                            at, f"'{robot}' is not a valid name: give letters, digits and _"
                        )
                    settings = {
                        key: self._checked(key, *value, ROBOT_SETTINGS)
                        for key, value in self._members(its, at).items()
                    }
                    found.robots[robot] = settings
            elif name in PROGRAM_SETTINGS:
                found.program[name] = self._checked(name, line, node, PROGRAM_SETTINGS)
            else:
                found.common[name] = self._checked(name, line, node, ROBOT_SETTINGS)
        return found

    def _members(self, node: Any, line: int) -> dict[str, tuple[int, Any]]:
        if node is None or not isinstance(node.value, list) or node.id != "mapping":
            raise self._error(line, "names and values are missing: write them as 'tf: false'")
        members: dict[str, tuple[int, Any]] = {}
        for key, value in node.value:
            name, at = str(key.value), key.start_mark.line + 1
            if name in members:
                raise self._error(at, f"{name} is given twice: remove one of the two")
            members[name] = (at, value)
        return members

    def _checked(self, name: str, line: int, node: Any, known: dict[str, _Setting]) -> Any:
        if name not in known:
            all_known = sorted({*PROGRAM_SETTINGS, *ROBOT_SETTINGS, "robots"})
            raise self._error(
                line, f"there is no setting {name} here: there are {', '.join(all_known)}"
            )
        value = self._loader.construct_object(node, deep=True)
        return checked(name, value, f"{self._path}, line {line}: {name}")

    def _error(self, line: int, text: str) -> ConfigError:
        return ConfigError(f"{self._path}, line {line}: {text}")
