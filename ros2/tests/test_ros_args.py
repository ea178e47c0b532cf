# SPDX-License-Identifier: MIT
"""Arguments of ROS 2: obeyed as rcl obeys them, or refused with the reason."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from roburoc4_ros2.config import ConfigError, RobotConfig
from roburoc4_ros2.ros_args import read

ADDRESS = "192.168.0.2"


def ros(*arguments: str) -> RobotConfig:
    return read(["--ros-args", *arguments], ADDRESS)


def test_names_are_remapped() -> None:
    robot = ros("-r", "__ns:=/red", "--remap", "__node:=base", "-r", "odom:=wheel_odom")
    assert (robot.namespace, robot.node_name) == ("/red", "base")
    assert robot.topics()["odom"].name == "wheel_odom"
    assert [topic.name for topic in robot.subscriptions()] == ["stop"] * 3


@pytest.mark.parametrize("rule", ["/red/odom:=/o", "odom:=/o", "base:odom:=/o"])
def test_rules_fit_as_in_rcl(rule: str) -> None:
    names = ("-r", "__ns:=/red", "-r", "__node:=base")
    assert ros(*names, "-r", rule).topics()["odom"].name == "/o"
    # The first that fits counts; those of other nodes and topics do not fit.
    several = ros(*names, "-r", "other:odom:=/x", "-r", "camera:=/x", "-r", rule, "-r", "odom:=/x")
    assert several.topics()["odom"].name == "/o"


def test_parameters_are_read_as_yaml() -> None:
    rules = (
        *("enable_drive:=true", "lease_ms:=300", "base_frame:=base", "max_linear_m_s:=0.5"),
        *("use_sim_time:=false", "period_ms.localization:=20", "period_ms.battery:=500"),
        *("other:lease_ms:=400", "qos_overrides./tf.publisher.depth:=1"),
    )
    robot = ros(*(word for rule in rules for word in ("-p", rule)))
    assert robot.drive.enabled
    assert robot.drive.lease_ms == 300
    assert robot.drive.max_linear_m_s == 0.5
    assert robot.frames.base == "base"
    assert robot.period_ms == {"localization": 20, "battery": 500}


@pytest.mark.parametrize(
    ("pattern", "fits"),
    [
        ("/**", True),
        ("/red/base", True),
        ("/*/base", True),
        ("/**/base", True),
        ("base", False),
        ("/blue/base", False),
    ],
)
def test_files_are_for_the_nodes_that_they_name(tmp_path: Path, pattern: str, fits: bool) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(f"{pattern}: {{ros__parameters: {{address: 10.0.0.9, tf: false}}}}\n")
    robot = ros("-r", "__ns:=/red", "-r", "__node:=base", "--params-file", str(file))
    assert robot.address == ("10.0.0.9" if fits else ADDRESS)
    assert robot.tf is not fits


def test_later_parameters_win(tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text("/**:\n  ros__parameters:\n    lease_ms: 100\n")
    assert ros("--params-file", str(file), "-p", "lease_ms:=200").drive.lease_ms == 200
    assert ros("-p", "lease_ms:=200", "--params-file", str(file)).drive.lease_ms == 100


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["-p", "speed:=1"], "no parameter speed"),
        (["-p", "lease_ms:=5"], "20 to 1000"),
        (["-r", "__ns:=/a//b"], "no namespace"),
        (["-r", "odom:=a b"], "remap"),
        (["-p", "use_sim_time:=true"], "use_sim_time"),
        (["--enclave", "/robot"], "DDS Security"),
        (["--params-file", "/nowhere.yaml"], "cannot be read"),
        (["--fast"], "no argument of ROS"),
    ],
)
def test_what_cannot_be_obeyed_is_refused(arguments: list[str], why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        ros(*arguments)


def test_what_launch_passes_changes_nothing_here() -> None:
    quiet = ("--log-level", "info", "--disable-rosout-logs", "--enclave", "/")
    assert ros(*quiet) == RobotConfig(ADDRESS)


def test_the_program_says_in_one_line_what_is_wrong() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "roburoc4_ros2.node", "--ros-args", "-p", "lease_ms:=5"],
        env={**os.environ, "ROS_DOMAIN_ID": "99"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("roburoc4: the parameter lease_ms")
    assert done.stderr.count("\n") == 1
