# SPDX-License-Identifier: MIT
"""Where the programs under test are."""

import os
import shutil
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]


class Programs:
    """Programs of a build folder ($ROBUROC4_BIN), and LCM's own (by $LCM_BIN, else $PATH)."""

    def __init__(self) -> None:
        self.folder = Path(os.environ.get("ROBUROC4_BIN", CHECKOUT / "build" / "bin"))

    @staticmethod
    def checkout() -> Path:
        return CHECKOUT

    def __call__(self, name: str) -> Path:
        path = self.folder / name
        assert path.exists(), f"{path} is missing: build it, or name its folder in $ROBUROC4_BIN"
        return path

    @staticmethod
    def of_lcm(name: str) -> Path:
        folder = os.environ.get("LCM_BIN")
        found = shutil.which(name, path=folder)
        assert found, f"{name} is missing in {folder or '$PATH'}: install Debian's liblcm-bin"
        return Path(found)
