# SPDX-License-Identifier: MIT
"""Keys and signals of a terminal, and the dead-man switch that a held key is."""
