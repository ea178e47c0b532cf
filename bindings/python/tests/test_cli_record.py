# SPDX-License-Identifier: MIT
"""`roburoc4 record`: statuses as columns, complete however it ends."""

import csv
import resource
import signal
import subprocess
from pathlib import Path

import pytest
from cli_support import COMMAND, Terminal, document, environment, eventually, one_line, run, start

import roburoc4
from roburoc4.cli.rows import Rows


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_file_has_a_row_for_each_cycle_with_a_status(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    with roburoc4.Simulator(port=0) as sim:
        sim.set("bumper_rear", True)
        report = document(run("record", str(path), "--seconds", "2", "--json", robot=sim.address))
    rows = _read(path)
    assert report == {
        "file": str(path),
        "rows": len(rows),
        "statuses": report["statuses"],
        "lost": 0,
    }
    cycles = [int(row["robot_cycles"]) for row in rows]
    assert cycles == sorted(set(cycles))
    assert len(rows) >= 35
    filled = sum(
        1
        for row in rows
        for name in ("x_m", "target_linear_m_s", "distance_0_m", "state", "analog_input_0")
        if row[name] != ""
    )
    assert filled == report["statuses"], "no status is left out"
    row = rows[-1]
    assert float(row["robot_s"]) == pytest.approx(int(row["robot_cycles"]) / 100)
    assert row["digital_input_1"] == "1"
    assert row["digital_input_0"] == "0"
    assert float(row["analog_input_2"]) == pytest.approx(25.4, abs=0.1)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_it_and_the_file_is_whole(
    tmp_path: Path, number: signal.Signals, code: int
) -> None:
    path = tmp_path / "run.csv"
    with roburoc4.Simulator(port=0) as sim:
        process = start("record", str(path), robot=sim.address)
        eventually(lambda: path.exists() and sim.state.subscriptions == 5)
        eventually(lambda: sim.state.cycles > 150)
        process.send_signal(number)
        _, stderr = process.communicate(timeout=30)
    assert (process.returncode, stderr) == (code, "")
    rows = _read(path)
    assert rows
    assert None not in rows[-1].values()


def test_a_file_with_contents_is_not_replaced_unasked(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("precious\n")
    with roburoc4.Simulator(port=0) as sim:
        done = run("record", str(path), "--seconds", "0.2", robot=sim.address)
        assert done.returncode == 2
        assert "--force" in one_line(done.stderr)
        assert path.read_text() == "precious\n"
        assert sim.state.requests == 0
        done = run("record", str(path), "--seconds", "0.3", "--force", robot=sim.address)
    assert done.returncode == 0
    assert _read(path)


def test_where_no_more_fits_the_file_ends_after_a_whole_row(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    room = 4001
    with roburoc4.Simulator(port=0) as sim:
        done = subprocess.run(
            [COMMAND, "record", str(path), "--seconds", "20"],
            env=environment(sim.address),
            capture_output=True,
            text=True,
            timeout=30,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)),
        )
    rows = _read(path)
    assert path.stat().st_size < room
    assert path.read_bytes().endswith(b"\r\n")
    assert len(rows) > 5
    assert None not in rows[-1].values()
    complaint = one_line(done.stderr)
    assert done.returncode == 1
    assert f"the {len(rows)} rows" in complaint
    assert "make room" in complaint


def test_a_folder_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("record", str(tmp_path / "no" / "run.csv"), "--seconds", "1", robot=sim.address)
    assert done.returncode == 2
    assert "another name" in one_line(done.stderr)


def test_a_terminal_shows_the_progress(tmp_path: Path) -> None:
    with roburoc4.Simulator(port=0) as sim:
        terminal = Terminal("record", str(tmp_path / "a.csv"), "--seconds", "1", robot=sim.address)
        terminal.wait_for(r"recording +\d+ rows .* of 1 s")
        assert terminal.wait() == 0
    assert "rows of" in terminal.text


def test_rows_come_in_the_robots_order_and_a_reboot_begins_anew() -> None:
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
        "robot_s": 10.0,
        "robot_cycles": 1000,
        "state": 2,
        "remaining_percent": 90,
        "distance_0_m": 3.0,
        "distance_1_m": None,
    }
