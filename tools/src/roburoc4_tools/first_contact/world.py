# SPDX-License-Identifier: MIT
"""What the steps need of the world: datagrams, time, and a person beside the robot."""

from abc import ABC, abstractmethod
from typing import NamedTuple


class Datagram(NamedTuple):
    """One that arrived at one of our ports."""

    at_s: float
    port: int
    data: bytes
    other_port: bool
    """Whether it came from another port than the one that we send to."""


class World(ABC):
    """The network and the people: real ones, or simulated ones in virtual time."""

    @property
    @abstractmethod
    def now_s(self) -> float:
        """The time, by a clock that never jumps."""

    @abstractmethod
    def send(self, port: int, data: bytes) -> None:
        """Send from our port with this number, which opens it."""

    @abstractmethod
    def wait(self, seconds: float) -> list[Datagram]:
        """Let time pass; return what arrived."""

    @abstractmethod
    def close(self, port: int) -> None:
        """Close one of our ports, so that the system refuses what arrives at it."""

    @abstractmethod
    def reopen(self, port: int) -> None:
        """Open it again, with the same number, and send nothing."""

    @abstractmethod
    def say(self, text: str) -> None:
        """Tell the people something."""

    @abstractmethod
    def please(self, key: str, text: str) -> None:
        """Ask for something to be done; return when the person says that it is."""

    @abstractmethod
    def ask(self, key: str, text: str) -> str:
        """Ask a question; return the answer."""

    @abstractmethod
    def countdown(self, key: str, text: str, seconds: float) -> None:
        """Begin a countdown at whose zero the person does this; return at once."""

    @abstractmethod
    def hold(self, text: str) -> None:
        """Wait until the person presses that key anew: one that is held must be let go first."""

    @abstractmethod
    def held(self) -> bool:
        """Whether the person holds the key without which nothing moves."""
