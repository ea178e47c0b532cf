# SPDX-License-Identifier: MIT
"""The robot's node, and on request robot_state_publisher with the full description."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "roburoc4_bringup"


def generate_launch_description() -> LaunchDescription:
    """Describe what to start."""
    share = FindPackageShare(PACKAGE)
    description = LaunchConfiguration("description")
    node = {
        "package": PACKAGE,
        "executable": "node",
        "name": "roburoc4",
        "namespace": LaunchConfiguration("namespace"),
        "parameters": [LaunchConfiguration("params_file")],
        "output": "screen",
    }
    xacro = Command(["xacro ", PathJoinSubstitution([share, "urdf", "roburoc4.urdf.xacro"])])
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value=""),
            DeclareLaunchArgument(
                "params_file",
                default_value=PathJoinSubstitution([share, "config", "roburoc4.yaml"]),
            ),
            DeclareLaunchArgument(
                "description",
                default_value="false",
                description="true: robot_description with inertia and collision, by "
                "robot_state_publisher, instead of the node's own",
            ),
            Node(**node, condition=UnlessCondition(description)),
            Node(
                **node,
                condition=IfCondition(description),
                remappings=[("robot_description", "robot_description_simple")],
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                namespace=LaunchConfiguration("namespace"),
                condition=IfCondition(description),
                parameters=[{"robot_description": ParameterValue(xacro, value_type=str)}],
            ),
        ]
    )
