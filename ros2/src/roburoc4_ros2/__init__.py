# SPDX-License-Identifier: MIT
"""The robot as a node of ROS 2, over DDS: the command `roburoc4 ros2`."""
