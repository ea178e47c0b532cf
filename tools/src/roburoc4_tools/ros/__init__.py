# SPDX-License-Identifier: MIT
"""What a robot reports, as messages of ROS 2: for rosbags, and for the node of roburoc4-ros2."""
