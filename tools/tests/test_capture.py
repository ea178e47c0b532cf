# SPDX-License-Identifier: MIT
"""Captures of any tool are read, truncated or not; a damaged one is an error and no crash."""

import gzip
import random
from contextlib import suppress
from itertools import permutations
from pathlib import Path

import pytest
from capture_support import (
    BEGIN_US,
    CLIENT,
    LINKS,
    ROBOT,
    Packet,
    drive,
    enhanced,
    fragments,
    iocard,
    ipv6,
    pcap,
    pcapng,
    statuses,
)

from roburoc4_tools import recordings
from roburoc4_tools.recordings.capture import Capture, Datagram
from roburoc4_tools.recordings.recording import RecordingError

PACKETS = drive(0.5)


def read(path: Path, data: bytes) -> list[Packet]:
    path.write_bytes(data)
    return [Packet(*datagram[:4]) for datagram in Capture(path)]


@pytest.mark.parametrize("nanoseconds", [False, True])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("form", [pcap, pcapng])
def test_each_form_of_a_capture_has_the_same_datagrams(
    tmp_path: Path, form: object, link: str, order: str, nanoseconds: bool
) -> None:
    assert callable(form)
    data = form(PACKETS, link=link, order=order, nanoseconds=nanoseconds)
    assert read(tmp_path / "a", data) == PACKETS


@pytest.mark.parametrize("form", [pcap, pcapng])
def test_a_compressed_capture_has_the_same_datagrams(tmp_path: Path, form: object) -> None:
    assert callable(form)
    data = gzip.compress(form(PACKETS))
    assert read(tmp_path / "a.gz", data) == PACKETS
    (tmp_path / "cut.gz").write_bytes(data[:-20])
    capture = Capture(tmp_path / "cut.gz")
    found = [Packet(*datagram[:4]) for datagram in capture]
    assert found == PACKETS[: len(found)]
    assert capture.cut


def test_a_bag_of_ros_1_and_a_pipe_are_refused_with_the_reason(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="a bag of ROS 1"):
        read(tmp_path / "a.bag", b"#ROSBAG V2.0\n")
    with pytest.raises(RecordingError, match=r"is no file, .*: save it to a file first"):
        next(iter(Capture("/dev/null")))


def test_the_direction_is_read_where_the_file_has_it(tmp_path: Path) -> None:
    path = tmp_path / "a.pcapng"
    path.write_bytes(pcapng(PACKETS))
    assert {one.inbound for one in Capture(path) if one.source == ROBOT} == {True}
    assert {one.inbound for one in Capture(path) if one.source == CLIENT} == {False}
    path.write_bytes(pcap(PACKETS))
    assert {one.inbound for one in Capture(path)} == {None}


def test_fragments_are_joined_in_whatever_order_they_come(tmp_path: Path) -> None:
    packet = Packet(BEGIN_US, ROBOT, CLIENT, iocard(5))
    parts = fragments(packet)
    assert len(parts) == 4
    for order in permutations(parts):
        data = pcapng([]) + b"".join(enhanced(packet, part) for part in order)
        assert read(tmp_path / "a", data) == [packet]


def test_a_missing_fragment_only_loses_its_datagram(tmp_path: Path) -> None:
    packet = Packet(BEGIN_US, ROBOT, CLIENT, iocard(5))
    parts = fragments(packet)
    data = pcapng([]) + b"".join(enhanced(packet, part) for part in parts[1:])
    data += pcapng(PACKETS)
    assert read(tmp_path / "a", data) == PACKETS


# Length of UDP: how many tshark counts. Those of 58 were fragmented by a network with an MTU of 68.
OF_SIZE = {13: 21, 27: 10, 35: 22, 47: 20, 58: 20}


@pytest.mark.parametrize("name", ["dumpcap-fragments.pcapng", "tcpdump-fragments.pcap"])
def test_captures_of_real_tools_are_read(name: str) -> None:
    path = Path(__file__).with_name("data") / name
    sizes = [8 + len(one.payload) for one in Capture(path) if one.source[1] == 60000]
    assert {size: sizes.count(size) for size in OF_SIZE} == OF_SIZE
    recording = recordings.open_recording(path)
    assert sum(one.service == "iocard" for one in recording) == OF_SIZE[58]
    assert recording.address == "127.0.0.1:60000"


def test_ipv6_is_read(tmp_path: Path) -> None:
    packet = Packet(BEGIN_US, ROBOT, CLIENT, iocard(5))
    found = read(tmp_path / "a", pcapng([]) + enhanced(packet, ipv6(packet)))
    assert [(one.source[1], one.payload) for one in found] == [(60000, packet.payload)]


def test_two_recordings_one_after_the_other_are_one(tmp_path: Path) -> None:
    data = pcapng(PACKETS[:10], order=">") + pcapng(PACKETS[10:])
    assert read(tmp_path / "a", data) == PACKETS


@pytest.mark.parametrize("form", [pcap, pcapng])
def test_a_truncated_file_is_read_up_to_its_end(tmp_path: Path, form: object) -> None:
    assert callable(form)
    packets = statuses(BEGIN_US, 0.1)
    data = form(packets)
    path = tmp_path / "a"
    for size in range(4, len(data)):
        path.write_bytes(data[:size])
        capture = Capture(path)
        found = [Packet(*datagram[:4]) for datagram in capture]
        assert found == packets[: len(found)]
        assert capture.position + capture.cut == size


@pytest.mark.parametrize(
    ("data", "text"), [(b"", "empty"), (b"a text, no capture", "neither pcapng nor pcap")]
)
def test_a_file_that_is_not_a_capture_is_named(tmp_path: Path, data: bytes, text: str) -> None:
    with pytest.raises(RecordingError, match=text):
        read(tmp_path / "a", data)


@pytest.mark.parametrize("seed", range(40))
def test_damaged_files_give_datagrams_or_one_error(tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)
    form = chance.choice([pcap, pcapng])
    data = bytearray(form(PACKETS[:20], link=chance.choice(list(LINKS))))
    for _ in range(chance.randint(1, 20)):
        data[chance.randrange(len(data))] = chance.randrange(256)
    path = tmp_path / "a"
    path.write_bytes(data)
    with suppress(RecordingError):
        for datagram in Capture(path):
            assert isinstance(datagram, Datagram)
            assert 0 <= datagram.time_us < 1 << 63
