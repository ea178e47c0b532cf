# SPDX-License-Identifier: MIT
"""A pytest fixture: a simulated robot in virtual time."""

from collections.abc import Iterator

import pytest

from .simulator import Simulator


@pytest.fixture
def roburoc4_simulator() -> Iterator[Simulator]:
    """Return a fresh simulator in virtual time: ``robot = roburoc4_simulator.connect()``."""
    with Simulator() as simulator:
        yield simulator
