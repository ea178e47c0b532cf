# SPDX-License-Identifier: MIT
"""Every status of the robot is on the bus: once, with its values, at the right time."""

import itertools
import struct
import time
from collections.abc import Callable
from typing import Any

import pytest
import roburoc4
import roburoc4_lcm
from rig import Bridge, Bus, Robot

StartBridge = Callable[..., Bridge]

CHANNELS = {
    roburoc4.DifferentialStatus: "ROBUROC4_DIFFERENTIAL",
    roburoc4.LocalizationStatus: "ROBUROC4_LOCALIZATION",
    roburoc4.BatteryStatus: "ROBUROC4_BATTERY",
    roburoc4.TelemeterStatus: "ROBUROC4_TELEMETER",
    roburoc4.IoCardStatus: "ROBUROC4_IOCARD",
}
FAST = [
    f"--period-ms={service}=10"
    for service in ("differential", "localization", "battery", "telemeter", "iocard")
]


def values_of(message: Any) -> tuple[Any, ...]:
    """The record that the robot's status decodes to, from the message."""
    match message:
        case roburoc4_lcm.differential_status_t():
            return (
                message.robot_cycles,
                message.target_linear_m_s,
                message.current_linear_m_s,
                message.target_angular_rad_s,
                message.current_angular_rad_s,
            )
        case roburoc4_lcm.localization_status_t():
            return (
                message.robot_cycles,
                message.x_m,
                message.y_m,
                message.theta_rad,
                message.flags,
            )
        case roburoc4_lcm.battery_status_t():
            return (message.robot_cycles, message.state, message.remaining_percent)
        case roburoc4_lcm.telemeter_status_t():
            return (message.robot_cycles, tuple(seen.distance_m for seen in message.telemeters))
        case roburoc4_lcm.iocard_status_t():
            return (
                message.robot_cycles,
                tuple(message.analog_inputs),
                tuple(message.digital_inputs),
            )
    raise AssertionError(message)


def as_float(value: Any) -> Any:
    """A number as 32 bits hold it: Python's package gives the shortest one that means the same."""
    if isinstance(value, tuple):
        return tuple(as_float(each) for each in value)
    return struct.unpack("f", struct.pack("f", value))[0] if isinstance(value, float) else value


def said(robot: Robot, kind: type) -> list[tuple[Any, ...]]:
    """All statuses of a service that were handed to the bridge, without the host's times."""
    found = [tuple(status[:-2]) for _, status in robot.tap.statuses() if type(status) is kind]
    return found if kind is roburoc4.LocalizationStatus else [as_float(values) for values in found]


def test_every_status_arrives_once_and_with_equal_values(
    robot: Robot, bus: Bus, start_bridge: StartBridge
) -> None:
    bridge = start_bridge("--enable-drive", *FAST).arms()
    # Something that changes, so that a wrong value cannot hide.
    robot.tell("pad rt 0.25")
    robot.tell("pad ljx -0.5")
    robot.tell("battery 37")
    robot.tell("pad a down")
    time.sleep(2.0)
    robot.tell("pad release")
    robot.tap.cut = True
    time.sleep(0.3)
    for kind, channel in CHANNELS.items():
        heard = [values_of(message) for message in bus.decoded(channel)]
        expected = said(robot, kind)
        assert len(heard) > 150, channel
        # What came before the bridge knew which service that was is not republished.
        begin = expected.index(heard[0])
        assert begin < 60, channel
        assert heard == expected[begin:], channel
    assert bridge.statistics.lost == 0


def test_times_are_those_of_the_measurement(
    robot: Robot, bus: Bus, start_bridge: StartBridge
) -> None:
    start_bridge("--period-ms=localization=10").connects()
    time.sleep(2.0)
    messages = bus.decoded("ROBUROC4_LOCALIZATION")[100:]
    arrival = {
        status.robot_cycles: time_us
        for time_us, status in robot.tap.statuses()
        if isinstance(status, roburoc4.LocalizationStatus)
    }
    assert len(messages) > 50
    for earlier, later in itertools.pairwise(messages):
        cycles = later.robot_cycles - earlier.robot_cycles
        # A cycle is 10 ms on the robot's clock, whatever the network did to its datagram.
        assert later.utime - earlier.utime == pytest.approx(10_000 * cycles, abs=5_000)
    # The quickest datagram shows how far the clocks are apart; a busy machine makes others late.
    late_us = [arrival[message.robot_cycles] - message.utime for message in messages]
    assert -20_000 < min(late_us) < 20_000


def test_channels_can_be_renamed(robot: Robot, bus: Bus, start_bridge: StartBridge) -> None:
    start_bridge("--prefix", "PIONEER")
    for end in ("DIFFERENTIAL", "BRIDGE_STATE", "PROPERTIES"):
        bus.hears(f"PIONEER_{end}")
    assert not [message for message in bus.messages if message.channel.startswith("ROBUROC4")]
