# SPDX-License-Identifier: MIT
"""Commands that show what a robot does."""
