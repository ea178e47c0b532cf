# SPDX-License-Identifier: MIT
"""What all tests of this folder share."""

pytest_plugins = ["pytester", "robot_support", "strain"]
