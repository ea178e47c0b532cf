# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE.pcapng`: every datagram, by the library's recorder."""

from __future__ import annotations

import math
import time
import warnings
from typing import TYPE_CHECKING

from . import session
from .errors import ExitCode, usage
from .output import note, print_json
from .progress import progress

if TYPE_CHECKING:
    from roburoc4 import RecorderState, Robot

    from .options import RecordOptions

_LOOK_S = 0.2


def run(options: RecordOptions) -> int:
    """Record until the time is over."""
    if not options.file.absolute().parent.is_dir():
        raise usage(f"{options.file} cannot be written (no such folder): give another name")
    options.file.unlink(missing_ok=True)  # it has contents only if --force allows replacing it
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # what is missing is reported here
        with session.connected(options, record=options.file) as robot:
            try:
                _wait(options, robot)
                session.refuse_loss(
                    robot, options.robot, "the file ends there; check the robot's power and cable"
                )
            finally:
                robot.close()
                _report(options, robot.recorder)
    return ExitCode.FINE


def _wait(options: RecordOptions, robot: Robot) -> None:
    length_s = options.seconds or math.inf
    begun_s = time.monotonic()
    with progress("recording", options.seconds) as show:
        while (elapsed_s := time.monotonic() - begun_s) < length_s:
            robot.sleep(min(_LOOK_S, length_s - elapsed_s))
            if (state := robot.recorder) is not None:
                show(elapsed_s, f"recording  {state.recorded} datagrams")


def _report(options: RecordOptions, state: RecorderState | None) -> None:
    if state is None:
        return
    if options.json:
        print_json({"file": state.path, "datagrams": state.recorded, "not_recorded": state.dropped})
    else:
        print(f"{state.path}: {state.recorded} datagrams")
    if state.dropped or state.system_error:
        note(
            f"{state.dropped} datagrams are missing because the disk was full or slow: free "
            "some space, then record again"
        )
