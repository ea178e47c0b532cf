# SPDX-License-Identifier: MIT
"""`roburoc4 replay`: a robot that answers as the recorded one did, and that nothing moves."""

import json
import re
import signal
import struct
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from capture_support import (
    BEGIN_US,
    ROBOT,
    command,
    discovery,
    drive,
    requests,
    statuses,
    write,
)
from cli_support import doctor, start
from robot_support import until

import roburoc4
from roburoc4_tools import recordings
from roburoc4_tools.recordings.replay import ReplayedRobot

PEER = ("127.0.0.1", 5000)
OTHER = ("127.0.0.1", 5001)


class Stage:
    """A replayed robot in virtual time, and what it sent."""

    def __init__(self, path: Path, **options: object) -> None:
        self.now_s = 100.0
        self.sent: list[tuple[float, tuple[str, int], bytes]] = []
        self.told: list[str] = []
        self.robot = ReplayedRobot(
            recordings.open_recording(path),
            lambda peer, data: self.sent.append((self.now_s, peer, data)),
            self.told.append,
            **options,  # type: ignore[arg-type]
        )

    def ask(self, data: bytes, peer: tuple[str, int] = PEER) -> list[bytes]:
        before = len(self.sent)
        self.robot.receive(peer, data, self.now_s)
        return [one for _, _, one in self.sent[before:]]

    def subscribe(self, service: int, peer: tuple[str, int] = PEER) -> None:
        assert self.ask(struct.pack("<BBHHB", 9, 4, 1, service, 5), peer) == [b"\x09\x04\x01\0\0"]
        self.sent.clear()

    def run(self, seconds: float) -> None:
        end_s = self.now_s + seconds
        while (due_s := self.robot.due_s) is not None and due_s <= end_s:
            self.now_s = max(self.now_s, due_s)
            self.robot.advance(self.now_s)
        self.now_s = end_s


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write(tmp_path / "run.pcapng", drive(5.0))


def stamps(sent: list[tuple[float, tuple[str, int], bytes]]) -> list[int]:
    return [int.from_bytes(data[3:11], "little") for _, _, data in sent]


def test_requests_get_the_recorded_answers(path: Path) -> None:
    stage = Stage(path)
    for at, packet in enumerate(discovery()):
        if packet.destination == ROBOT and packet.payload[1] != 4:
            request = bytes([100 + at % 50]) + packet.payload[1:]
            recorded = discovery()[at + 1].payload
            marked = b"Differential" in recorded
            given = stage.ask(request)[0]
            assert given[:1] == request[:1]
            assert given[1:].startswith(recorded[1:])
            assert (len(given) > len(recorded)) == marked


def test_recorded_statuses_reach_subscribers_in_their_time(path: Path) -> None:
    stage = Stage(path)
    stage.subscribe(6)
    begin_s = stage.now_s
    stage.subscribe(5, OTHER)
    stage.run(2.0)
    recorded = [packet for packet in drive(5.0) if packet.source == ROBOT]
    mine = [one for one in recorded if one.payload[:3] == b"\xff\x06\0"]
    got = [one for one in stage.sent if one[1] == PEER]
    assert [data for _, _, data in got] == [one.payload for one in mine[: len(got)]]
    assert len(got) == pytest.approx(38, abs=2)
    for (time_s, _, _), packet in zip(got, mine, strict=False):
        first_us = recorded[0].time_us
        assert time_s - begin_s == pytest.approx((packet.time_us - first_us) / 1e6, abs=1e-5)
    assert {data[1] for _, peer, data in stage.sent if peer == OTHER} == {5}


def test_it_waits_for_the_first_subscription(path: Path) -> None:
    stage = Stage(path)
    stage.run(100.0)
    assert stage.robot.statuses == 0
    stage.subscribe(6)
    stage.run(0.5)
    assert stamps(stage.sent)[0] == 1000


def test_commands_are_counted_rejected_and_have_no_effect(path: Path) -> None:
    stage, untouched = Stage(path), Stage(path)
    for one in (stage, untouched):
        one.subscribe(6)
    for _ in range(30):
        stage.ask(command(1.0, 1.0))
        stage.run(0.1)
        untouched.run(0.1)
    errors = [data for _, _, data in stage.sent if data[0] == 0]
    assert errors == [b"\x00\x03\x06\x00\x02"] * 3
    assert [one for one in stage.sent if one[2][0] == 0xFF] == untouched.sent
    assert stage.robot.clients[PEER].commands == 30
    assert stage.told == ["127.0.0.1:5000 sends commands: this is a recording, nothing moves"]


def test_at_the_end_it_ends_or_starts_over_with_a_steady_clock(path: Path) -> None:
    stage = Stage(path)
    stage.subscribe(6)
    stage.run(20.0)
    assert stage.robot.ended
    assert len(stage.sent) == 100
    stage = Stage(path, loop=True)
    stage.subscribe(6)
    stage.run(20.0)
    assert not stage.robot.ended
    shown = stamps(stage.sent)
    assert len(shown) > 250
    assert shown == sorted(set(shown))
    assert stage.sent[0][2][11:] == stage.sent[100][2][11:]


def test_speed_changes_times_and_the_robots_clock_alike(path: Path) -> None:
    stage = Stage(path, speed=4.0)
    stage.subscribe(6)
    stage.run(1.0)
    shown = stamps(stage.sent)
    assert len(shown) == pytest.approx(76, abs=4)
    time_s = stage.sent[-1][0] - stage.sent[0][0]
    assert (shown[-1] - shown[0]) / 100 == pytest.approx(time_s, abs=0.02)


def test_a_robot_that_was_silent_does_not_answer(tmp_path: Path) -> None:
    packets = discovery() + statuses(BEGIN_US + 100_000, 2.0)
    packets += statuses(BEGIN_US + 12_100_000, 2.0, first_cycles=2200)
    stage = Stage(write(tmp_path / "a", packets))
    stage.subscribe(6)
    stage.run(1.0)
    assert stage.ask(requests()[0])
    stage.run(6.0)
    assert not stage.ask(requests()[0])
    stage.run(5.6)
    assert stage.ask(requests()[0])


# ---- the command ----


@contextmanager
def replayed(*arguments: str) -> Iterator[tuple[str, "subprocess.Popen[str]"]]:
    process = start("replay", *arguments, "--port", "0", "--json")
    assert process.stderr is not None
    ready = process.stderr.readline()
    found = re.match(
        r"replay: ready on (127\.0\.0\.1:\d+), recorded from 192\.168\.0\.2:60000", ready
    )
    assert found, ready
    assert process.stderr.readline() == f"export ROBUROC4_ROBOT={found[1]}\n"
    try:
        yield found[1], process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def test_a_client_reads_what_was_recorded_and_moves_nothing(tmp_path: Path) -> None:
    moved = discovery() + statuses(BEGIN_US + 100_000, 4.0, speed=0.0)
    path = write(tmp_path / "run.pcapng", moved)
    with replayed(str(path)) as (address, process):
        with roburoc4.connect(address) as robot:
            marked = "Differential (recording: commands change nothing)"
            until(lambda: marked in [entry.name for entry in robot.properties.services])
            first = robot.wait_for("battery")
            assert first.remaining_percent == 90
            robot.arm()
            with pytest.raises(roburoc4.NotArmedError):
                robot.drive_for(0.5, 0.0, seconds=3.0)
            with pytest.raises(roburoc4.RefusedError):
                robot.relocalize(1.0, 2.0, 0.0)
            assert (robot.localization.x_m, robot.localization.y_m) == (0.0, 0.0)
            until(lambda: robot.state is roburoc4.State.LOST)
        stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 0
    document = json.loads(stdout)
    assert document["commands"] > 3
    assert document["statuses"] == len(statuses(BEGIN_US, 4.0))
    assert "nothing moves" in stderr


def test_the_command_line_looks_at_a_recording(tmp_path: Path) -> None:
    # Where a recording starts over, statuses are missing.
    path = write(tmp_path / "run.pcapng", drive(60.0))
    with replayed(str(path), "--loop") as (address, process):
        # Several battery statuses, one a second, also on a machine that is late with them.
        done = doctor("--seconds", "6", "--json", robot=address)
        assert json.loads(done.stdout)["verdict"]["number"] == 0, done.stdout
        process.send_signal(signal.SIGTERM)
        stdout, _ = process.communicate(timeout=120)
    assert process.returncode == 143
    assert json.loads(stdout)["clients"]
