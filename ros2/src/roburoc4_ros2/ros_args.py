# SPDX-License-Identifier: MIT
"""ROS 2's own arguments of a node, as rcl reads them: what launch and `ros2 run` pass."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from roburoc4_tools.ros.published import CMD_VEL, PUBLISHED, STOPS

from .config import ROBOT_SETTINGS, ConfigError, RobotConfig, checked, robot_config
from .names import is_namespace, is_node, resolve

# By the key of a remap: the names on which ROS's rules work.
_NAMES = {
    **{key: topic.name for key, topic in PUBLISHED.items()},
    **{topic.name: topic.name for topic in (CMD_VEL, *STOPS)},
}
_RULE = re.compile(r"(?:([A-Za-z]\w*):)?([^:]+):=(.*)", re.ASCII)
_WITH_VALUE = {
    "-r": "rule",
    "--remap": "rule",
    "-p": "parameter",
    "--param": "parameter",
    "--params-file": "file",
    "-e": "enclave",
    "--enclave": "enclave",
    "--log-level": "log",
    "--log-config-file": "log",
    "--log-file-name": "log",
}
# Where this node logs does not change: the terminal, and /rosout.
_LOGGING = re.compile(r"--(enable|disable)-(rosout|stdout|external-lib)-logs")
_NODE_NAMES = ("__node", "__name")
# They are no parameters here: names and remaps have rules of their own.
_NO_PARAMETERS = ("namespace", "node_name", "remap")


def read(arguments: Sequence[str], address: str) -> RobotConfig:
    """Return the robot of ``[--ros-args ... [--]]``; ConfigError says what cannot be obeyed."""
    rules: list[tuple[str, str, str]] = []
    given: list[tuple[str, Any]] = []
    for kind, value in _pairs(arguments):
        if kind == "rule":
            rules.append(_rule(value, "--remap"))
        elif kind == "parameter":
            given.append(("parameter", _rule(value, "--param")))
        elif kind == "file":
            given.append(("file", Path(value)))
        elif kind == "enclave" and value != "/":
            raise ConfigError(f"--enclave: {value} needs DDS Security, which is not supported")
    settings: dict[str, Any] = {"address": address}
    for node, name, value in rules:
        if not node and name == "__ns":
            namespace = value if value.startswith("/") else f"/{value}"
            if not is_namespace(namespace):
                raise ConfigError(f"--remap __ns: {value!r} is no namespace: give one such as /red")
            settings["namespace"] = namespace
        elif not node and name in _NODE_NAMES:
            settings["node_name"] = value
            if not is_node(value):
                raise ConfigError(f"--remap {name}: {value!r} is no name: give letters and digits")
    plain = robot_config("", settings)
    settings["remap"] = _remaps(rules, plain)
    for kind, value in given:
        found = _file(value, plain) if kind == "file" else _one(value, plain)
        for name, parameter in found.items():
            if name == "period_ms" and isinstance(settings.get(name), dict):
                parameter = settings[name] | parameter
            settings[name] = parameter
    for name, value in settings.items():
        checked(name, value, f"the parameter {name}")
    return robot_config("", settings)


def _pairs(arguments: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the kind and the value of each argument of ROS."""
    waiting, is_ros = iter(arguments), False
    for argument in waiting:
        if argument == "--ros-args":
            is_ros = True
        elif argument == "--" and is_ros:
            is_ros = False
        elif not is_ros:
            raise ConfigError(
                f"{argument} is no argument of this program: give those of ROS, after --ros-args"
            )
        elif argument in _WITH_VALUE:
            value = next(waiting, None)
            if value is None:
                raise ConfigError(f"{argument}: a value is missing")
            yield _WITH_VALUE[argument], value
        elif not _LOGGING.fullmatch(argument):
            raise ConfigError(f"{argument} is no argument of ROS: see `ros2 run --help`")


def _rule(text: str, option: str) -> tuple[str, str, str]:
    match = _RULE.fullmatch(text)
    if match is None:
        raise ConfigError(f"{option}: {text!r} has no ':=': write it as name:=value")
    return match[1] or "", match[2], match[3]


def _remaps(rules: list[tuple[str, str, str]], robot: RobotConfig) -> dict[str, str]:
    """Return the rules for topics of this node; others are for other nodes, as in ROS."""
    ours = {resolve(name, robot.namespace): key for key, name in _NAMES.items()}
    found: dict[str, str] = {}
    for node, name, value in rules:
        if name.startswith("__") or (node and node != robot.node_name):
            continue
        # The first rule that fits counts.
        if (key := ours.get(resolve(name, robot.namespace))) is not None:
            found.setdefault(key, value)
    return found


def _one(rule: tuple[str, str, str], robot: RobotConfig) -> dict[str, Any]:
    import yaml

    node, name, text = rule
    if node and node != robot.node_name:
        return {}
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        value = text
    return _settings({name: value}, f"--param {name}")


def _file(path: Path, robot: RobotConfig) -> dict[str, Any]:
    """Return the parameters of a file for this node: of all patterns that fit, the later win."""
    import yaml

    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        why = getattr(error, "strerror", None) or str(error).replace("\n", " ")
        raise ConfigError(f"--params-file: {path} cannot be read ({why})") from None
    full = resolve(robot.node_name, robot.namespace)
    found: dict[str, Any] = {}
    for pattern, parameters in _nodes(document, ""):
        if _fits(pattern, full):
            found |= _settings(parameters, str(path))
    return found


def _nodes(document: Any, place: str) -> Iterator[tuple[str, dict[str, Any]]]:
    for name, inner in document.items() if isinstance(document, dict) else ():
        if name == "ros__parameters":
            if isinstance(inner, dict):
                yield place, inner
        else:
            yield from _nodes(inner, f"{place}/{str(name).strip('/')}")


def _fits(pattern: str, node: str) -> bool:
    parts = [
        ".*" if part == "/**" else "/[^/]+" if part == "/*" else re.escape(part)
        for part in re.findall("/[^/]*", pattern)
    ]
    return re.fullmatch("".join(parts), node) is not None


def _settings(parameters: dict[str, Any], where: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in parameters.items():
        if name.startswith("qos_overrides"):
            continue
        if name == "use_sim_time":
            if value is not False:
                raise ConfigError(
                    f"{where}: use_sim_time is not supported: stamps are this computer's time"
                )
            continue
        head, _, rest = name.partition(".")
        if head not in ROBOT_SETTINGS or head in _NO_PARAMETERS or (rest and head != "period_ms"):
            known = ", ".join(sorted(set(ROBOT_SETTINGS) - set(_NO_PARAMETERS)))
            raise ConfigError(f"{where}: there is no parameter {name}: there are {known}")
        found[head] = {**found.get(head, {}), rest: value} if rest else value
    return found
