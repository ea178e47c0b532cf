# SPDX-License-Identifier: MIT
"""The command as a person starts it."""

import contextlib
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from page_client import Visitor
from station import MARGIN_S, free_port, until
from websockets.exceptions import ConnectionClosed

import roburoc4
from roburoc4_tools.cli import app
from roburoc4_tools.cli.watching import dashboard

MAIN = "from roburoc4_tools.cli import main; main()"
ARGUMENTS = ["dashboard", "--no-open", "--port", "0"]
LONG_S = 120.0
WITHIN_S = 0.25 + MARGIN_S
"""The default lease."""
ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]
TOKEN = "0123456789abcdef"


def hear_signals() -> None:
    """Obey signals as in a terminal, even where these tests run with signals ignored."""
    for number in ENDING:
        signal.signal(number, signal.SIG_DFL)


def start(*arguments: str, program: str = MAIN) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", program, *ARGUMENTS, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=hear_signals,
    )


def link_of(running: subprocess.Popen[str]) -> str:
    assert running.stdout is not None
    found = re.search(r"dashboard at (\S+)", running.stdout.readline())
    assert found is not None, running.communicate()
    return found[1]


def port_of(link: str) -> int:
    return int(link.rstrip("/").rpartition(":")[2])


@contextmanager
def driven() -> Iterator[tuple[subprocess.Popen[str], roburoc4.Simulator]]:
    """A dashboard in its own process, and a page that keeps driving the robot."""
    with (
        roburoc4.Simulator(port=0) as sim,
        start("--robot", sim.address, "--enable-drive") as running,
    ):
        try:
            with Visitor(port=port_of(link_of(running))) as driver:
                driver.arm()
                driver.drive(lambda: sim.state.last_linear_m_s > 0.3)
                driving = threading.Thread(target=drive_on, args=[driver])
                driving.start()
                yield running, sim
                driving.join()
        finally:
            running.kill()


def drive_on(driver: Visitor) -> None:
    with contextlib.suppress(ConnectionClosed, TimeoutError, OSError):
        while True:
            driver.draw(0.4)


@pytest.mark.parametrize("number", ENDING)
def test_ending_it_while_it_drives_stops_the_robot(number: signal.Signals) -> None:
    with driven() as (running, sim):
        running.send_signal(number)
        begun_s = time.monotonic()
        until(lambda: sim.state.last_linear_m_s == 0.0)
        assert time.monotonic() - begun_s < WITHIN_S
        assert not sim.state.watchdog_tripped
        assert running.wait(LONG_S) == 128 + number
        assert running.stderr is not None
        assert "Traceback" not in running.stderr.read()


def test_a_frozen_one_leaves_the_robot_to_its_watchdog_and_does_not_drive_on() -> None:
    with driven() as (running, sim):
        running.send_signal(signal.SIGSTOP)
        until(lambda: sim.state.watchdog_tripped)
        before = sim.state.nonzero_speed_commands
        running.send_signal(signal.SIGCONT)
        until(lambda: abs(sim.state.wheel_linear_m_s) < 0.01)
        time.sleep(1.0)
        assert sim.state.nonzero_speed_commands == before, "it woke, and drove on"
        running.kill()


def test_an_unreachable_robot_is_reported_and_not_armed() -> None:
    with start("--robot", f"127.0.0.1:{free_port()}", "--enable-drive") as running:
        with Visitor(port=port_of(link_of(running))) as visitor:
            visitor.say("take")
            visitor.draw_for(1.0)
            assert visitor.frame["state"] == "connecting"
            assert visitor.frame["link"]["level"] == "bad"
            assert "UDP server" in visitor.frame["link"]["attempt"]
            visitor.say("arm", tick=visitor.tick)
            until(lambda: visitor.receive()["type"] == "refused")
            assert "not connected" in visitor.refusals[-1]
        running.terminate()


def test_its_output_may_be_closed_and_it_ends_quietly() -> None:
    with start("--sim") as running:
        assert running.stdout is not None
        running.stdout.close()
        assert running.wait(LONG_S) == 0
        assert running.stderr is not None
        assert running.stderr.read() == ""


def test_without_its_extra_it_says_what_to_install() -> None:
    for missing in ("starlette", "uvicorn", "websockets"):
        program = f"import sys; sys.modules['{missing}'] = None; {MAIN}"
        with start(program=program) as running:
            _, complaint = running.communicate(timeout=LONG_S)
        assert running.returncode == 2
        assert 'pip install ./bindings/python "./tools[dashboard]"' in complaint


# ---- in this process, without serving ----


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The robots that it would have served."""
    found: list[Any] = []

    def note(*arguments: Any) -> None:
        for hub in arguments[-1]:
            until(lambda hub=hub: hub.robot.properties.differential is not None)
            hub.step()
        found.extend(arguments[-1])

    monkeypatch.setattr(dashboard, "_serve", note)
    return found


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[str, str]:
    assert app.run([*ARGUMENTS, *arguments]) == 0
    return capsys.readouterr()


def test_its_link_has_the_token_and_the_name_that_it_goes_by(
    served: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    link = r"^roburoc4: dashboard at http://localhost:\d+/\?token=[\w-]{32}$"
    names = ("--name", "localhost", "--name", "lab-pc")
    assert re.search(link, printed(capsys, "--sim", "--token", *names)[0])
    text, _ = printed(capsys, "--sim", "--name", "lab-pc:99", "--json")
    assert json.loads(text) == {"link": "http://lab-pc:99/"}
    _, warning = printed(capsys, "--sim", "--token", TOKEN)
    assert "$ROBUROC4_TOKEN" in warning


def test_options_for_driving_reach_the_robot(
    served: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    limits = ("--max-linear-m-s", "0.4", "--max-angular-rad-s", "0.7", "--lease-ms", "150")
    printed(capsys, "--sim", *limits)
    hub = served[0]
    assert not hub.control.offered
    assert hub.control.limits == ((0.4, 0.4), (0.7, 0.7))
    assert hub.control._lease_s == 0.15


def test_robots_have_names_and_one_may_have_none(
    served: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    with roburoc4.Simulator(port=0) as one, roburoc4.Simulator(port=0) as other:
        named = ("--robot", f"RED={one.address}", "--robot", f"BLUE={other.address}")
        _, warning = printed(capsys, *named, "--enable-drive")
        printed(capsys, "--robot", one.address)
    assert "keep an emergency stop in your hand" in warning
    assert [hub.name for hub in served] == ["RED", "BLUE", ""]
    assert [hub.robot.address for hub in served[:2]] == [one.address, other.address]
    assert [hub.control.offered for hub in served] == [True, True, False]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--sim", "--bind", "0.0.0.0"), "add --token"),
        (("--token", "short"), "16 or more"),
        (("--token", "has a blank in its midst"), "16 or more"),
        (("--bind", "robot.local"), "not an address"),
        (("--port", "70000"), "0 to 65535"),
        (("--lease-ms", "50"), "100 to 1000"),
        (("--max-linear-m-s", "nan"), "m/s"),
        (("--period-ms", "25"), "multiple of 10"),
        (("--period-ms", "210", "--enable-drive"), "100 or less"),
        (("--name", "lab-pc/page"), "--name"),
        (("--tls-cert", "x.pem"), "go together"),
        (("--tls-cert", "no.pem", "--tls-key", "no.pem"), "PEM"),
        (("--robot", "192.168.0.3", "--sim"), "omit --robot"),
        (("--robot", "192.168.0.3", "--robot", "RED=192.168.0.2"), "'192.168.0.3' has no name"),
        (("--robot", "RED=192.168.0.3", "--robot", "RED=192.168.0.2"), "its own name"),
        (("--camera", "front=rtsp://192.168.0.20/"), "--camera"),
        (("--camera", "front=http://192.168.0.20/; script-src *"), "--camera"),
    ],
)
def test_invalid_options_are_reported_with_the_remedy(
    arguments: tuple[str, ...],
    text: str,
    served: list[Any],
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert app.run([*ARGUMENTS, *arguments]) == 2
    complaint = capsys.readouterr().err
    assert text in complaint
    assert complaint.startswith("roburoc4: ")
    assert complaint.count("\n") == 1


def test_a_name_without_an_address_and_a_port_in_use_are_reported(
    served: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    assert app.run([*ARGUMENTS, "--robot", "nosuch.invalid"]) == 3
    assert capsys.readouterr().err.startswith("roburoc4: --robot: ")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        assert app.run([*ARGUMENTS, "--sim", "--port", port]) == 2
    assert "choose another port" in capsys.readouterr().err


def test_the_token_is_not_on_the_browsers_command_line() -> None:
    link = f"http://127.0.0.1:1/?token={TOKEN}"
    with dashboard._private(link) as opened:
        assert TOKEN not in opened
        path = Path(urllib.request.url2pathname(opened.removeprefix("file://")))
        assert link in path.read_text(encoding="utf-8")
        assert path.stat().st_mode & 0o077 == 0
        assert path.parent.stat().st_mode & 0o077 == 0
    assert not path.parent.exists()


def test_the_page_is_small_and_loads_nothing_from_other_hosts() -> None:
    static = Path(dashboard.__file__).parents[2] / "dashboard/static"
    assert "MIT License" in (static / "vendor/uplot/LICENSE").read_text()
    loaded = [path for path in static.rglob("*.*") if path.suffix in (".html", ".js", ".css")]
    assert len(loaded) > 20
    assert sum(path.stat().st_size for path in loaded) <= 200_000
    for path in loaded:
        if "vendor" not in path.parts:
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"""(src|href|url|import)\W{1,3}(https?:)?//""", text), path
