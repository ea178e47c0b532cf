# SPDX-License-Identifier: MIT
"""`roburoc4 convert` and `record FILE.mcap`: other people's readers get what was sent."""

import csv
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from capture_support import BEGIN_US, ROBOT, drive, pcap, statuses, write
from cli_support import document, one_line, run, start
from mcap.reader import make_reader
from robot_support import size_of, until
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

import roburoc4
from roburoc4_tools.recordings.capture import Capture

STORE = get_typestore(Stores.ROS2_JAZZY)
TOPICS = {
    "/odom": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/battery_state": "sensor_msgs/msg/BatteryState",
    "/range/front": "sensor_msgs/msg/Range",
    "/range/rear": "sensor_msgs/msg/Range",
    "/pad/joy": "sensor_msgs/msg/Joy",
    "/cmd_vel_applied": "geometry_msgs/msg/TwistStamped",
    "/cmd_vel_sent": "geometry_msgs/msg/TwistStamped",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/bumpers/front": "std_msgs/msg/Bool",
    "/bumpers/rear": "std_msgs/msg/Bool",
    "/inhibited": "std_msgs/msg/Bool",
    "/robot_description": "std_msgs/msg/String",
}
OF_A_ROBOT = {
    "/pad/joy",
    "/cmd_vel_sent",
    "/diagnostics",
    "/tf_static",
    "/bumpers/front",
    "/bumpers/rear",
    "/inhibited",
    "/robot_description",
}
"""What statuses alone do not have."""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write(tmp_path / "run.pcapng", drive(5.0))


def messages(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Read a file as rosbags does, with its own definitions of the messages."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path], default_typestore=STORE) as reader:
        kinds = {one.topic: one.msgtype for one in reader.connections}
        assert kinds.items() <= TOPICS.items()
        for connection, time_ns, raw in reader.messages():
            message = STORE.deserialize_cdr(raw, connection.msgtype)
            # byte for byte what ROS itself would have written
            assert bytes(STORE.serialize_cdr(message, connection.msgtype)) == bytes(raw)
            found.setdefault(connection.topic, []).append((time_ns, message))
    return found


def test_an_mcap_file_has_the_values_that_were_sent(path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.mcap"
    done = document(run("convert", str(path), str(out), "--json"))
    found = messages(out)
    assert set(found) == set(TOPICS)
    assert done["messages"] == sum(len(one) for one in found.values())
    sent = statuses(BEGIN_US + 100_000, 5.0)
    for at, (time_ns, odometry) in enumerate(found["/odom"]):
        angle = 0.5 * at * 0.05
        place, turned = odometry.pose.pose.position, odometry.pose.pose.orientation
        assert (place.x, place.y) == pytest.approx((math.sin(angle), 1 - math.cos(angle)))
        assert 2 * math.atan2(turned.z, turned.w) == pytest.approx(angle)
        # with the speeds of the same cycle, which arrive 10 us after the pose
        assert time_ns == sent[0].time_us * 1000 + at * 50_000_000 + 20_000
        stamp = odometry.header.stamp
        assert stamp.sec + stamp.nanosec / 1e9 == pytest.approx(time_ns / 1e9, abs=1e-3)
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    assert found["/odom"][-1][1].twist.twist.linear.x == pytest.approx(0.49)
    assert [len(one.transforms) for _, one in found["/tf_static"]] == [2]
    battery = found["/battery_state"][2][1]
    assert (battery.percentage, battery.power_supply_status) == (pytest.approx(0.88), 2)
    assert battery.voltage == pytest.approx(25.2)
    front, rear = found["/range/front"][3][1], found["/range/rear"][3][1]
    assert front.range == pytest.approx(2.03)
    assert math.isnan(rear.range)
    assert (front.min_range, front.max_range) == (0.25, 6.0)
    joy = found["/pad/joy"][0][1]
    assert len(joy.axes) == 6
    assert not any(joy.buttons)
    applied = found["/cmd_vel_applied"][0][1].twist
    assert (applied.linear.x, applied.angular.z) == (0.5, 0.5)
    assert len(found["/cmd_vel_sent"]) == 103
    arrays = [one.status for _, one in found["/diagnostics"]]
    texts = [one[0].message for one in arrays if one[0].name == "roburoc4"]
    assert texts[-1] == "192.168.0.5:40001 stopped the robot, after 5.0 s of driving"


def test_a_recorded_drive_is_no_fault(path: Path, tmp_path: Path) -> None:
    """Who converts only watches: the recorded program is not in its way."""
    assert run("convert", str(path), str(tmp_path / "run.mcap")).returncode == 0
    found = messages(tmp_path / "run.mcap")
    statuses = [each for _, one in found["/diagnostics"] for each in one.status]
    driving = [each for each in statuses if each.name == "roburoc4: driving"]
    assert any("another client" in each.message for each in driving)
    assert not [each.message for each in driving if each.level]


def test_ros2_bag_finds_qos_and_metadata_in_an_mcap_file(path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.mcap"
    done = document(run("convert", str(path), str(out), "--json"))
    with out.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        records = {one.name: one.metadata for one in reader.iter_metadata()}
    assert summary is not None
    stored = yaml.safe_load(records["rosbag2"]["serialized_metadata"])
    assert stored["version"] < 9, "since version 9, rosbag2 expects names instead of numbers"
    assert stored["message_count"] == done["messages"]
    counts = {
        one["topic_metadata"]["name"]: one["message_count"]
        for one in stored["topics_with_message_count"]
    }
    assert counts == {name: len(found) for name, found in messages(out).items()}
    latched = set()
    for channel in summary.channels.values():
        (profile,) = yaml.safe_load(channel.metadata["offered_qos_profiles"])
        (parsed,) = parse_qos(channel.metadata["offered_qos_profiles"])
        assert parsed.reliability is QosReliability.RELIABLE
        assert profile["deadline"] == {"sec": 9223372036, "nsec": 854775807}
        if parsed.durability is QosDurability.TRANSIENT_LOCAL:
            latched.add(channel.topic)
    assert latched == {
        "/tf_static",
        "/robot_description",
        "/bumpers/front",
        "/bumpers/rear",
        "/inhibited",
    }
    about = records["roburoc4"]
    assert about["library"] == f"roburoc4 {roburoc4.__version__}"
    assert about["address"] == "192.168.0.2:60000"
    assert "differential" in about["services"].lower()


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_csv_file_is_what_record_would_have_written(path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.csv"
    assert document(run("convert", str(path), str(out), "--json"))["rows"] == 100
    made = rows(out)
    assert [int(row["robot_cycles"]) for row in made] == list(range(1000, 1500, 5))
    assert float(made[40]["localization_x_m"]) == pytest.approx(math.sin(1.0))
    assert float(made[-1]["utc_s"]) == pytest.approx(BEGIN_US / 1e6 + 5.05, abs=1e-3)
    assert made[0]["battery_remaining_percent"] == "90"
    assert made[1]["battery_remaining_percent"] == ""


def test_csv_becomes_mcap_and_mcap_becomes_csv(path: Path, tmp_path: Path) -> None:
    first, bag, second = (tmp_path / name for name in ("a.csv", "b.mcap", "c.csv"))
    assert run("convert", str(path), str(first)).returncode == 0
    made = run("convert", str(first), str(bag))
    assert made.returncode == 0, made.stderr
    assert "/pad/joy" in one_line(made.stderr)
    back = run("convert", str(bag), str(second))
    assert back.returncode == 0, back.stderr
    assert "robot_cycles" in one_line(back.stderr)
    topics = set(messages(bag))
    assert topics == set(TOPICS) - OF_A_ROBOT
    before, after = rows(first), rows(second)
    left_out = {name for name in before[0] if name not in after[0]}
    assert {name for name in left_out if not name.startswith("iocard_")} == {
        "robot_s",
        "robot_cycles",
        "localization_flags",
        "battery_state",
    }
    assert len(before) == len(after) == 100
    for old, new in zip(before, after, strict=True):
        for name, cell in new.items():
            assert bool(cell) == bool(old[name]), name
            assert float(cell or 0) == pytest.approx(float(old[name] or 0), abs=1e-6), name


def cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def spoiled(data: bytes) -> bytes:
    half = len(data) // 2
    return data[:half] + b"\0\xff\n\0" * 4096 + data[half + 4 * 4096 :]


@pytest.mark.parametrize(
    ("form", "other", "damage"), [(".csv", ".mcap", spoiled), (".mcap", ".csv", cut)]
)
def test_a_damaged_table_or_bag_is_recovered_first(
    tmp_path: Path, form: str, other: str, damage: Callable[[bytes], bytes]
) -> None:
    path = write(tmp_path / "run.pcapng", drive(30.0))  # several chunks of an MCAP file
    whole, broken, out = tmp_path / f"a{form}", tmp_path / f"b{form}", tmp_path / f"c{other}"
    assert run("convert", str(path), str(whole)).returncode == 0
    broken.write_bytes(damage(whole.read_bytes()))
    out.write_text("precious")
    names = set(tmp_path.iterdir())
    failed = run("convert", str(broken), str(out), "--force")
    assert failed.returncode == 1
    assert f"roburoc4 recover {broken}" in one_line(failed.stderr)
    assert out.read_text() == "precious"
    assert set(tmp_path.iterdir()) == names
    saved = document(run("recover", str(broken), "--json"))
    done = document(run("convert", saved["file"], str(out), "--force", "--json"))
    assert done["rows" if other == ".csv" else "messages"] > 100


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "utc_s"),
        ("utc_s,localization_x_m\r\n1.5,fast\r\n", "fast"),
        ("utc_s,telemeter_distance_0_m\r\n1.5,1e99\r\n", "1e99"),
    ],
)
def test_a_table_of_something_else_is_one_line(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    failed = run("convert", str(path), str(tmp_path / "b.mcap"))
    assert failed.returncode == 1
    assert str(path) in one_line(failed.stderr)
    assert why in failed.stderr
    assert not (tmp_path / "b.mcap").exists()


def test_statuses_do_not_become_datagrams(path: Path, tmp_path: Path) -> None:
    source, out = tmp_path / "a.csv", tmp_path / "b.pcapng"
    assert run("convert", str(path), str(source)).returncode == 0
    failed = run("convert", str(source), str(out))
    assert failed.returncode == 2
    assert "datagrams" in one_line(failed.stderr)
    assert "roburoc4 record" in failed.stderr
    assert not out.exists()
    same = run("convert", str(source), str(tmp_path / "c.csv"))
    assert same.returncode == 2
    assert "copy" in one_line(same.stderr)


def test_another_programs_capture_can_be_converted(tmp_path: Path) -> None:
    path, out = tmp_path / "a.pcap", tmp_path / "b.pcapng"
    path.write_bytes(pcap(drive(1.0), link="two vlans"))
    assert document(run("convert", str(path), str(out), "--json"))["datagrams"] == len(drive(1.0))
    before, after = list(Capture(path)), list(Capture(out))
    assert [one[:4] for one in before] == [one[:4] for one in after]
    assert {one.inbound for one in after if one.source == ROBOT} == {True}


def test_a_live_mcap_file_is_read_and_a_killed_one_saved(tmp_path: Path) -> None:
    whole, cut = tmp_path / "a.mcap", tmp_path / "b.mcap"
    with roburoc4.Simulator(port=0) as sim:
        sim.set("front_bumper", True)
        done = document(run("record", str(whole), "--seconds", "2", "--json", robot=sim.address))
        process = start("record", str(cut), robot=sim.address)
        until(lambda: size_of(cut) > 20_000)
        process.kill()
        process.communicate(timeout=120)
    found = messages(whole)
    assert sum(len(one) for one in found.values()) == done["messages"]
    assert len(found["/odom"]) >= 10
    spread_s = (found["/odom"][-1][0] - found["/odom"][0][0]) / 1e9
    assert 1.0 < spread_s < 60.0
    saved = document(run("recover", str(cut), "--json"))
    again = messages(Path(saved["file"]))
    assert sum(len(one) for one in again.values()) == saved["packets"] > 50


def test_what_cannot_be_converted_is_one_line(path: Path, tmp_path: Path) -> None:
    wrong = run("convert", str(path), str(tmp_path / "a.bag"))
    assert wrong.returncode == 2
    assert ".mcap" in one_line(wrong.stderr)
    assert run("convert", str(path), str(path), "--force").returncode == 2
    assert len(list(Capture(path))) == len(drive(5.0))
    kept = tmp_path / "a.csv"
    kept.write_text("precious")
    assert "--force" in one_line(run("convert", str(path), str(kept)).stderr)
    none = run("convert", str(path), str(tmp_path / "no" / "a.mcap"))
    assert none.returncode == 2
    assert "another name" in one_line(none.stderr)
