# SPDX-License-Identifier: MIT
"""Records as JSON types."""

import math
from enum import Enum
from typing import Any


def plain(value: Any) -> Any:
    """Convert records to JSON types: a named tuple to an object, NaN to null."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "_asdict"):
        return {name: plain(item) for name, item in value._asdict().items()}
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value
