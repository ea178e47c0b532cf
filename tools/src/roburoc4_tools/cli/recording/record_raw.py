# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE.pcapng`: every datagram, by the library's recorder."""

from __future__ import annotations

import errno
import math
import time
import warnings
from contextlib import suppress
from typing import TYPE_CHECKING

from .. import session
from ..errors import ExitCode, unwritable
from ..output import note, print_json
from ..progress import progress

if TYPE_CHECKING:
    from pathlib import Path

    from roburoc4 import Robot
    from roburoc4.records import RecorderState

    from ..options import Options

_LOOK_S = 0.2


def run(options: Options) -> int:
    """Record until the time is over."""
    try:
        if options.file.is_file():
            options.file.unlink()  # it has contents only if --force allows replacing it
        is_new = not options.file.exists()  # not a pipe
        if is_new:
            options.file.open("xb").close()
            options.file.unlink()
    except OSError as error:
        raise unwritable(options.file, error) from None
    try:
        return _record(options)
    finally:
        if is_new:
            _remove_without_answer(options.file)


def _record(options: Options) -> int:
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
                code = _report(options, robot.recorder)
    return code


def _wait(options: Options, robot: Robot) -> None:
    length_s = options.seconds or math.inf
    begun_s = time.monotonic()
    with progress("recording", options.seconds) as show:
        while (elapsed_s := time.monotonic() - begun_s) < length_s:
            robot.sleep(min(_LOOK_S, length_s - elapsed_s))
            if (state := robot.recorder) is not None:
                show(elapsed_s, f"recording  {state.recorded} datagrams")
                if state.system_error == errno.EPIPE:
                    return


def _remove_without_answer(path: Path) -> None:
    """Remove a file of requests only, so that a second try can have its name."""
    from roburoc4 import RecordingError

    from ...recordings.capture import Capture

    with suppress(OSError, RecordingError):
        if not any(datagram.inbound for datagram in Capture(path)):
            path.unlink()


def _report(options: Options, state: RecorderState | None) -> ExitCode:
    if state is None:
        return ExitCode.FINE
    if options.json:
        print_json({"file": state.path, "datagrams": state.recorded, "not_recorded": state.dropped})
    else:
        print(f"{state.path}: {state.recorded} datagrams")
    if not (state.dropped or state.system_error):
        return ExitCode.FINE
    if state.system_error == errno.EPIPE:
        note(f"the program that read {state.path}, such as Wireshark, was closed: ended")
        return ExitCode.FINE
    note(
        f"{state.dropped} datagrams are missing in {state.path} because the disk was full or slow: "
        "free some space, then record again"
    )
    return ExitCode.REFUSED
