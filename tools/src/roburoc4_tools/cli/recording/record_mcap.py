# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE.mcap`: statuses and events as ROS 2 messages."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from .. import session
from ..errors import ExitCode, refused, unwritable
from ..output import print_json
from ..progress import progress

if TYPE_CHECKING:
    from roburoc4 import Robot

    from ...ros.rosbag import RosBag
    from ..options import Options

_LOOK_S = 0.2
_CHUNK = 16 * 1024  # about a second: a killed process loses this much


def run(options: Options) -> int:
    """Record until the time is over."""
    import mcap.writer  # noqa: F401  # if it is missing, no file is made

    from ...ros.rosbag import RosBag

    with session.connected(options) as robot:
        try:
            file = options.file.open("wb")
        except OSError as error:
            raise unwritable(options.file, error) from None
        with file:
            offset_s = time.time() - robot.now_s
            bag = RosBag(file, robot, robot.address, offset_s, chunk_size=_CHUNK)
            try:
                try:
                    _read(options, robot, bag, file.flush)
                finally:
                    bag.finish()
            except OSError as error:
                raise refused(
                    f"{options.file} cannot be written any more ({error.strerror}): free some "
                    "space, and save what is in it with roburoc4 recover"
                ) from None
            finally:
                _report(options, bag)
        session.refuse_loss(
            robot, options.robot, "the file ends there; check the robot's power and cable"
        )
    return ExitCode.FINE


def _read(options: Options, robot: Robot, bag: RosBag, flush: Callable[[], object]) -> None:
    from roburoc4.notices import texts_of

    from ...recordings import RecordedEvent

    statuses, events, facts = robot.statuses(), robot.events(), robot.facts
    length_s = options.seconds or math.inf
    begun_s = time.monotonic()
    with progress("recording", options.seconds) as show:
        while (elapsed_s := time.monotonic() - begun_s) < length_s:
            for status in statuses.take(min(_LOOK_S, length_s - elapsed_s)):
                bag.add(status)
            before, facts = facts, robot.facts
            for level, text in texts_of(events.take(), before, facts, watches=True):
                bag.add(RecordedEvent(round(robot.now_s * 1e6), level, text))
            flush()
            show(elapsed_s, f"recording  {bag.messages} messages")


def _report(options: Options, bag: RosBag) -> None:
    if options.json:
        print_json({"file": str(options.file), "messages": bag.messages})
    else:
        print(f"{options.file}: {bag.messages} messages")
