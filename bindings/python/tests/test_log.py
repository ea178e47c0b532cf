# SPDX-License-Identifier: MIT
"""The logger `roburoc4`."""

import logging

import pytest

from roburoc4 import Simulator


def test_the_log_reports_connecting_arming_and_losses(
    roburoc4_simulator: Simulator, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, logger="roburoc4")
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        robot.sleep(0.2)
        roburoc4_simulator.set("pad_a", True)
        robot.sleep(0.2)
        roburoc4_simulator.set("power", False)
        robot.sleep(2.0)
    said = [(record.levelname, record.getMessage()) for record in caplog.records]
    for level, text in (
        ("INFO", "the simulator: connecting"),
        ("INFO", "the simulator: the robot is ready"),
        ("INFO", "the simulator: armed: drive commands are accepted"),
        ("INFO", "the simulator: [A] is held on the game pad: the pad drives the robot"),
        ("WARNING", "the simulator: disarmed: game pad override: release [A] on the game pad"),
        ("WARNING", "the simulator: the robot fell silent: connecting again"),
        ("INFO", "the simulator: closing"),
    ):
        assert (level, text) in said


def test_without_a_handler_nothing_is_printed(
    roburoc4_simulator: Simulator, capfd: pytest.CaptureFixture[str]
) -> None:
    with roburoc4_simulator.connect() as robot:
        roburoc4_simulator.set("power", False)
        robot.sleep(2.0)
    assert capfd.readouterr() == ("", "")
