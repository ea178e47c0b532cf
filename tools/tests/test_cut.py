# SPDX-License-Identifier: MIT
"""`roburoc4 events` and `cut`: what is between two times, of one recording or of a fleet's."""

import json
from pathlib import Path
from typing import Any

import pytest
from capture_support import (
    BEGIN_US,
    CLIENT,
    OTHER,
    Packet,
    discovery,
    drive,
    pcap,
    statuses,
    write,
)
from cli_support import document, one_line, run

from roburoc4_tools import recordings
from roburoc4_tools.recordings.capture import Capture

SECOND = (b"\xc0\xa8\x00\x03", 60000)
PAD_A = 1 << 8


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write(tmp_path / "run.pcapng", drive(10.0))


def payloads(path: Path) -> list[tuple[int, bytes]]:
    return [(datagram.time_us, datagram.payload) for datagram in Capture(path)]


def events(path: Path, *options: str) -> list[dict[str, Any]]:
    done = run("events", str(path), "--json", *options)
    assert done.returncode in {0, 1}, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def overridden(tmp_path: Path) -> Path:
    """[A] is held from second 4 to second 6."""
    packets = discovery()
    for at, digital in ((0, 0), (4, PAD_A), (6, 0)):
        seconds = 4.0 if at == 0 else 2.0
        packets += statuses(
            BEGIN_US + 100_000 + at * 1_000_000, seconds, 1000 + 100 * at, digital=digital, speed=0
        )
    return write(tmp_path / "pad.pcapng", packets)


def test_a_part_has_what_was_recorded_then_and_no_more(path: Path, tmp_path: Path) -> None:
    part = tmp_path / "part.pcapng"
    done = document(run("cut", str(path), "-o", str(part), "--from", "4", "--to", "0:06", "--json"))
    begin_us, end_us = BEGIN_US + 4_000_000, BEGIN_US + 6_000_000
    expected = [one for one in payloads(path) if begin_us <= one[0] < end_us]
    assert payloads(part)[-len(expected) :] == expected
    assert done["datagrams"] == len(expected)
    assert done["answers"] == len(payloads(part)) - len(expected)


def test_a_part_is_read_like_the_whole(path: Path, tmp_path: Path) -> None:
    part = tmp_path / "part.pcapng"
    assert run("cut", str(path), "-o", str(part), "--from", "4").returncode == 0
    whole = [s for s in recordings.open_recording(path) if s.host_us >= BEGIN_US + 4_000_000]
    kept = list(recordings.open_recording(part))
    assert [repr(status) for status in kept] == [repr(status) for status in whole]
    report = document(run("report", str(part), "--json"))
    assert not report["assumed"]
    assert report["digital_inputs"][8]["name"] == 'Game pad "A" button'


def test_times_may_be_dates(path: Path, tmp_path: Path) -> None:
    part = tmp_path / "part.pcapng"
    done = document(  # BEGIN_US is 2023-11-14T22:13:20Z
        run("cut", str(path), "-o", str(part), "--to", "2023-11-14T22:13:23", "--json")
    )
    expected = [one for one in payloads(path) if one[0] < BEGIN_US + 3_000_000]
    assert done["datagrams"] == len(expected)


def test_a_fleets_recordings_are_merged_by_time(tmp_path: Path) -> None:
    first = write(tmp_path / "red.pcapng", drive(3.0))
    other = [
        Packet(
            packet.time_us + 1_000_005,
            OTHER if packet.source == CLIENT else SECOND,
            SECOND if packet.source == CLIENT else OTHER,
            packet.payload,
        )
        for packet in drive(3.0)
    ]
    second = tmp_path / "blue.pcap"
    second.write_bytes(pcap(other))
    both = tmp_path / "both.pcapng"
    assert run("cut", str(second), str(first), "-o", str(both)).returncode == 0
    assert payloads(both) == sorted(payloads(first) + payloads(second), key=lambda one: one[0])
    for address, source in (("192.168.0.2:60000", first), ("192.168.0.3:60000", second)):
        alone = [repr(status) for status in recordings.open_recording(source)]
        assert [repr(s) for s in recordings.open_recording(both, address)] == alone


def test_events_are_found_by_kind_text_and_time(tmp_path: Path) -> None:
    path = overridden(tmp_path)
    everything = events(path)
    assert everything == document(run("report", str(path), "--json"))["events"]
    weak = {event["level"] for event in everything} - {"good"}
    assert weak
    for level in weak:
        expected = [event for event in everything if event["level"] == level]
        assert events(path, "--kind", level) == expected
    held = events(path, "--text", "GAME PAD", "--from", "3", "--to", "5")
    assert len(held) == 1
    assert held[0]["seconds"] == pytest.approx(4.1, abs=0.1)
    assert run("events", str(path), "--text", "no such words").returncode == 1


def test_nothing_is_replaced_or_written_in_vain(path: Path, tmp_path: Path) -> None:
    part = tmp_path / "part.pcapng"
    none = run("cut", str(path), "-o", str(part), "--from", "1:00:00")
    assert none.returncode == 2
    assert "nothing was recorded" in one_line(none.stderr)
    assert not part.exists()
    part.write_bytes(b"mine")
    assert "--force" in one_line(run("cut", str(path), "-o", str(part)).stderr)
    assert part.read_bytes() == b"mine"
    assert run("cut", str(path), "-o", str(path), "--force").returncode == 2
    wrong = run("events", str(path), "--from", "noon")
    assert wrong.returncode == 2
    assert "'noon' is no time" in wrong.stderr
