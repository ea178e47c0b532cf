# SPDX-License-Identifier: MIT
"""The command that is a robot."""
