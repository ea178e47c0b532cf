# SPDX-License-Identifier: MIT
"""Commands that make recordings, and read them."""
