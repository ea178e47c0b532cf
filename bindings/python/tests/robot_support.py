# SPDX-License-Identifier: MIT
"""A simulator behind a port, and programs as their users start them."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import hypothesis
import pytest

import roburoc4
from roburoc4 import _native, pump, udp
from roburoc4.connection import open_host
from roburoc4.settings import Settings

LONG_S = 60.0
"""Time limit of what should happen soon: generous, because a loaded machine is slow."""

# No test result depends on timing.
hypothesis.settings.register_profile(
    "roburoc4", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("roburoc4")


@pytest.fixture(autouse=True, scope="session")
def _clients_are_patient() -> Iterator[None]:
    """See patience/sitecustomize.py: in programs that tests start, and in this process.

    Not in virtual time, where no machine is too slow.
    """
    os.environ["PYTHONPATH"] = str(Path(__file__).resolve().parent / "patience")

    def open_patiently(
        host: str, threaded: bool, settings: Settings
    ) -> "tuple[_native.Connection, str]":
        return open_host(host, threaded, {"fresh_ms": 1000, **settings})

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pump, "open_host", open_patiently)
        patch.setattr(udp, "open_host", open_patiently)
        yield


@pytest.fixture
def served() -> Iterator[roburoc4.Simulator]:
    """A simulator in real time; its clock is that of time.monotonic()."""
    with roburoc4.Simulator(port=0) as simulator:
        yield simulator


@pytest.fixture
def start() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start a Python program with arguments; what still runs at the end is killed."""
    running: list[subprocess.Popen[str]] = []

    def start_program(program: str, *arguments: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", program, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        running.append(process)
        return process

    yield start_program
    for process in running:
        if process.poll() is None:
            process.kill()
        process.communicate()


def until(condition: Callable[[], object], seconds: float = LONG_S) -> None:
    """Wait until it is true; fail if it never is."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it never became true"
        time.sleep(0.001)


def size_of(path: Path) -> int:
    """The size of a file; 0 while it is not there, as where it is created once more."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def first_zero_s(simulator: roburoc4.Simulator) -> float:
    """When the first zero command came, on time.monotonic(), after a speed was seen."""
    until(lambda: simulator.state.last_linear_m_s != 0)
    until(lambda: simulator.state.last_linear_m_s == 0)
    return simulator.state.last_command_us / 1e6


def header(name: str = "") -> str:
    """The text of a C header (the core's two by default), in a checkout or an unpacked sdist."""
    if not name:
        return header("roburoc4_codec.h") + header("roburoc4.h")
    here = Path(__file__).resolve().parent
    for folder in (here.parent / "core", here.parents[2]):
        path = folder / "include" / name
        if path.exists():
            return path.read_text(encoding="utf-8")
    raise FileNotFoundError(name)
