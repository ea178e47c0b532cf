# SPDX-License-Identifier: MIT
"""How a robot's wheels count, by how it really moves: a small file, and the numbers in it."""

import json
from os import PathLike
from pathlib import Path

from .constants import Result
from .errors import ArgumentError

_LEAST, _MOST = 0.5, 2.0


def load(path: str | PathLike[str]) -> dict[str, float]:
    """Return ``scale_linear`` and ``scale_angular`` of a file that ``roburoc4 calibrate`` wrote."""
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
        scales = {name: float(found[name]) for name in ("scale_linear", "scale_angular")}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise ArgumentError(
            f"{path}: no calibration can be read ({error}): run roburoc4 calibrate", Result.CONFIG
        ) from error
    return {name: checked(name, scale) for name, scale in scales.items()}


def checked(name: str, scale: float) -> float:
    """Refuse a scale that no robot has."""
    if not _LEAST <= scale <= _MOST:
        raise ArgumentError(
            f"{name}: {scale:g} is not {_LEAST:g} to {_MOST:g}: measure again", Result.CONFIG
        )
    return scale


def save(path: str | PathLike[str], scale_linear: float, scale_angular: float) -> None:
    """Write the file that :func:`load` reads."""
    scales = {"scale_linear": round(scale_linear, 4), "scale_angular": round(scale_angular, 4)}
    Path(path).write_text(json.dumps(scales) + "\n", encoding="utf-8")
