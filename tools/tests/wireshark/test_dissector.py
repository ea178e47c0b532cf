# SPDX-License-Identifier: MIT
"""The dissector in tshark: the values of telegrams that were worked out by hand from the manual.

Run by ctest; by hand: python3 -m unittest discover tools/tests/wireshark
"""

import json
import math
import random
import re
import struct
import unittest
from typing import ClassVar

from captures import (
    ETHERNET,
    RAW_IP,
    ROOT,
    UPPER_PDU,
    Packet,
    Talk,
    ethernet,
    experts,
    ip,
    pcapng,
    read,
    run,
    show,
    udp,
    upper_pdu,
)

HEADER = (ROOT / "include" / "roburoc4_codec.h").read_text(encoding="utf-8")


TELEGRAMS = json.loads(
    (ROOT / "tests" / "conformance" / "telegrams.json").read_text(encoding="utf-8")
)["telegrams"]
VECTORS = {entry["name"]: bytes.fromhex(entry["bytes"]) for entry in TELEGRAMS}
SENT = {entry["name"] for entry in TELEGRAMS if entry["direction"] == "to robot"}

# The values of each vector by the dissector's names, in the manual's order.
VALUES: dict[str, dict[str, list[float | str]]] = {
    "get": {"id": [1], "action": [0], "service": [6]},
    "query-directory": {"id": [42], "action": [1], "service": [0], "request.index": [3]},
    "query-analog-input": {
        "id": [43],
        "service": [2],
        "request.io_type": [0],
        "request.index": [8],
    },
    "query-analog-output": {"id": [44], "request.io_type": [1], "request.index": [1]},
    "query-digital-input": {"id": [45], "request.io_type": [2], "request.index": [8]},
    "query-digital-output": {"id": [46], "request.io_type": [3], "request.index": [7]},
    "insert": {
        "id": [47],
        "action": [4],
        "service": [1],
        "request.subject": [6],
        "request.period_cycles": [5],
    },
    "delete": {"id": [48], "action": [5], "service": [1], "request.subject": [6]},
    "replace-localization": {
        "id": [49],
        "action": [2],
        "service": [5],
        "request.timestamp": [12345],
        "request.x_m": [10],
        "request.y_m": [-4.5],
        "request.theta_rad": [1.5],
    },
    "directory": {
        "error": [0],
        "directory.type": [0, 0, 0x4001, 0x4008, 0, 0x8002, 0x4005],
        "directory.id": [0, 1, 2, 3, 4, 5, 6],
    },
    "notification": {"subscription.service": [6, 2, 4], "subscription.period_cycles": [5, 10, 100]},
    "iocard-properties": {
        "iocard.analog_inputs": [9],
        "iocard.analog_outputs": [0],
        "iocard.digital_inputs": [22],
        "iocard.digital_outputs": [8],
    },
    "telemeter-properties": {
        "telemeter.x_m": [0.625, -0.625],
        "telemeter.y_m": [0, 0.125],
        "telemeter.theta_rad": [0, math.pi],
        "telemeter.field_of_view_rad": [0.5, 0.75],
        "telemeter.min_distance_m": [0.25, 0.1875],
        "telemeter.max_distance_m": [4, 3.5],
        "telemeter.distance_m": [1.5, 2.25],
    },
    "battery-properties": {
        "battery.nominal_voltage_v": [24],
        "battery.capacity_ah": [40],
        "battery.minimum_percent": [20],
    },
    "localization-properties": {
        "localization.x_m": [1.5],
        "localization.y_m": [-2.25],
        "localization.theta_rad": [0.5],
        "localization.flags": [0x12],
        "localization.flags.metric": [1],
        "localization.flags.proprioceptive": [1],
        "localization.flags.invalid": [0],
    },
    "differential-properties": {
        "differential.target_linear_m_s": [0.5],
        "differential.target_angular_rad_s": [-0.25],
        "differential.current_linear_m_s": [0.4375],
        "differential.current_angular_rad_s": [-0.125],
        "differential.min_linear_m_s": [-1.3],
        "differential.max_linear_m_s": [2.6],
        "differential.min_angular_rad_s": [-3.25],
        "differential.max_angular_rad_s": [6.5],
        "differential.min_linear_m_s2": [-3],
        "differential.max_linear_m_s2": [2],
        "differential.min_angular_rad_s2": [-10],
        "differential.max_angular_rad_s2": [8],
        "differential.width_m": [0.68],
    },
    "text-directory": {"id": [42], "text": ["Differential"]},
    "text-iocard": {"id": [45], "text": ['Game pad "A" button']},
    "insert-answer": {"id": [47], "action": [4], "service": [1], "error": [0]},
    "delete-answer": {"id": [48], "action": [5], "error": [0]},
    "replace-answer": {"id": [49], "action": [2], "service": [5], "error": [0]},
    "error-answer": {"id": [50], "action": [4], "error": [5]},
    "error-telegram": {"id": [0], "action": [0], "service": [9], "error": [1]},
    "iocard-status": {
        "service": [2],
        "robot_cycles": [360000],
        "iocard.analog": [0.75, 1.25, 25.5, -1, -0.5, 0, 0.5, 1, -0.25],
        "iocard.ai.battery_v": [25.5],
        "iocard.ai.pad_rt": [-0.25],
        "iocard.digital": ["01:01:20"],
        "iocard.di.front_bumper": [1],
        "iocard.di.rear_bumper": [0],
        "iocard.di.pad_a": [1],
        "iocard.di.pad_b": [0],
        "iocard.di.pad_rb": [1],
        "iocard.di.pad_lb": [0],
    },
    "telemeter-status": {"robot_cycles": [360000], "telemeter.distances": [1.5, 2.25]},
    "battery-status": {
        "robot_cycles": [360000],
        "battery.state": [2],
        "battery.remaining_percent": [87],
    },
    "localization-status": {
        "robot_cycles": [360000],
        "localization.x_m": [-3.5],
        "localization.y_m": [0.125],
        "localization.theta_rad": [-1.75],
        "localization.flags": [0x14],
    },
    "differential-status": {
        "robot_cycles": [360000],
        "differential.target_linear_m_s": [0.5],
        "differential.current_linear_m_s": [0.4375],
        "differential.target_angular_rad_s": [-0.25],
        "differential.current_angular_rad_s": [-0.125],
    },
    "differential-command": {
        "differential.linear_m_s": [0.5],
        "differential.angular_rad_s": [-0.25],
    },
    "iocard-command": {"service": [2], "iocard.digital": ["82"]},
}


def status(cycles: int, linear: float = 0.0, service: int = 6) -> bytes:
    return struct.pack("<BHQffff", 0xFF, service, cycles, linear, linear, 0, 0)


def command(linear: float, angular: float = 0.0) -> bytes:
    return struct.pack("<BHff", 0xFF, 6, linear, angular)


class Values(unittest.TestCase):
    """The same values, whatever carries the bytes."""

    def check_packet(self, packet: Packet, name: str) -> None:
        for field, wanted in VALUES[name].items():
            got = packet.get(f"roburoc4.{field}", [])
            assert len(got) == len(wanted), f"{name}: {field} {got}"
            for one, other in zip(got, wanted, strict=True):
                if isinstance(other, str):
                    assert one == other, f"{name}: {field}"
                else:
                    number = {"True": 1, "False": 0}.get(one)
                    number = float(int(one, 0) if "x" in one else one) if number is None else number
                    assert math.isclose(number, other, rel_tol=1e-06), f"{name}: {field} {one}"

    def check_all(self, link_type: int, wrap, *options: str) -> None:
        frames = [(float(i), wrap(VECTORS[name], name in SENT)) for i, name in enumerate(VALUES)]
        packets = show(pcapng(link_type, frames), *options)
        assert len(packets) == len(VALUES)
        for name, packet in zip(VALUES, packets, strict=True):
            self.check_packet(packet, name)
            assert "malformed" not in experts(packet), name
            assert "surplus" not in experts(packet), name

    def test_every_vector_has_values(self) -> None:
        assert set(VECTORS) == set(VALUES)

    def test_of_raw_ip(self) -> None:
        self.check_all(RAW_IP, lambda data, sent: ip(udp(data, sent), sent))

    def test_of_another_port_by_decode_as(self) -> None:
        self.check_all(
            RAW_IP,
            lambda data, sent: ip(udp(data, sent, 61020), sent),
            *("-d", "udp.port==61020,roburoc4"),
        )

    def test_of_our_recordings_of_any_port(self) -> None:
        for name in ("192.168.0.2:61020", "roburoc4-lcm"):
            frames = [
                (float(i), ip(udp(VECTORS[name], name in SENT, 61020), name in SENT))
                for i, name in enumerate(VALUES)
            ]
            packets = show(pcapng(RAW_IP, frames, name=name))
            for vector, packet in zip(VALUES, packets, strict=True):
                self.check_packet(packet, vector)

    def test_of_upper_pdus(self) -> None:
        """Without addresses, a telegram's direction is guessed from its contents."""
        alike = {"differential-properties", "iocard-command"}
        names = [name for name in VALUES if name not in alike]
        packets = show(pcapng(UPPER_PDU, [(0.0, upper_pdu(VECTORS[name])) for name in names]))
        for name, packet in zip(names, packets, strict=True):
            self.check_packet(packet, name)

    def test_of_fragments(self) -> None:
        data = udp(VECTORS["telemeter-properties"], False)
        frames = [
            (0.0, ethernet(ip(data[:40], False, more=True), 5)),
            (0.1, ethernet(ip(data[40:], False, fragment=40), 5)),
        ]
        self.check_packet(show(pcapng(ETHERNET, frames))[1], "telemeter-properties")


class RealTools(unittest.TestCase):
    """Captures that tcpdump and dumpcap made of a simulated robot, some datagrams in fragments."""

    def test_their_captures_are_read(self) -> None:
        data = ROOT / "tools" / "tests" / "data"
        for name in ("tcpdump-fragments.pcap", "dumpcap-fragments.pcapng"):
            packets = show((data / name).read_bytes())
            assert sum(bool(p["roburoc4.iocard.analog"]) for p in packets) == 20, name
            assert not any(experts(p) for p in packets), name


class Exchange(unittest.TestCase):
    """What one datagram says about another."""

    def test_requests_are_matched_to_answers(self) -> None:
        talk = Talk()
        talk.ask(0.0, bytes.fromhex("05 00 06 00"))
        talk.ask(0.1, bytes.fromhex("06 00 04 00"))
        talk.say(0.125, b"\x06" + VECTORS["battery-properties"][1:])
        talk.say(0.25, b"\x05" + VECTORS["differential-properties"][1:])
        packets = talk.show("-2")
        assert [p["roburoc4.answer_in"] for p in packets[:2]] == [["4"], ["3"]]
        assert [p["roburoc4.request_in"] for p in packets[2:]] == [["2"], ["1"]]
        assert packets[2]["roburoc4.answer_time"] == ["0.025000000"]
        assert packets[3]["roburoc4.answer_time"] == ["0.250000000"]

    def test_answers_and_requests_without_the_other_are_reported(self) -> None:
        talk = Talk()
        talk.ask(0.0, bytes.fromhex("05 00 06 00"))
        talk.say(0.1, b"\x06" + VECTORS["battery-properties"][1:])
        assert [experts(p) for p in talk.show("-2")] == [["unanswered"], ["unmatched"]]

    def test_an_error_telegram_answers_the_oldest_request(self) -> None:
        for data in (b"\0", bytes.fromhex("00 00 06 00 01")):
            talk = Talk()
            talk.ask(0.0, bytes.fromhex("05 00 06 00"))
            talk.ask(0.1, bytes.fromhex("06 00 06 00"))
            talk.say(0.2, data)
            packet = talk.show()[2]
            assert packet["roburoc4.request_in"] == ["1"]
            assert "refused" in experts(packet)

    def test_lost_statuses_are_counted_by_the_subscription(self) -> None:
        talk = Talk()
        talk.ask(0.0, VECTORS["insert"])  # every 5 cycles
        talk.say(0.01, VECTORS["insert-answer"])
        for i, cycles in enumerate((100, 105, 120, 125)):
            talk.say(0.1 + i / 100, status(cycles))
        packets = talk.show()
        assert [p["roburoc4.lost"] for p in packets[2:]] == [[], [], ["2"], []]
        assert "lost" in experts(packets[4])
        assert packets[3]["roburoc4.period_cycles"] == ["5"]

    def test_late_old_and_new_statuses_are_told_apart(self) -> None:
        talk = Talk()
        for seconds, cycles in ((0.0, 1000), (0.05, 1005), (0.35, 1010), (0.36, 1005), (0.4, 3)):
            talk.say(seconds, status(cycles))
        packets = talk.show()
        assert [experts(p) for p in packets] == [[], [], ["late"], ["late", "old"], ["restart"]]
        assert math.isclose(float(packets[2]["roburoc4.late_ms"][0]), 250, abs_tol=0.01)

    def test_a_watchdog_that_is_due_is_reported(self) -> None:
        talk = Talk()
        talk.ask(0.0, command(0.5))
        talk.ask(0.3, command(0.5))
        talk.ask(0.95, command(0.5))
        talk.say(1.5, status(150, 0.5))
        talk.say(2.0, status(200, 0.5))
        talk.say(2.1, status(210))
        talk.ask(2.2, command(0.5))
        talk.ask(2.3, command(0.0))
        talk.say(5.0, status(500))
        found = [experts(p) for p in talk.show("-o", "roburoc4.late_ms:100000")]
        assert [[e for e in one if e.startswith("watchdog")] for one in found] == [
            [],
            [],
            ["watchdog_due"],
            [],
            ["watchdog_tripped"],
            [],
            [],
            [],
            [],
        ]

    def test_speeds_outside_the_limits_are_reported(self) -> None:
        talk = Talk()
        talk.ask(0.0, command(9.0))  # limits are not known yet
        talk.ask(0.1, VECTORS["get"])
        talk.say(0.2, VECTORS["differential-properties"])  # -1.3 to 2.6, -3.25 to 6.5
        talk.ask(0.3, command(2.6, -3.25))
        talk.ask(0.4, command(-1.4))
        talk.ask(0.5, command(0.0, 7.0))
        talk.ask(0.6, command(float("nan"), float("inf")))
        talk.say(0.7, status(70, 3.0))
        found = [experts(p) for p in talk.show()]
        assert found == [[], [], [], [], ["limits"], ["limits"], ["not_finite"] * 2, ["limits"] * 2]

    def test_services_are_what_the_directory_says(self) -> None:
        talk = Talk()
        talk.ask(0.0, bytes.fromhex("01 00 00 00"))
        talk.say(
            0.1, bytes.fromhex("01 00 00 00 00  00 00 00 00  00 00 01 00  05 40 0C 00  00 00 0D 00")
        )
        talk.ask(0.2, bytes.fromhex("02 01 00 00 03 00"))
        talk.say(0.3, bytes.fromhex("02 01 00 00 00") + b"My battery")
        talk.say(0.4, b"\xff\x0c\x00" + VECTORS["differential-status"][3:])
        talk.say(0.5, b"\xff\x0d\x00" + VECTORS["battery-status"][3:])
        talk.say(0.6, VECTORS["differential-status"])
        packets = talk.show()
        assert packets[4]["roburoc4.differential.current_linear_m_s"] == ["0.4375"]
        assert packets[5]["roburoc4.battery.remaining_percent"] == ["87"]
        assert "unknown" in experts(packets[6])

    def test_counts_of_channels_are_those_of_the_properties(self) -> None:
        talk = Talk()
        talk.ask(0.0, bytes.fromhex("01 00 02 00"))
        talk.say(0.1, struct.pack("<BBHBiiii", 1, 0, 2, 0, 1, 2, 9, 1))
        talk.say(0.2, struct.pack("<BHQfBB", 0xFF, 2, 7, 1.5, 0x81, 0x01))
        talk.ask(0.3, struct.pack("<BHffB", 0xFF, 2, 2.5, 3.5, 1))
        packets = talk.show()
        assert packets[2]["roburoc4.iocard.analog"] == ["1.5"]
        assert packets[2]["roburoc4.iocard.digital"] == ["81:01"]
        assert packets[2]["roburoc4.iocard.di.front_bumper"] == []
        assert packets[3]["roburoc4.iocard.analog"] == ["2.5", "3.5"]
        assert experts(packets[2]) + experts(packets[3]) == []


class Malformed(unittest.TestCase):
    """A datagram that is no telegram gives an expert info, never an error of the script."""

    def test_every_shortened_telegram_is_reported(self) -> None:
        lists = {"directory", "notification", "text-directory", "text-iocard", "telemeter-status"}
        cases = [
            (name, size)
            for name in sorted(set(VECTORS) - lists)
            for size in range(1, len(VECTORS[name]))
        ]
        frames = [
            (0.0, ip(udp(VECTORS[name][:size], name in SENT), name in SENT)) for name, size in cases
        ]
        for (name, size), packet in zip(cases, show(pcapng(RAW_IP, frames)), strict=True):
            short = size < 5 and name == "error-telegram"
            assert ("refused" if short else "malformed") in experts(packet), (name, size)

    def test_longer_telegrams_are_read_and_reported(self) -> None:
        names = sorted(
            set(VECTORS) - {"directory", "notification", "text-directory", "text-iocard"}
        )
        talk = Talk()
        for name in names:
            (talk.ask if name in SENT else talk.say)(0.0, VECTORS[name] + b"\x01")
        for name, packet in zip(names, talk.show(), strict=True):
            assert "surplus" in experts(packet), name
            assert packet["roburoc4.surplus"] == ["01"]

    def test_impossible_counts_are_reported(self) -> None:
        talk = Talk()
        talk.say(0.0, struct.pack("<BBHBiiii", 1, 0, 2, 0, 0x7FFFFFFF, 0, 0, 0))
        talk.say(0.0, struct.pack("<BBHBiiii", 1, 0, 2, 0, -1, 0, 0, 0))
        talk.say(0.0, struct.pack("<BBHBi", 1, 0, 3, 0, 0x7FFFFFFF))
        talk.say(0.0, struct.pack("<BBHBi", 1, 0, 3, 0, -1))
        for packet in talk.show():
            assert "malformed" in experts(packet)

    def test_a_cut_capture_is_not_the_robots_fault(self) -> None:
        frames = [(0.0, ip(udp(VECTORS["differential-status"], False), False))]
        assert experts(show(pcapng(RAW_IP, frames, snap=40))[0]) == ["cut"]

    def test_fuzzed_captures_never_stop_the_script(self) -> None:
        dice = random.Random(20)
        names = sorted(VECTORS)
        frames = []
        for i in range(1000):
            data = bytearray(VECTORS[dice.choice(names)])
            for _ in range(dice.choice((0, 0, 1, 1, 2, 8))):
                data[dice.randrange(len(data))] = dice.choice((0, 1, 2, 6, 0x7F, 0x80, 0xFF))
            data = data[: dice.randrange(len(data) + 1)] if dice.random() < 0.2 else data
            data += dice.randbytes(dice.choice((0, 0, 0, 1, 5, 1200)))
            data = data or b"\0"  # nothing dissects an empty datagram
            sent = dice.random() < 0.5
            frames.append(
                (i * dice.choice((0.001, -0.001, 0.01)), ip(udp(bytes(data), sent), sent))
            )
        text = read(pcapng(RAW_IP, frames), "-2", "-V", "-O", "roburoc4")
        assert len(re.findall(r"^RobuROC4, ", text, re.MULTILINE)) == len(frames)


class Table(unittest.TestCase):
    """The fields are those of roburoc4_codec.h."""

    TYPES: ClassVar = {
        "uint8_t": "FT_UINT8",
        "uint16_t": "FT_UINT16",
        "uint32_t": "FT_UINT32",
        "uint64_t": "FT_UINT64",
        "int32_t": "FT_INT32",
        "float": "FT_FLOAT",
        "double": "FT_DOUBLE",
    }
    # The first fields have the same names in all telegrams.
    HEAD = ("id", "action", "service", "error", "robot_cycles")
    # Views: their elements.
    VIEWS: ClassVar = {
        "iocard.analog": "FT_FLOAT",
        "iocard.digital": "FT_BYTES",
        "telemeter.distances": "FT_FLOAT",
        "text": "FT_STRING",
    }
    CONCLUSIONS: ClassVar = {
        "answer_in",
        "request_in",
        "answer_time",
        "lost",
        "late_ms",
        "period_cycles",
        "surplus",
        "data",
    }
    PREFIXES: ClassVar = {"directory_entry": "directory", "answer": "", "status_header": ""}

    def members(self) -> dict[str, str]:
        """The type of each field on the wire, by filter name."""
        found = dict(self.VIEWS)
        plain = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.DOTALL)
        for name, body in re.findall(r"typedef struct roburoc4_(\w+) \{(.*?)\}", plain, re.DOTALL):
            is_view = "*" in body
            prefix = self.PREFIXES.get(name, re.sub(r"_(properties|status|command)$", "", name))
            for kind, names in re.findall(r"(\w+) ([\w, ]+)(?:\[\d\])?;", body):
                for member in names.split(", "):
                    if member in self.HEAD and name not in ("directory_entry", "subscription"):
                        found[member] = self.TYPES[kind]
                    elif not is_view and not member.startswith("reserved"):
                        found[f"{prefix}.{member}"] = self.TYPES[kind]
        return found

    def fields(self) -> dict[str, str]:
        rows = [line.split("\t") for line in run("-G", "fields").splitlines()]
        return {
            row[2].removeprefix("roburoc4."): row[3]
            for row in rows
            if row[0] == "F" and row[2].startswith("roburoc4.") and "expert" not in row[2]
        }

    def test_every_member_is_a_field_and_every_field_a_member(self) -> None:
        names = {
            f"iocard.{k}.{n.lower()}" for k, n in re.findall(r"ROBUROC4_(?:(AI|DI))_(\w+) ", HEADER)
        }
        fields = {
            name: kind
            for name, kind in self.fields().items()
            if not re.match(r"iocard\.(ai|di)\.|localization\.flags\.", name)
        }
        concluded = {name: fields.pop(name) for name in self.CONCLUSIONS}
        assert len(concluded) == len(self.CONCLUSIONS)
        assert fields == self.members()
        assert names

    def test_channels_and_flags_are_those_of_the_header(self) -> None:
        text = (ROOT / "tools" / "wireshark" / "roburoc4.lua").read_text(encoding="utf-8")
        for kind, table in (("AI", "ANALOG_INPUTS"), ("DI", "DIGITAL_INPUTS")):
            body = re.search(rf"local {table} = \{{(.*?)\}}", text, re.DOTALL)
            assert body
            index, found = -1, {}
            for at, name in re.findall(r'(?:\[(\d+)\] = )?"(\w+)"', body[1]):
                index = int(at) if at else index + 1
                found[name] = index
            wanted = {
                name.lower(): int(value)
                for name, value in re.findall(rf"#define ROBUROC4_{kind}_(\w+) (\d+)", HEADER)
                if name != "COUNT"
            }
            assert found == wanted
        flags = re.findall(r"#define ROBUROC4_LOCALIZATION_(\w+) 0x(\d+)", HEADER)
        body = re.search(r"local FLAGS = \{(.*?)\}", text, re.DOTALL)
        assert body
        found = {name: 1 << i for i, name in enumerate(re.findall(r'"(\w+)"', body[1]))}
        assert found == {name.lower(): int(bit, 16) for name, bit in flags}

    def test_names_of_values_are_those_of_the_header(self) -> None:
        rows = [line.split("\t") for line in run("-G", "values").splitlines()]
        named: dict[str, dict[int, str]] = {}
        for row in rows:
            if row[0] == "V" and row[1].startswith("roburoc4."):
                named.setdefault(row[1].removeprefix("roburoc4."), {})[int(row[2], 0)] = row[3]
        actions = dict(re.findall(r"#define ROBUROC4_ACTION_(\w+) (\d+)", HEADER))
        assert named["action"] == {int(value): name for name, value in actions.items()}
        for field, constants in (
            ("directory.type", "TYPE"),
            ("battery.state", "BATTERY"),
            ("request.io_type", "IO"),
        ):
            numbers = re.findall(rf"#define ROBUROC4_{constants}_\w+ (\w+)", HEADER)
            assert set(named[field]) == {int(number, 0) for number in numbers}, field
        errors = re.findall(r"#define ROBUROC4_ERROR_\w+ (\w+)", HEADER)
        assert set(named["error"]) == {int(number, 0) for number in errors} - {16}


class Size(unittest.TestCase):
    """A recording of a day can be opened."""

    @staticmethod
    def talk(seconds: int) -> Talk:
        """What a client that drives exchanges with a robot, 20 times a second."""
        talk = Talk()
        for cycle in range(0, 100 * seconds, 5):
            at = cycle / 100
            wave = math.sin(at)
            talk.say(at, struct.pack("<BHQdddI", 0xFF, 5, cycle, at, wave, 0.1, 4))
            talk.say(at, struct.pack("<BHQffff", 0xFF, 6, cycle, wave, wave, 0, 0))
            talk.say(at, struct.pack("<BHQ9f", 0xFF, 2, cycle, *(0.0,) * 9) + bytes(3))
            talk.ask(at + 0.001, struct.pack("<BHff", 0xFF, 6, wave, 0))
            if cycle % 100 == 0:
                talk.say(at, struct.pack("<BHQBB", 0xFF, 4, cycle, 2, 90))
                talk.say(at, struct.pack("<BHQff", 0xFF, 3, cycle, 1.0, 2.0))
        return talk

    def test_the_list_of_packets_is_the_same_whether_fields_are_read_or_not(self) -> None:
        talk = self.talk(3)
        talk.say(3.5, struct.pack("<BHQffff", 0xFF, 6, 320, math.nan, 0.5, 0, 0))  # lost, late
        talk.say(3.6, struct.pack("<BHQffff", 0xFF, 6, 100, 0.5, 0.5, 0, 0))  # restarted
        talk.say(3.7, struct.pack("<BHQfff", 0xFF, 6, 105, 0.5, 0.5, 0))  # too short
        capture = pcapng(RAW_IP, talk.frames)
        columns = ["-T", "fields", "-e", "_ws.col.Info"]
        alone = read(capture, *columns).splitlines()
        beside = [
            line.split("\t")[0]
            for line in read(capture, *columns, "-e", "roburoc4.service").splitlines()
        ]
        assert alone == beside
        assert "Differential status: 0.500 m/s, 0.000 rad/s" in alone
        shown = ["-q", "-z", "expert"]
        found = read(capture, *shown)
        assert found == read(capture, *shown, "-2", "-R", "roburoc4.service")
        for words in ("not a finite number", "restarted", "Malformed", "statuses were lost"):
            assert words in found


if __name__ == "__main__":
    unittest.main()
