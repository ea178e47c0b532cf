# SPDX-License-Identifier: MIT
"""Starts the node of the package roburoc4-ros2 where ROS 2 looks for programs."""
