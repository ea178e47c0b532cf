# SPDX-License-Identifier: MIT
"""What waits, as steps: robot.py takes them in the caller's thread, aio.py in a task.

A step looks, and says for how many seconds it wants to wait for news before the next one.
"""

from collections.abc import Awaitable, Callable, Generator
from inspect import isawaitable
from typing import Any, TypeAlias, TypeVar

from .connection import Connection
from .moves import STEP_S, Move, MoveResult
from .robot_base import name_of
from .samples import Patience

_T = TypeVar("_T")

LOOK_AGAIN_S = 0.1
"""Conditions are evaluated after every event, and this often because some depend on time alone."""

Steps: TypeAlias = Generator[float | Awaitable[Any], None, _T]


def until(
    connection: Connection, condition: Callable[[], _T], timeout: float | None, what: object
) -> Steps[_T]:
    """Wait until a condition is true, and return what it returned."""
    patience = Patience(connection.now_s, timeout, name_of(what))
    while not (found := condition()):
        yield min(patience.left_s(), LOOK_AGAIN_S)
    return found


def arming(try_to_arm: Callable[[], float]) -> Steps[None]:
    """Arm; a try returns the seconds in which another one makes sense, or 0 if it succeeded."""
    while left_s := try_to_arm():
        yield min(left_s, LOOK_AGAIN_S)


def going(move: Move, on_progress: Callable[[MoveResult], object] | None) -> Steps[MoveResult]:
    """Drive a move to its end; it is cancelled where nobody takes the next step."""
    try:
        while move.step():
            if on_progress is not None:
                shown = on_progress(move.now())
                if isawaitable(shown):
                    yield shown
            yield STEP_S
    finally:
        move.cancel()
    return move.end()
