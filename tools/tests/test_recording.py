# SPDX-License-Identifier: MIT
"""Recordings as sources: what was sent is what is read, and events have their time."""

import random
import struct
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from capture_support import (
    BEGIN_US,
    CLIENT,
    OTHER,
    ROBOT,
    Packet,
    commands,
    discovery,
    drive,
    pcapng,
    statuses,
    write,
)

import roburoc4
from roburoc4 import protocol
from roburoc4_tools import recordings


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.pcapng"


def events(path: Path, packets: Sequence[Packet]) -> list[tuple[float, str]]:
    """Events after the client was ready: seconds from the beginning, and the text."""
    write(path, packets)
    found = [
        (item.host_us / 1e6 - BEGIN_US / 1e6, item.text)
        for item in recordings.open_recording(path).items()
        if isinstance(item, recordings.RecordedEvent)
    ]
    assert found[0][1] == "the robot is ready"
    return found[1:]


def test_statuses_have_the_values_and_times_that_were_sent(path: Path) -> None:
    packets = statuses(BEGIN_US, 2.0)
    found = list(recordings.open_recording(write(path, packets)))
    assert [status.host_us for status in found] == [packet.time_us for packet in packets]
    for status, packet in zip(found, packets, strict=True):
        sent = protocol.decode(packet.payload)._replace(host_us=packet.time_us, utc_s=status.utc_s)
        assert repr(status) == repr(sent)  # NaN differs from itself
        assert status.utc_s == pytest.approx(packet.time_us / 1e6, abs=1e-3)


def test_columns_are_arrays_in_unix_time(path: Path) -> None:
    recording = recordings.open_recording(write(path, drive(2.0)))
    columns = recording.columns("localization")
    angle = 0.5 * np.arange(40) * 0.05
    assert columns["utc_s"] == pytest.approx(BEGIN_US / 1e6 + 0.1 + np.arange(40) * 0.05, abs=1e-3)
    assert columns["x_m"] == pytest.approx(np.sin(angle))
    assert columns["theta_rad"] == pytest.approx(angle)
    assert list(columns["robot_cycles"][:3]) == [1000, 1005, 1010]
    assert recording.columns("iocard")["digital_input_21"].dtype == bool
    assert len(recordings.open_recording(path).columns("battery")["host_us"]) == 2


def test_commands_have_their_sender_and_speeds(path: Path) -> None:
    found = [
        item
        for item in recordings.open_recording(write(path, drive(1.0))).items()
        if isinstance(item, recordings.Command)
    ]
    assert {item.sender for item in found} == {"192.168.0.5:40001"}
    assert [item.telegram for item in found] == [protocol.DifferentialCommand(0.5, 0.5)] * 20 + [
        protocol.DifferentialCommand(0.0, 0.0)
    ] * 3


def test_a_drive_has_a_beginning_and_an_end(path: Path) -> None:
    assert events(path, drive(5.0)) == [
        (pytest.approx(0.100007), "192.168.0.5:40001 begins to drive"),
        (pytest.approx(5.1), "192.168.0.5:40001 stopped the robot, after 5.0 s of driving"),
    ]


def test_a_driver_that_vanishes_is_named_and_the_watchdog(path: Path) -> None:
    later = BEGIN_US + 100_000
    packets = discovery() + statuses(later, 5.0) + commands(later, 2.0)
    found = events(path, sorted(packets, key=lambda packet: packet.time_us))
    assert found[1] == (
        pytest.approx(0.1 + 1.95 + 1.0, abs=0.001),
        "192.168.0.5:40001 sent no command for 1 s after a speed: the robot's watchdog stops it",
    )


def test_a_silence_is_an_event_at_its_time_and_so_is_its_end(path: Path) -> None:
    first = statuses(BEGIN_US + 100_000, 2.0, speed=0)
    after = statuses(BEGIN_US + 12_100_000, 2.0, 2200, speed=0)
    found = events(path, [*discovery(), *first, *after])
    assert found == [
        (pytest.approx(2.05 + 1.0, abs=0.06), "the robot fell silent: connecting again"),
        (pytest.approx(12.1, abs=0.001), "the robot is ready"),
    ]


def test_the_game_pad_and_bumpers_are_events(path: Path) -> None:
    parts = [
        statuses(
            BEGIN_US + 100_000 + at * 1_000_000, 1.0, 1000 + 100 * at, digital=digital, speed=0
        )
        for at, digital in enumerate((0, 1 << 8 | 1, 0))
    ]
    assert events(path, [*discovery(), *parts[0], *parts[1], *parts[2]]) == [
        (pytest.approx(1.1), "[A] is held on the game pad: the pad drives the robot"),
        (pytest.approx(1.1), "the front bumper was pressed"),
        (pytest.approx(2.1), "[A] on the game pad was released"),
        (pytest.approx(2.1), "the front bumper was released"),
    ]


def test_only_an_unrecorded_commander_is_another_commander(path: Path) -> None:
    moved = discovery() + statuses(BEGIN_US + 100_000, 3.0)
    assert [text for _, text in events(path, moved)] == ["another client commands the robot"]
    packets = sorted([*moved, *commands(BEGIN_US + 90_000, 3.0)], key=lambda packet: packet.time_us)
    assert [text for _, text in events(path, packets)] == ["192.168.0.5:40001 begins to drive"]


def test_what_two_clients_received_is_counted_once(path: Path) -> None:
    packets = drive(2.0)
    copies = [
        packet._replace(destination=OTHER, time_us=packet.time_us + 5)
        for packet in packets
        if packet.source == ROBOT and packet.payload[0] == 0xFF
    ]
    both = sorted([*packets, *copies], key=lambda packet: packet.time_us)
    reading = recordings.open_recording(write(path, both)).read()
    found = [item for item in reading.items() if hasattr(item, "service")]
    assert len(found) == reading.counts.copies == len(copies)
    assert reading.robot.link.lost == 0


def test_loss_and_round_trips_are_the_recorded_ones(path: Path) -> None:
    chance = random.Random(1)
    packets = [
        packet
        for packet in [*discovery(), *statuses(BEGIN_US + 100_000, 60.0)]
        if packet.payload[0] != 0xFF or chance.random() > 0.1
    ]
    reading = recordings.open_recording(write(path, packets)).read()
    assert list(reading.items())
    assert reading.robot.link.loss == pytest.approx(0.1, abs=0.05)
    counts = reading.counts
    assert counts.answered == counts.requests == len(discovery()) // 2
    assert (counts.round_trip_min_us, counts.round_trip_max_us) == (400, 400)


def test_a_robot_object_uses_the_recordings_time(path: Path) -> None:
    recording = recordings.open_recording(write(path, drive(5.0)))
    with recording.connect() as robot:
        assert robot.properties.differential is not None
        assert robot.wait_for("battery").remaining_percent == 90
        robot.sleep(3.0)
        assert robot.now_s == pytest.approx(BEGIN_US / 1e6 + 3.1, abs=0.1)
        assert robot.battery.remaining_percent == 87
        assert robot.inputs["Battery voltage"] == pytest.approx(25.3, abs=0.01)
        rest = list(robot.statuses())
        assert len(rest) > 100
        assert robot.closed
        with pytest.raises(roburoc4.RobotError):
            robot.arm()


def test_other_service_ids_are_those_of_the_directory(path: Path) -> None:
    swap = {5: 6, 6: 5}

    def other(packet: Packet) -> Packet:
        data = bytearray(packet.payload)
        if data[0] == 0xFF:
            data[1] = swap.get(data[1], data[1])
        elif data[1] in (0, 4):
            data[2] = swap.get(data[2], data[2])
            if data[1:4] == b"\0\0\0" and len(data) > 5:
                data[-8:] = data[-4:-2] + struct.pack("<H", 5) + data[-8:-6] + struct.pack("<H", 6)
            if data[1] == 4 and len(data) == 7:
                data[4] = swap.get(data[4], data[4])
        return packet._replace(payload=bytes(data))

    packets = [other(packet) for packet in discovery()]
    texts = {packets[1 + 2 * (6 + at)].payload[5:] for at in (5, 6)}
    assert len(texts) == 2
    for at in (5, 6):  # the texts of the directory's entries, too
        index = 1 + 2 * (6 + at)
        text = discovery()[1 + 2 * (6 + swap[at])].payload
        packets[index] = packets[index]._replace(payload=packets[index].payload[:5] + text[5:])
    sent = statuses(BEGIN_US + 100_000, 1.0)
    found = list(recordings.open_recording(write(path, packets + [other(one) for one in sent])))
    services = [status.service for status in found]
    assert services.count("differential") == services.count("localization") == 20
    assert found[2].service == "differential"


def test_the_robot_can_be_chosen_if_there_are_several(path: Path) -> None:
    second = (b"\xc0\xa8\x00\x09", 60000)
    packets = drive(1.0)
    packets += [packet._replace(source=second) for packet in statuses(BEGIN_US, 3.0)]
    write(path, packets)
    assert recordings.open_recording(path).address == "192.168.0.9:60000"
    for name in ("192.168.0.2", "192.168.0.2:60000"):
        assert recordings.open_recording(path, name).address == "192.168.0.2:60000"
    with pytest.raises(roburoc4.RecordingError, match="nothing from"):
        recordings.open_recording(path, "10.0.0.1")


def test_a_capture_of_something_else_is_named(path: Path) -> None:
    stranger = Packet(BEGIN_US, OTHER, CLIENT, b"hello")
    with pytest.raises(roburoc4.RecordingError, match="no statuses"):
        recordings.open_recording(write(path, [stranger]))
    with pytest.raises(roburoc4.RecordingError, match="no UDP"):
        recordings.open_recording(write(path, []))
    with pytest.raises(roburoc4.RecordingError, match="none cannot be read"):
        recordings.open_recording(path.with_name("none"))


def test_a_damaged_recording_is_an_error_and_no_crash(path: Path) -> None:
    chance = random.Random(1)
    whole = pcapng(drive(1.0))
    for changes in [1, 10, 1000] * 10:
        data = bytearray(whole)
        for _ in range(changes):
            data[chance.randrange(48, len(data))] = chance.randrange(256)
        path.write_bytes(data)
        with suppress(roburoc4.RecordingError):
            for item in recordings.open_recording(path).items():
                assert item.host_us >= 0
