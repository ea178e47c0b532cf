# SPDX-License-Identifier: MIT
"""What all tests of this folder share."""

pytest_plugins = ["robot_support"]  # bindings/python/tests
