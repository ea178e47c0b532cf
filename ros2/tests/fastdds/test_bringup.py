# SPDX-License-Identifier: MIT
"""The colcon package: built by colcon, started as `ros2 run` does, its description by xacro."""

import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as Xml
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml  # type: ignore[import-untyped]
from processes import Program, Robot
from ros import Listener

TOP = Path(__file__).resolve().parents[3]
PACKAGE = TOP / "ros2" / "roburoc4_bringup"


def tool(name: str) -> str:
    return str(Path(sys.executable).with_name(name))


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workspace")
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    subprocess.run(
        [tool("colcon"), "build", "--base-paths", str(PACKAGE)],
        cwd=folder,
        env=environment,
        check=True,
        timeout=300,
    )
    return folder / "install" / "roburoc4_bringup"


def test_the_node_starts_with_the_arguments_that_launch_passes(
    installed: Path, robot: Robot, listener: Listener, tmp_path: Path, ends: ExitStack, domain: int
) -> None:
    file = tmp_path / "launch_params"
    file.write_text(f"/**:\n  ros__parameters:\n    address: {robot.address}\n")
    (packages,) = (installed / "lib").glob("python*/site-packages")  # as its setup.sh does
    node = Program(
        tmp_path / "node.log",
        installed / "lib" / "roburoc4_bringup" / "node",
        *("--ros-args", "-r", "__node:=base", "-r", "__ns:=/red", "--params-file", str(file)),
        *("-r", "odom:=wheel_odom", "-p", "base_frame:=base"),
        environment={"ROS_DOMAIN_ID": str(domain), "PYTHONPATH": str(packages)},
    )
    ends.callback(node.end)
    node.says("node /red/base")
    assert listener.hears("rt/red/wheel_odom").message.child_frame_id == "base"


def test_what_launch_and_ros_look_for_is_installed(installed: Path) -> None:
    share = installed / "share" / "roburoc4_bringup"
    for name in ("package.xml", "launch/bringup.launch.py", "config/roburoc4.yaml"):
        assert (share / name).is_file(), name
    marker = installed / "share" / "ament_index" / "resource_index" / "packages"
    assert (marker / "roburoc4_bringup").is_file()
    header = (TOP / "include" / "roburoc4.h").read_text(encoding="utf-8")
    version = ".".join(re.findall(r"_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header)[:3])
    assert Xml.parse(share / "package.xml").getroot().findtext("version") == version


def test_the_parameters_in_the_file_are_those_that_there_are(tmp_path: Path) -> None:
    text = (PACKAGE / "config" / "roburoc4.yaml").read_text(encoding="utf-8")
    all_of_them = re.sub(r"^    # (\w+: \S+).*$", r"    \1", text, flags=re.MULTILINE)
    named = yaml.safe_load(all_of_them)["/**"]["ros__parameters"]
    assert len(named) >= 12
    file = tmp_path / "all.yaml"
    file.write_text(all_of_them)
    (tmp_path / "robot.txt").write_text("[inputs]\noverride_index = 10\n")
    check = (
        "import sys; from roburoc4_ros2.ros_args import read; "
        "print(read(['--ros-args', '--params-file', sys.argv[1]], ''))"
    )
    subprocess.run([sys.executable, "-c", check, str(file)], check=True, cwd=tmp_path)


def test_the_description_has_the_mass_and_the_frames_of_the_robot() -> None:
    xacro = "import xacro, sys; print(xacro.process_file(sys.argv[1]).toxml())"
    file = PACKAGE / "urdf" / "roburoc4.urdf.xacro"
    made = subprocess.run(
        [sys.executable, "-c", xacro, str(file)], check=True, capture_output=True, text=True
    )
    root = Xml.fromstring(made.stdout)
    masses = [float(mass.get("value", "")) for mass in root.iter("mass")]
    assert math.fsum(masses) == pytest.approx(140)
    links = {link.get("name") for link in root.iter("link")}
    children = {joint.find("child").get("link") for joint in root.iter("joint")}  # type: ignore[union-attr]
    assert links - children == {"base_link"}
    for inertia in root.iter("inertia"):
        x, y, z = (float(inertia.get(name, "")) for name in ("ixx", "iyy", "izz"))
        assert 0 < max(x, y, z) < x + y + z - max(x, y, z)  # else no body has it
    assert len(list(root.iter("collision"))) == 5
