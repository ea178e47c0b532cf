# SPDX-License-Identifier: MIT
"""`roburoc4 report` and `recover`: the numbers match what was sent; the page loads nothing."""

import html.parser
import math
import re
from pathlib import Path

import pytest
from capture_support import (
    BEGIN_US,
    ROBOT,
    drive,
    pcap,
    pcapng,
    statuses,
    write,
)
from cli_support import document, one_line, run

from roburoc4_tools.report.figures import Path as Way
from roburoc4_tools.report.series import Series


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write(tmp_path / "run.pcapng", drive(20.0))


def test_the_figures_are_those_that_were_sent(path: Path) -> None:
    figures = document(run("report", str(path), "--json"))
    assert figures["robot"] == "192.168.0.2:60000"
    assert figures["begun"] == "2023-11-14T22:13:20.000Z"
    assert figures["seconds"] == pytest.approx(20.2, abs=0.01)
    assert figures["path"]["driven_m"] == pytest.approx(0.5 * 19.95, rel=0.01)
    assert figures["heading_deg"]["last"] == pytest.approx(math.degrees(0.5 * 19.95))  # 1.6 turns
    assert figures["speeds"]["current_linear_m_s"]["high"] == pytest.approx(0.49)
    assert figures["battery"]["percent"] == {"first": 90, "low": 71, "high": 90, "last": 71}
    assert figures["distances_m"][0] == {"first": 2.0, "low": 2.0, "high": 3.99, "last": 3.99}
    assert figures["distances_m"][1] is None
    services = {one["service"]: one for one in figures["link"]["services"]}
    assert {name: one["received"] for name, one in services.items()} == {
        "iocard": 400,
        "telemeter": 200,
        "battery": 20,
        "localization": 400,
        "differential": 400,
    }
    assert services["iocard"]["longest_gap_s"] == 0.05
    assert figures["link"]["round_trip_ms"] == {"low": 0.4, "mean": 0.4, "high": 0.4}
    assert figures["clients"] == [{"address": "192.168.0.5:40001", "commands": 403, "speeds": 400}]
    assert [event["text"] for event in figures["events"]] == [
        "the robot is ready",
        "192.168.0.5:40001 begins to drive",
        "192.168.0.5:40001 stopped the robot, after 20.0 s of driving",
    ]
    assert figures["events"][2]["time"] == "2023-11-14T22:13:40.100Z"
    assert not list(path.parent.glob("*.html"))


class _Page(html.parser.HTMLParser):
    """Tags, what they refer to, and texts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.references: list[str | None] = []
        self.texts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.references += [
            value
            for name, value in attrs
            if name in ("src", "href", "xlink:href", "data", "action")
        ]

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def test_the_page_shows_everything_and_loads_nothing(path: Path) -> None:
    done = run("report", str(path))
    assert done.returncode == 0, done.stderr
    text = path.with_name("run.pcapng.html").read_text(encoding="utf-8")
    page = _Page(text)
    assert page.references == []
    assert not {"script", "link", "img", "iframe", "object"} & set(page.tags)
    assert not re.search(r"url\(|@import|https?:", text)
    assert (
        page.tags.count("svg") == 7
    )  # path, heading, speed, turn rate, charge, voltage, distances
    for words in ("9.97 m", "the robot is ready", "begins to drive", "Telemeters", "Charge"):
        assert any(words in one for one in page.texts), words
    assert len(text) < 200_000


def test_a_page_replaces_no_file_unasked(path: Path) -> None:
    recorded, output = path.read_bytes(), path.with_name("run.pcapng.html")
    for arguments in (("-o", str(path)), ("-o", str(path), "--force"), ("--json", "-o", str(path))):
        done = run("report", str(path), *arguments)
        assert done.returncode == 2
        assert f"{path} is the recording itself" in one_line(done.stderr)
        assert path.read_bytes() == recorded
    output.write_text("precious")
    for arguments in ((), ("-o", str(output))):
        done = run("report", str(path), *arguments)
        assert done.returncode == 2
        assert "--force" in one_line(done.stderr)
        assert output.read_text() == "precious"
    assert run("report", str(path), "--json").returncode == 0
    assert run("report", str(path), "--force").returncode == 0
    assert output.read_text(encoding="utf-8").startswith("<!")


def test_a_robots_text_cannot_become_part_of_the_page(path: Path) -> None:
    packets = []
    for packet in drive(1.0):
        data = packet.payload
        if packet.source == ROBOT and data[1:4] == b"\x01\x02\x00":  # the texts of its channels
            data = data[:5] + b"<script>alert(1)</script>"
        packets.append(packet._replace(payload=data))
    write(path, packets)
    assert run("report", str(path)).returncode == 0
    text = path.with_name("run.pcapng.html").read_text(encoding="utf-8")
    assert "script" not in _Page(text).tags
    assert "&lt;script&gt;" in text


def test_a_page_mentions_what_it_cannot_show(tmp_path: Path) -> None:
    path = tmp_path / "short.pcapng"
    data = pcapng(statuses(BEGIN_US, 0.01)[:1])
    path.write_bytes(data[:-1] + data[:10])
    output = tmp_path / "out.html"
    done = run("report", str(path), "-o", str(output))
    assert done.returncode == 1
    path.write_bytes(data + data[:10])
    done = run("report", str(path), "-o", str(output))
    assert done.returncode == 0, done.stderr
    assert "truncated" in one_line(done.stderr)
    text = output.read_text(encoding="utf-8")
    for words in ("The file is truncated", "services: those of the manual", "has no speeds"):
        assert words in text


def test_series_and_path_keep_their_size_and_their_extremes() -> None:
    series = Series(1000.0)
    way = Way()
    for at in range(200_000):
        series.add(1000.0 + at, float(at % 1000))
        way.add(at * 0.3, (at % 7) * 0.01)
    series.add(201_000.0, 5000.0)
    assert 600 < len(series.points) <= 2400
    assert (series.first, series.low, series.high, series.latest) == (0.0, 0.0, 5000.0, 5000.0)
    assert max(high for _, _, high in series.points) == 5000.0
    assert len(way.points) <= 8000
    assert way.driven_m > 59_000
    times = [seconds for seconds, _, _ in series.points]
    assert times == sorted(times)


# ---- recover ----


@pytest.mark.parametrize("form", [pcap, pcapng])
def test_recover_saves_what_is_complete_in_a_truncated_file(tmp_path: Path, form: object) -> None:
    assert callable(form)
    data = form(drive(1.0))
    path = tmp_path / "run.pcapng"
    path.write_bytes(data[: len(data) * 2 // 3 - 1])
    done = document(run("recover", str(path), "--json"))
    saved = tmp_path / "run.recovered.pcapng"
    assert done["file"] == str(saved)
    assert data.startswith(saved.read_bytes())
    assert done["kept"] + done["left_out"] == path.stat().st_size
    assert 0 < done["left_out"] < 200
    assert done["packets"] > 20


def test_recover_continues_after_a_damaged_part(tmp_path: Path) -> None:
    packets = drive(1.0)
    data = pcapng(packets)
    middle = len(data) // 2
    path = tmp_path / "run.pcapng"
    path.write_bytes(data[:middle] + b"\xee" * 400 + data[middle + 400 :])
    refused = run("report", str(path))
    assert refused.returncode == 1
    assert "roburoc4 recover" in one_line(refused.stderr)
    done = document(run("recover", str(path), "--json"))
    assert len(packets) - 8 <= done["packets"] < len(packets)
    again = document(run("report", done["file"], "--json"))
    assert again["cut_bytes"] == 0


def test_recover_replaces_nothing_unasked(tmp_path: Path) -> None:
    path = tmp_path / "run.pcapng"
    path.write_bytes(pcapng(drive(0.1)))
    saved = tmp_path / "run.recovered.pcapng"
    saved.write_text("precious")
    assert "--force" in one_line(run("recover", str(path)).stderr)
    same = run("recover", str(path), "-o", str(path), "--force")
    assert (same.returncode, saved.read_text()) == (2, "precious")
    assert path.read_bytes() == pcapng(drive(0.1))
    assert run("recover", str(path), "--force").returncode == 0


def test_what_cannot_be_used_is_one_line(tmp_path: Path) -> None:
    text = tmp_path / "a.txt"
    text.write_text("no recording at all")
    for verb in ("report", "recover"):
        none = run(verb, str(tmp_path / "none.pcapng"))
        assert none.returncode == 2
        assert "none.pcapng" in one_line(none.stderr)
        wrong = run(verb, str(text))
        assert wrong.returncode == 1
        assert "pcapng" in one_line(wrong.stderr)
    path = write(tmp_path / "a.pcapng", drive(0.1))
    done = run("report", str(path), "-o", str(tmp_path / "no" / "a.html"))
    assert done.returncode == 2
    assert "another name" in one_line(done.stderr)
