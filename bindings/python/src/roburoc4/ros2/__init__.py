# SPDX-License-Identifier: MIT
"""The robot as a node of ROS 2, over DDS and without ROS: part of the extra `ros2`."""
