# SPDX-License-Identifier: MIT
"""The program ``roburoc4-sim``, which is inside of the extension."""

import sys

from . import _native


def main() -> int:
    """Run it with the arguments of this process."""
    sys.stdout.flush()
    return _native.run_sim(["roburoc4-sim", *sys.argv[1:]])
