# SPDX-License-Identifier: MIT
"""`roburoc4 ros2`: the robot in a ROS 2 system, without ROS on this machine."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roburoc4_tools.cli.errors import ExitCode, usage
from roburoc4_tools.cli.options import DEFAULT_ROBOT, Options
from roburoc4_tools.cli.output import note, print_json

if TYPE_CHECKING:
    from .config import Config, RobotConfig

_SETTINGS = (
    "namespace",
    "odom_frame",
    "base_frame",
    "map_frame",
    "frame_prefix",
    "lease_ms",
    "max_age_ms",
    "max_linear_m_s",
    "max_angular_rad_s",
    "max_linear_m_s2",
    "max_angular_rad_s2",
)
"""Settings of a robot that are options of the same name, with a value."""


class Ros2Options(Options):
    """Options of the command."""

    robots: list[str] | None
    config: Path | None
    domain: str | None
    distro: str | None
    interface: str | None
    namespace: str | None
    odom_frame: str | None
    base_frame: str | None
    map_frame: str | None
    frame_prefix: str | None
    no_tf: bool
    remap: list[str]
    period_ms: str | None
    enable_drive: bool
    twist: bool
    lease_ms: str | None
    max_age_ms: str | None
    max_linear_m_s: str | None
    max_angular_rad_s: str | None
    max_linear_m_s2: str | None
    max_angular_rad_s2: str | None
    list: bool


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "ros2",
        help="show the robot in a ROS 2 system, without ROS on this machine",
        description="Publish what the robot reports as a node of ROS 2, over DDS, for as long as "
        "this runs. See docs/ros2.md.",
    )
    parser.add_argument(
        "--robot",
        dest="robots",
        metavar="[NAME=]HOST[:PORT]",
        action="append",
        help="the robot's address; several need names, which become their namespaces (default: "
        f"$ROBUROC4_ROBOT, else {DEFAULT_ROBOT})",
    )
    parser.add_argument("--config", metavar="FILE", type=Path, help="settings in YAML")
    parser.add_argument(
        "--list", action="store_true", help="print topics, types and quality of service, and end"
    )
    parser.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="as JSON")
    _add_drive(parser)
    _add_ros(parser)
    _add_names(parser)
    parser.set_defaults(run=run)


def _add_drive(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("drive")
    group.add_argument(
        "--enable-drive", action="store_true", help="obey cmd_vel: the robot can move"
    )
    group.add_argument(
        "--twist",
        action="store_true",
        help="cmd_vel is a geometry_msgs/Twist, without a stamp: a replayed bag drives the robot",
    )
    group.add_argument(
        "--lease-ms", metavar="MS", help="how long a command holds, 20 to 1000 (default: 250)"
    )
    group.add_argument(
        "--max-age-ms",
        metavar="MS",
        help="reject commands with an older stamp; 0: accept any age, so that a replayed bag "
        "drives (default: 200)",
    )
    group.add_argument(
        "--max-linear-m-s",
        metavar="M_S",
        help="ceiling of speed, in addition to the robot's own (default: 1)",
    )
    group.add_argument(
        "--max-angular-rad-s", metavar="RAD_S", help="ceiling of turn rate, likewise (default: 1.5)"
    )
    group.add_argument(
        "--max-linear-m-s2",
        metavar="M_S2",
        help="how fast a commanded speed may grow (default: any); slowing down is never limited",
    )
    group.add_argument(
        "--max-angular-rad-s2", metavar="RAD_S2", help="likewise for the turn rate (default: any)"
    )


def _add_ros(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("ROS 2")
    group.add_argument(
        "--domain", metavar="N", help="domain id, 0 to 232 (default: $ROS_DOMAIN_ID, else 0)"
    )
    group.add_argument(
        "--distro",
        metavar="NAME",
        help="the distribution that the others run; only humble differs (default: $ROS_DISTRO, "
        "else detected from what they announce)",
    )
    group.add_argument(
        "--interface",
        metavar="NAME",
        help="network interface, such as eth0 (default: the first that can multicast)",
    )


def _add_names(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("names")
    group.add_argument("--namespace", metavar="/NS", help="of node and topics (default: /)")
    group.add_argument("--odom-frame", metavar="NAME", help="default: odom")
    group.add_argument("--base-frame", metavar="NAME", help="default: base_link")
    group.add_argument(
        "--map-frame", metavar="NAME", help="also publish NAME -> odom, moved by relocalization"
    )
    group.add_argument(
        "--frame-prefix", metavar="TEXT", help="prefix of all frames (default: the robot's NAME/)"
    )
    group.add_argument(
        "--remap",
        metavar="TOPIC:=NAME",
        action="append",
        default=[],
        help="publish a topic of --list by another name",
    )
    group.add_argument("--no-tf", action="store_true", help="do not publish odom -> base_link")
    group.add_argument(
        "--period-ms",
        metavar="MS",
        help="period of all statuses, a multiple of 10 (default: 50 to 1000 by service)",
    )


def run(options: Ros2Options) -> int:
    """Publish until a signal."""
    from .config import ConfigError

    try:
        config = _config(options)
    except ConfigError as error:
        raise usage(str(error)) from None
    if options.list:
        _list(options, config)
        return ExitCode.FINE
    return serve(config)


def serve(config: Config) -> int:
    """Publish until a signal."""
    from roburoc4 import ArgumentError, NetworkError

    from . import environment
    from .participant import DdsError
    from .program import Program

    try:
        program = Program(config, note)
    except DdsError as error:
        raise usage(str(error)) from None
    except (ArgumentError, NetworkError) as error:
        raise usage(f"--robot: {error}") from None
    with program:
        for warning in environment.warnings(os.environ):
            note(warning)
        for robot in config.robots:
            node = f"{robot.namespace.rstrip('/')}/{robot.node_name}"
            print(
                f"roburoc4: node {node} in domain {config.domain}, robot at {robot.address}",
                flush=True,
            )
        program.wait()  # until a signal
    return ExitCode.FINE


# ---------------------------------------------------------------------------------- configuration


def _config(options: Ros2Options) -> Config:
    from . import environment
    from .config import FileSettings, check_distinct, read_file, robot_config, whole

    found = read_file(options.config) if options.config else FileSettings({}, {}, {})
    program = {
        "domain": _given(options.domain, "--domain", "domain"),
        "distro": _given(options.distro, "--distro", "distro"),
        "interface": _given(options.interface, "--interface", "interface"),
    }
    program = {name: value for name, value in program.items() if value is not None}
    program = environment.settings(os.environ) | found.program | program
    common = _common(options)
    robots = _robots(options, found)
    made: list[RobotConfig] = []
    for name, settings in robots.items():
        merged = found.common | settings | common
        if "address" not in merged:
            raise usage(f"{options.config}: the robot {name} has no address: give it one")
        made.append(robot_config(name, merged))
    check_distinct(tuple(made))
    return whole(tuple(made), program)


def _given(text: Any, option: str, name: str) -> Any:
    from .config import checked

    return None if text is None else checked(name, text, option)


def _common(options: Ros2Options) -> dict[str, Any]:
    """Return the settings from options, which are for all robots."""
    texts = {
        name: _given(getattr(options, name), "--" + name.replace("_", "-"), name)
        for name in _SETTINGS
    }
    given: dict[str, Any] = {name: text for name, text in texts.items() if text is not None}
    if options.no_tf:
        given["tf"] = False
    given |= {name: True for name in ("enable_drive", "twist") if getattr(options, name)}
    if options.period_ms is not None:
        whole = int(options.period_ms) if options.period_ms.isdecimal() else options.period_ms
        given["period_ms"] = _given(whole, "--period-ms", "period_ms")
    if options.remap:
        pairs = [text.partition(":=") for text in options.remap]
        for text, (_, sign, _) in zip(options.remap, pairs, strict=True):
            if not sign:
                raise usage(f"--remap: '{text}' has no ':=': write it as odom:=odometry")
        given["remap"] = _given({of: to for of, _, to in pairs}, "--remap", "remap")
    return given


def _robots(options: Ros2Options, found: Any) -> dict[str, dict[str, Any]]:
    """Return the robots by name: of options, of the file, or the default."""
    from .names import is_node

    if not options.robots:
        return found.robots or {"": {"address": found.common.get("address", options.robot)}}
    robots: dict[str, dict[str, Any]] = {}
    for text in options.robots:
        name, sign, address = text.rpartition("=")
        if sign and not is_node(name):
            raise usage(f"--robot: '{name}' cannot be a namespace: give letters, digits and _")
        if name in robots:
            raise usage("--robot: several robots need different names: --robot RED=192.168.0.2 ...")
        robots[name] = found.robots.get(name, {}) | {"address": address}
    return robots


# ------------------------------------------------------------------------------------------- list


def _list(options: Ros2Options, config: Config) -> None:
    from roburoc4_tools.ros.messages import ros_name

    from .names import resolve

    rows = [
        {
            "topic": resolve(topic.name, robot.namespace),
            "type": ros_name(topic.kind),
            "direction": direction,
            "qos": topic.profile.text,
        }
        for robot in config.robots
        for direction, topics in (
            ("published", robot.topics().values()),
            ("subscribed", robot.subscriptions()),
        )
        for topic in topics
    ]
    rows = [row for at, row in enumerate(rows) if row not in rows[:at]]  # of several robots: /tf
    if options.json:
        print_json(rows)
        return
    widths = [max(len(row[name]) for row in rows) for name in ("topic", "type", "direction")]
    for row in rows:
        cells = zip((row["topic"], row["type"], row["direction"]), widths, strict=True)
        print("  ".join(text.ljust(width) for text, width in cells) + "  " + row["qos"])
