# SPDX-License-Identifier: MIT
"""ROS 2's own settings, from the environment: obeyed, or refused with the reason.

docs/ros2.md lists them. As in rcl, ROS_LOCALHOST_ONLY=1 wins over its successors.
"""

from collections.abc import Mapping
from typing import Any

from .config import DISTROS, ConfigError, checked

_LOOPBACK = "lo"
_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_COMPATIBLE = ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp")


def settings(environment: Mapping[str, str]) -> dict[str, Any]:
    """Return the program's settings; ConfigError where one cannot be obeyed."""
    _check_security(environment)
    if environment.get("ROS_DISCOVERY_SERVER"):
        raise ConfigError(
            "ROS_DISCOVERY_SERVER: Fast DDS's discovery server is not supported: unset it, and "
            "name the others in ROS_STATIC_PEERS"
        )
    found: dict[str, Any] = {}
    if domain := environment.get("ROS_DOMAIN_ID"):
        found["domain"] = checked("domain", domain, "ROS_DOMAIN_ID")
    if distro := environment.get("ROS_DISTRO"):
        if distro not in DISTROS:
            raise ConfigError(
                f"ROS_DISTRO: {distro!r} is not a distribution of ROS 2: give {', '.join(DISTROS)}"
            )
        found["distro"] = distro
    return found | _discovery(environment)


def warnings(environment: Mapping[str, str]) -> list[str]:
    """Describe what is obeyed only in part."""
    found = []
    rmw = environment.get("RMW_IMPLEMENTATION")
    if rmw and rmw not in _COMPATIBLE:
        found.append(
            f"RMW_IMPLEMENTATION is {rmw}, but this node speaks DDS: only nodes with "
            "rmw_cyclonedds_cpp or rmw_fastrtps_cpp, or behind a bridge to DDS, see it"
        )
    if _has_security(environment):
        found.append(
            "ROS_SECURITY_ENABLE is set, but this node does not support DDS Security: it runs "
            "without it, as ROS_SECURITY_STRATEGY is not Enforce"
        )
    return found


def _has_security(environment: Mapping[str, str]) -> bool:
    return environment.get("ROS_SECURITY_ENABLE", "").lower() == "true"


def _check_security(environment: Mapping[str, str]) -> None:
    if _has_security(environment) and environment.get("ROS_SECURITY_STRATEGY") == "Enforce":
        raise ConfigError(
            "ROS_SECURITY_STRATEGY: this node does not support DDS Security, which Enforce "
            "demands: keep the network apart instead, and unset ROS_SECURITY_ENABLE"
        )


def _discovery(environment: Mapping[str, str]) -> dict[str, Any]:
    localhost_only = environment.get("ROS_LOCALHOST_ONLY") or "0"
    if localhost_only not in {"0", "1"}:
        raise ConfigError(f"ROS_LOCALHOST_ONLY: {localhost_only!r} cannot be used: give 0 or 1")
    if localhost_only == "1":
        return {"interface": _LOOPBACK}
    reach = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET"
    if reach not in _RANGES:
        raise ConfigError(
            f"ROS_AUTOMATIC_DISCOVERY_RANGE: {reach!r} cannot be used: give {', '.join(_RANGES)}"
        )
    peers = tuple(filter(None, environment.get("ROS_STATIC_PEERS", "").split(";")))
    if reach == "OFF":
        raise ConfigError(
            "ROS_AUTOMATIC_DISCOVERY_RANGE: with OFF no other node could see this one: give "
            "LOCALHOST or SUBNET"
        )
    if reach == "SYSTEM_DEFAULT":
        return {}
    if reach == "LOCALHOST":
        if not peers:
            return {"interface": _LOOPBACK}
        return {"peers": ("localhost", *peers), "multicast": False}
    return {"peers": peers}
