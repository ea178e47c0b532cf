# SPDX-License-Identifier: MIT
"""ROS 2's own settings are obeyed, or refused with the reason."""

from typing import Any

import pytest

from roburoc4_ros2 import environment
from roburoc4_ros2.config import ConfigError

PEERS = {"ROS_STATIC_PEERS": "10.0.0.2;red.local"}


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, {"peers": ()}),
        ({"ROS_LOCALHOST_ONLY": "1"} | PEERS, {"interface": "lo"}),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, {"interface": "lo"}),
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"} | PEERS,
            {"peers": ("localhost", "10.0.0.2", "red.local"), "multicast": False},
        ),
        (PEERS, {"peers": ("10.0.0.2", "red.local")}),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"} | PEERS, {}),
        (
            {"ROS_DOMAIN_ID": "7", "ROS_DISTRO": "humble"},
            {"domain": 7, "distro": "humble", "peers": ()},
        ),
        ({"ROS_SECURITY_ENABLE": "true"}, {"peers": ()}),
    ],
)
def test_settings_are_obeyed_as_by_ros(given: dict[str, str], expected: dict[str, Any]) -> None:
    assert environment.settings(given) == expected


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ROS_DISTRO", "jazy"),
        ("ROS_DOMAIN_ID", "300"),
        ("ROS_LOCALHOST_ONLY", "yes"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"),
        ("ROS_DISCOVERY_SERVER", "10.0.0.1:11811"),
        ("ROS_SECURITY_STRATEGY", "Enforce"),
    ],
)
def test_what_cannot_be_obeyed_is_refused_by_name(name: str, value: str) -> None:
    with pytest.raises(ConfigError, match=f"^{name}: .*: (give|unset|keep)"):
        environment.settings({"ROS_SECURITY_ENABLE": "true", name: value})


def test_what_is_obeyed_in_part_is_a_warning() -> None:
    assert environment.warnings({"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"}) == []
    (rmw,) = environment.warnings({"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"})
    assert "rmw_zenoh_cpp" in rmw
    (security,) = environment.warnings({"ROS_SECURITY_ENABLE": "true"})
    assert "DDS Security" in security
