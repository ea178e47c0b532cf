# SPDX-License-Identifier: MIT
"""A client that is handed datagrams and the time: no socket, no clock."""

import struct

import pytest

from roburoc4 import ClosedError, Event, State
from roburoc4.offline import OfflineClient
from roburoc4.protocol import decode, encode_answer, usual_answer

BATTERY = struct.Struct("<BHQBB")


def test_a_client_finds_the_robot_that_its_user_plays() -> None:
    now_us, cycles = 1_000_000, 0
    pending: list[bytes] = []

    def advance() -> bool:
        nonlocal now_us, cycles
        now_us += 10_000
        cycles += 1
        status = BATTERY.pack(0xFF, 4, cycles, 2, 90)
        pending.extend(client.feed(status, now_us))
        while pending:
            answer = usual_answer(pending.pop())
            if answer is not None:
                pending.extend(client.feed(answer, now_us))
        return True

    client = OfflineClient(now_us, advance)
    client.robot.wait_ready(timeout=60)
    assert client.robot.state is State.READY
    assert client.robot.battery.remaining_percent == 90
    assert client.now_us == now_us
    assert client.due_us > 0
    events, statuses = client.take()
    assert Event.READY in Event(events)
    assert {status.service for status in statuses} == {"battery"}


def test_its_robot_is_closed_at_the_end() -> None:
    client = OfflineClient(0, lambda: None)
    with pytest.raises(ClosedError):
        client.robot.sleep(1.0)
    assert client.robot.closed


def test_an_answer_is_encoded_as_it_is_decoded() -> None:
    answer = decode(encode_answer(7, 1, 2, 3))
    assert answer[:4] == (7, 1, 2, 3)
    assert usual_answer(b"\xff") is None
