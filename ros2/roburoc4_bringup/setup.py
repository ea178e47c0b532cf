# SPDX-License-Identifier: MIT
"""The package for colcon."""

from glob import glob
from xml.etree import ElementTree

from setuptools import setup

NAME = "roburoc4_bringup"
FOLDERS = ("config", "launch", "systemd", "urdf")
setup(
    name=NAME,
    version=ElementTree.parse("package.xml").findtext("version"),
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        *((f"share/{NAME}/{folder}", glob(f"{folder}/*")) for folder in FOLDERS),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    description="Starts the ROS 2 node of a RobuROC4 robot with ros2 run and ros2 launch",
    license="MIT",
    entry_points={"console_scripts": [f"node = {NAME}.node:main"]},
)
