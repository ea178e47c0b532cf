# SPDX-License-Identifier: MIT
"""`roburoc4 record`: statuses as columns, complete however it ends."""

import csv
import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli_support import ALONE, COMMAND, document, environment, one_line, run, start
from robot_support import until

import roburoc4
from roburoc4_tools import recordings
from roburoc4_tools.recordings.rows import Rows


def _read(path: Path) -> list[dict[str, str]]:
    text = path.read_text(encoding="utf-8")  # at once: the file may be growing
    return list(csv.DictReader(text.splitlines()))


def test_the_file_has_a_row_for_each_cycle_with_a_status(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    with roburoc4.Simulator(port=0) as sim:
        sim.set("rear_bumper", True)
        report = document(run("record", str(path), "--seconds", "2", "--json", robot=sim.address))
    rows = _read(path)
    assert report == {
        "file": str(path),
        "rows": len(rows),
        "statuses": report["statuses"],
        "lost": report["lost"],
        "gaps": report["gaps"],
    }
    assert len(report["gaps"]) <= report["lost"] <= 2, "but what a busy machine skips"
    cycles = [int(row["robot_cycles"]) for row in rows]
    assert cycles == sorted(set(cycles))
    assert len(rows) >= 10
    filled = sum(
        1
        for row in rows
        for name in (
            "localization_x_m",
            "differential_target_linear_m_s",
            "telemeter_distance_0_m",
            "battery_state",
            "iocard_analog_input_0",
        )
        if row[name] != ""
    )
    assert filled == report["statuses"], "no status is left out"
    row = [row for row in rows if row["iocard_analog_input_2"]][-1]  # others have another cycle
    assert float(row["robot_s"]) == pytest.approx(int(row["robot_cycles"]) / 100)
    assert row["iocard_digital_input_1"] == "1"
    assert row["iocard_digital_input_0"] == "0"
    assert float(row["iocard_analog_input_2"]) == pytest.approx(25.4, abs=0.1)


def test_a_signal_ends_it_and_the_file_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    with roburoc4.Simulator(port=0) as sim:
        process = start("record", str(path), robot=sim.address)
        until(lambda: path.exists() and _read(path))
        process.send_signal(signal.SIGTERM)
        _, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (143, "")
    rows = _read(path)
    assert rows
    assert None not in rows[-1].values()


def test_a_file_with_contents_is_not_replaced_unasked(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("precious\n")
    with roburoc4.Simulator(port=0, host=ALONE) as sim:
        done = run("record", str(path), "--seconds", "0.2", robot=sim.address)
        assert done.returncode == 2
        assert "--force" in one_line(done.stderr)
        assert path.read_text() == "precious\n"
        assert sim.state.requests == 0
        done = run("record", str(path), "--seconds", "0.3", "--force", robot=sim.address)
    assert done.returncode == 0
    assert _read(path)


def test_on_a_full_disk_the_file_ends_after_a_whole_row(tmp_path: Path) -> None:
    path, room = tmp_path / "run.csv", 4001
    with roburoc4.Simulator(port=0) as sim:
        done = subprocess.run(
            [COMMAND, "record", str(path), "--seconds", "20"],
            env=environment(sim.address),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)),
        )
    rows = _read(path)
    assert path.stat().st_size <= room
    assert path.read_bytes().endswith(b"\r\n")
    assert len(rows) > 5
    assert None not in rows[-1].values()
    complaint = one_line(done.stderr)
    assert done.returncode == 1
    assert f"the {len(rows)} rows" in complaint
    assert "free some space" in complaint


def test_rows_are_in_the_robots_order_and_a_reboot_starts_over() -> None:
    rows = Rows()
    given: list[roburoc4.Status] = [
        roburoc4.BatteryStatus(1000, 2, 90),
        roburoc4.TelemeterStatus(1005, (1.0, 2.0)),
        roburoc4.TelemeterStatus(1000, (3.0, float("nan"))),
        roburoc4.BatteryStatus(7, 2, 89),
    ]
    out = [row for status in given for row in rows.add(status)]
    out += list(rows.rest())
    assert [row["robot_cycles"] for row in out] == [1000, 1005, 7]
    assert out[0] == {
        "utc_s": 0.0,
        "robot_s": 10.0,
        "robot_cycles": 1000,
        "battery_state": 2,
        "battery_remaining_percent": 90,
        "telemeter_distance_0_m": 3.0,
        "telemeter_distance_1_m": None,
    }


def test_a_gap_in_a_recording_is_counted_and_reported(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    with roburoc4.Simulator(port=0) as sim:
        process = start("record", str(path), "--seconds", "10", "--json", robot=sim.address)
        until(lambda: len(_read(path)) > 10 if path.exists() else False)
        sim.set("power", False)
        time.sleep(2.5)
        sim.set("power", True)
        stdout, stderr = process.communicate(timeout=120)
    report = json.loads(stdout)
    assert process.returncode == 0
    assert report["lost"] > 100
    assert len(report["gaps"]) == 1
    assert report["gaps"][0]["seconds"] > 2.4
    assert "localization" in report["gaps"][0]["services"]
    assert "1 gaps" in one_line(stderr)


def test_standard_output_takes_a_recording_and_may_close() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("record", "-", "--seconds", "2", robot=sim.address)
        rows = list(csv.DictReader(done.stdout.splitlines()))
        assert len(rows) >= 10
        assert "localization_x_m" in rows[0]
        assert f"-: {len(rows)} rows" in done.stderr
        assert done.returncode == 0
        process = start("record", "-", robot=sim.address)
        assert process.stdout is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.wait(timeout=120) == 0


def test_a_pcapng_file_has_every_datagram_in_both_directions(tmp_path: Path) -> None:
    path = tmp_path / "run.pcapng"
    with roburoc4.Simulator(port=0) as sim:
        done = document(run("record", str(path), "--seconds", "2", "--json", robot=sim.address))
        recorded_of = sim.address
    recording = recordings.open_recording(path)
    reading = recording.read()
    found = list(reading.items())
    assert (done["file"], done["not_recorded"]) == (str(path), 0)
    assert done["datagrams"] == reading.counts.from_robot + reading.counts.requests
    assert recording.address == recorded_of
    assert recording.head.answers.complete
    assert sum(isinstance(item, roburoc4.IoCardStatus) for item in found) >= 10
    refused = run("record", str(path), "--seconds", "1", robot=recorded_of)
    assert "--force" in one_line(refused.stderr)


@pytest.mark.parametrize("suffix", [".csv", ".mcap", ".pcapng"])
def test_a_name_that_cannot_be_used_is_named(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / ("x" * 300 + suffix)
    with roburoc4.Simulator(port=0) as sim:
        done = run("record", str(path), "--seconds", "1", robot=sim.address)
    assert done.returncode == 2
    assert f"{path} cannot be written" in one_line(done.stderr)
    assert "another name" in done.stderr


def test_without_the_extra_no_file_is_made(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    program = (
        "import sys; sys.modules['mcap.writer'] = sys.modules['mcap'] = None;"
        f"sys.argv = ['roburoc4', 'record', {str(path)!r}, '--seconds', '1'];"
        "from roburoc4_tools.cli import main; main()"
    )
    with roburoc4.Simulator(port=0) as sim:
        done = subprocess.run(
            [sys.executable, "-c", program],
            env=environment(sim.address),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.returncode == 2
    assert "[record]" in one_line(done.stderr)
    assert not path.exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_recording_may_go_to_a_named_pipe(tmp_path: Path) -> None:
    pipe, copy = tmp_path / "run.pcapng", tmp_path / "copy.pcapng"
    os.mkfifo(pipe)
    with (
        roburoc4.Simulator(port=0) as sim,
        copy.open("wb") as out,
        subprocess.Popen(["cat", str(pipe)], stdout=out),
    ):
        done = run("record", str(pipe), "--seconds", "1", robot=sim.address)
    assert done.returncode == 0
    assert pipe.is_fifo()
    assert copy.stat().st_size > 1000


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_pipe_that_nobody_reads_is_refused_with_the_reason(tmp_path: Path) -> None:
    pipe = tmp_path / "run.pcapng"
    os.mkfifo(pipe)
    with roburoc4.Simulator(port=0) as sim:
        done = run("record", str(pipe), "--seconds", "1", robot=sim.address)
    assert done.returncode == 1
    assert "nobody reads this pipe" in one_line(done.stderr)


@pytest.mark.parametrize("suffix", [".csv", ".mcap", ".pcapng"])
def test_without_a_robot_no_file_is_left(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"run{suffix}"
    with roburoc4.Simulator(port=0) as sim:
        address = sim.address
    done = run("record", str(path), "--seconds", "1", robot=address)
    assert done.returncode == 3
    assert not path.exists()
