# SPDX-License-Identifier: MIT
"""robot_localization with the robot's speeds and a gyro; start the node with --no-tf."""

from launch import LaunchDescription
from launch_ros.actions import Node

SPEEDS = [True, True, False, False, False, True]  # vx, vy, vz, roll, pitch, yaw rate


def generate_launch_description() -> LaunchDescription:
    """Describe what to start. Speeds rather than the pose, and a gyro, as turns slip."""
    filter_node = Node(
        package="robot_localization",
        executable="ekf_node",
        parameters=[
            {
                "two_d_mode": True,
                "world_frame": "odom",
                "odom_frame": "odom",
                "base_link_frame": "base_link",
                "odom0": "/odom",
                "odom0_config": [False] * 6 + SPEEDS + [False] * 3,
                "imu0": "/imu/data",
                "imu0_config": [False] * 11 + [True] + [False] * 3,
            }
        ],
    )
    return LaunchDescription([filter_node])
