# SPDX-License-Identifier: MIT
"""Commands that make a robot move or stop."""
