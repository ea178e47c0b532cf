# SPDX-License-Identifier: MIT
"""Tables of publishers and participants; these come and go, so the tables are bounded."""

from typing import TypeVar

_K = TypeVar("_K")
_V = TypeVar("_V")
MOST = 1000


def keep(table: dict[_K, _V], key: _K, value: _V) -> None:
    """Set an entry; the oldest ones are dropped to make room."""
    table.pop(key, None)
    table[key] = value
    while len(table) > MOST:
        del table[next(iter(table))]
