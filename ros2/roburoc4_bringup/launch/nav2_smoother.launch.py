# SPDX-License-Identifier: MIT
"""nav2's velocity smoother, which publishes cmd_vel with stamps (Jazzy and later)."""

from launch import LaunchDescription
from launch_ros.actions import Node

SMOOTHER = "velocity_smoother"


def generate_launch_description() -> LaunchDescription:
    """Describe what to start."""
    smoother = Node(
        package="nav2_velocity_smoother",
        executable=SMOOTHER,
        name=SMOOTHER,
        remappings=[("cmd_vel", "cmd_vel_nav"), ("cmd_vel_smoothed", "cmd_vel")],
        parameters=[
            {
                "enable_stamped_cmd_vel": True,
                "smoothing_frequency": 20.0,
                "feedback": "OPEN_LOOP",
                "max_velocity": [0.6, 0.0, 0.8],
                "min_velocity": [-0.3, 0.0, -0.8],
                "max_accel": [0.5, 0.0, 1.0],
                "max_decel": [-1.0, 0.0, -1.5],
                "velocity_timeout": 0.2,
            }
        ],
    )
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager_smoother",
        parameters=[{"autostart": True, "node_names": [SMOOTHER]}],
    )
    return LaunchDescription([smoother, manager])
