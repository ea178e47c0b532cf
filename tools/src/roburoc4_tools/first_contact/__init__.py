# SPDX-License-Identifier: MIT
"""First contact: what a robot answers where the manual is silent, measured with a person's help."""
