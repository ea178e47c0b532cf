# SPDX-License-Identifier: MIT
"""Recordings of the link: captures to read, replay, convert and repair."""

from .recording import Command, RecordedEvent, RecordedRobot, open_recording

__all__ = ["Command", "RecordedEvent", "RecordedRobot", "open_recording"]
