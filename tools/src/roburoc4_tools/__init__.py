# SPDX-License-Identifier: MIT
"""What is used on the operator's machine: the command roburoc4, the dashboard, recordings."""
