# SPDX-License-Identifier: MIT
"""What all tests of this folder share."""

pytest_plugins = ["robot_support", "strain"]  # bindings/python/tests
