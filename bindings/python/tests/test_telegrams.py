# SPDX-License-Identifier: MIT
"""decode() and decode_batch(): bytes of the manual's layouts, and any bytes at all."""

import struct
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import roburoc4
from roburoc4 import RobotError, protocol
from roburoc4.protocol import Layout, decode, decode_batch

LOCALIZATION = struct.pack("<BHQdddI", 0xFF, 5, 1234, 1.5, -2.5, 0.25, 0x12)
BATTERY = struct.pack("<BHQBB", 0xFF, 4, 77, 3, 19)
DIFFERENTIAL = struct.pack("<BHQffff", 0xFF, 6, 9, 0.5, 0.25, -1.0, -0.5)
TELEMETER = struct.pack("<BHQff", 0xFF, 3, 8, 1.25, 6.0)
IOCARD = struct.pack("<BHQ9f3B", 0xFF, 2, 7, *range(9), 0x01, 0x01, 0x20)


def test_statuses() -> None:
    assert decode(LOCALIZATION) == roburoc4.LocalizationStatus(1234, 1.5, -2.5, 0.25, 0x12)
    assert decode(BATTERY) == roburoc4.BatteryStatus(77, roburoc4.BatteryState.CRITICAL, 19)
    assert decode(DIFFERENTIAL) == roburoc4.DifferentialStatus(9, 0.5, 0.25, -1.0, -0.5)
    assert decode(TELEMETER) == roburoc4.TelemeterStatus(8, (1.25, 6.0))
    iocard = decode(IOCARD)
    assert isinstance(iocard, roburoc4.IoCardStatus)
    assert iocard.analog_inputs == tuple(map(float, range(9)))
    assert [i for i, on in enumerate(iocard.digital_inputs) if on] == [0, 8, 21]


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_any_bytes_like_object_will_do(kind: type[bytes]) -> None:
    assert decode(kind(BATTERY)) == decode(BATTERY)


def test_other_ids_and_counts_are_given_by_a_layout() -> None:
    layout = Layout(battery=5, localization=4, analog_inputs=1, digital_inputs=8)
    assert isinstance(decode(LOCALIZATION, layout), roburoc4.BatteryStatus)
    small = struct.pack("<BHQfB", 0xFF, 2, 7, 12.5, 0x81)
    assert decode(small, layout) == roburoc4.IoCardStatus(
        7, (12.5,), (True, False, False, False, False, False, False, True)
    )
    unknown = decode(BATTERY, layout._replace(localization=9))
    assert unknown == protocol.UnknownStatus(77, 4, bytes((3, 19)))


def test_answers() -> None:
    directory = bytes((7, 0, 0, 0, 0)) + struct.pack("<4H", 0, 0, 0x4005, 6)
    answer = decode(directory)
    assert isinstance(answer, protocol.Answer)
    assert (answer.id, answer.action, answer.service, answer.error) == (7, 0, 0, 0)
    assert answer.body == (
        protocol.DirectoryEntry(0, 0),
        protocol.DirectoryEntry(0x4005, 6),
    )
    battery = bytes((1, 0, 4, 0, 0)) + struct.pack("<ffB", 24.0, 60.0, 20)
    assert decode(battery).body == protocol.BatteryProperties(24.0, 60.0, 20)  # type: ignore[union-attr]
    iocard = bytes((1, 0, 2, 0, 0)) + struct.pack("<4i", 9, 0, 22, 8)
    assert decode(iocard).body == protocol.IoCardProperties(9, 0, 22, 8)  # type: ignore[union-attr]
    subscribed = bytes((1, 0, 1, 0, 0)) + struct.pack("<HB", 5, 10)
    assert decode(subscribed).body == (protocol.Subscription(5, 10),)  # type: ignore[union-attr]
    telemeters = bytes((1, 0, 3, 0, 0)) + struct.pack("<i7f", 1, 0.5, 0, 0, 1, 0.25, 6, 3)
    assert decode(telemeters).body == (protocol.TelemeterProperties(0.5, 0, 0, 1, 0.25, 6, 3),)  # type: ignore[union-attr]
    refused = decode(bytes((9, 4, 1, 0, 2)))
    assert isinstance(refused, protocol.Answer)
    assert refused.error == protocol.WireError.UNSUPPORTED


@pytest.mark.parametrize("text", ["IOCard", "Éclairage", ""])
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_texts_are_utf8_or_latin1(text: str, encoding: str) -> None:
    answer = decode(bytes((1, 1, 0, 0, 0)) + text.encode(encoding))
    assert isinstance(answer, protocol.Answer)
    assert answer.body == text


def test_what_clients_send() -> None:
    drive = struct.pack("<BHff", 0xFF, 6, 0.5, -0.25)
    assert decode(drive, sender="client") == protocol.DifferentialCommand(0.5, -0.25)
    outputs = struct.pack("<BHB", 0xFF, 2, 0x08)
    command = decode(outputs, sender="client")
    assert isinstance(command, protocol.IoCardCommand)
    assert command.digital_outputs[3]
    insert = decode(bytes((1, 4, 1, 0, 5, 0, 10)), sender="client")
    assert isinstance(insert, protocol.Request)
    assert (insert.action, insert.subject, insert.period_cycles) == (4, 5, 10)
    query = decode(bytes((1, 1, 0, 0, 6, 1)), sender="client")
    assert isinstance(query, protocol.Request)
    assert (query.action, query.index) == (1, 0x106)


def test_unknown_values_stay_plain_numbers() -> None:
    odd = decode(BATTERY[:-2] + bytes((200, 50)))
    assert isinstance(odd, roburoc4.BatteryStatus)
    assert odd.state == 200
    assert odd.state_name == "200"
    flags = decode(LOCALIZATION[:-4] + bytes((0, 0, 0, 0x80)))
    assert isinstance(flags, roburoc4.LocalizationStatus)
    assert flags.flags == 0x80000000


def test_values_that_are_not_bytes_are_named() -> None:
    with pytest.raises(roburoc4.ArgumentError, match=r"data: 'text' .* bytes"):
        decode("text")  # type: ignore[arg-type]
    with pytest.raises(roburoc4.ArgumentError, match=r"data: 5 .* bytes"):
        decode(5, sender="client")  # type: ignore[arg-type]
    with pytest.raises(roburoc4.ArgumentError, match=r"layout: .* a Layout"):
        decode(BATTERY, (1, 2))  # type: ignore[arg-type]
    with pytest.raises(roburoc4.ArgumentError, match="battery=70000"):
        decode(BATTERY, Layout(battery=70000))


@settings(max_examples=300)
@given(
    st.builds(
        lambda head, service, rest: bytes((*head, service, 0)) + rest,
        st.sampled_from(((), (0x00,), (0xFF,), (1, 0), (1, 1), (1, 4))),
        st.integers(0, 8),
        st.binary(max_size=80),
    ),
    st.sampled_from(("robot", "client")),
    st.sampled_from((None, Layout(analog_inputs=2**31 - 1), Layout(digital_outputs=2**31 - 1))),
)
def test_any_bytes_are_a_telegram_or_a_robot_error(
    data: bytes, sender: str, layout: Layout | None
) -> None:
    try:
        telegram = decode(data, layout, sender)  # type: ignore[arg-type]
    except RobotError:
        return
    assert isinstance(telegram, tuple)
    assert type(telegram).__module__ == "roburoc4.records"
    hash(telegram)


@pytest.mark.parametrize(
    ("service", "status"),
    [
        ("iocard", IOCARD),
        ("telemeter", TELEMETER),
        ("battery", BATTERY),
        ("localization", LOCALIZATION),
        ("differential", DIFFERENTIAL),
    ],
)
def test_a_batch_has_the_values_of_decode(service: str, status: bytes) -> None:
    record = decode(status)
    for batch in (
        decode_batch(service, [status] * 1000),
        decode_batch(service, status * 1000),
        decode_batch(service, memoryview(status * 1000)),
    ):
        assert len(batch.values) == 1000
        assert len(batch.bad) == 0
        assert batch.values.dtype.names == record._fields[:-2]
        for name in batch.values.dtype.names or ():
            assert np.array_equal(batch.values[name][999], getattr(record, name))


def test_a_batch_reports_the_bad_and_keeps_the_good() -> None:
    data = [BATTERY, b"", LOCALIZATION, BATTERY, BATTERY[:-1]]
    batch = decode_batch("battery", data)
    assert batch.bad.tolist() == [1, 2, 4]
    assert batch.values["remaining_percent"].tolist() == [19, 19]
    buffer = bytearray(BATTERY * 3)
    buffer[len(BATTERY)] = 0x01
    assert decode_batch("battery", buffer).bad.tolist() == [1]


def test_a_batch_without_numpy_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numpy", None)
    with pytest.raises(ImportError, match="pip install numpy"):
        decode_batch("battery", [])


def test_a_batch_follows_a_layout_and_the_number_of_telemeters() -> None:
    layout = Layout(battery=9)
    status = BATTERY[:1] + b"\x09\x00" + BATTERY[3:]
    assert len(decode_batch("battery", [status, BATTERY], layout).values) == 1
    assert decode_batch("telemeter", [TELEMETER], telemeters=3).bad.tolist() == [0]


def test_invalid_buffers_and_services_are_refused() -> None:
    with pytest.raises(protocol.DecodeError, match="13 bytes"):
        decode_batch("battery", BATTERY + b"\x00")
    with pytest.raises(roburoc4.ArgumentError, match="localization"):
        decode_batch("directory", [])
    with pytest.raises(roburoc4.ArgumentError, match="data: "):
        decode_batch("battery", [1, 2])  # type: ignore[list-item]
