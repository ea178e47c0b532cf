# SPDX-License-Identifier: MIT
"""Commands that find, check and set up the connection with a robot."""
