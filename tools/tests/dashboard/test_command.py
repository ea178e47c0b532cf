# SPDX-License-Identifier: MIT
"""The command as a person starts it."""

import contextlib
import json
import re
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from page_client import Visitor
from station import Stopwatch, free_port, until
from test_driving import MARGIN_S
from websockets.exceptions import ConnectionClosed

import roburoc4
from roburoc4_tools.cli import dashboard

COMMAND = [
    sys.executable,
    "-c",
    "from roburoc4_tools.cli import main; main()",
    "dashboard",
    "--no-open",
]
LONG_S = 120.0
WITHIN_S = 0.25 + MARGIN_S
"""The default lease."""


ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]


def start(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, "--port", "0", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=hear_signals,
    )


def hear_signals() -> None:
    """Obey signals as in a terminal, even where these tests run with signals ignored."""
    for number in ENDING:
        signal.signal(number, signal.SIG_DFL)


def refused(*arguments: str) -> str:
    done = subprocess.run(
        [*COMMAND, *arguments], capture_output=True, text=True, timeout=LONG_S, check=False
    )
    assert done.returncode == 2, done
    assert done.stderr.startswith("roburoc4: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


def link_of(running: subprocess.Popen[str]) -> str:
    assert running.stdout is not None
    found = re.search(r"dashboard at (\S+)", running.stdout.readline())
    assert found is not None, running.communicate()
    return found[1]


def port_of(link: str) -> int:
    return int(link.rstrip("/").rpartition(":")[2])


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["ctrl-c", "sigterm"]
)
def test_it_prints_its_link_serves_and_ends_quietly(number: signal.Signals, code: int) -> None:
    with start("--sim") as running:
        link = link_of(running)
        with urllib.request.urlopen(link, timeout=LONG_S) as answer:
            assert b"roburoc4" in answer.read()
        running.send_signal(number)
        _, complaints = running.communicate(timeout=LONG_S)
    assert running.returncode == code
    assert complaints == ""


@contextmanager
def driven(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], roburoc4.Simulator]]:
    """A dashboard in its own process, and a page that keeps driving the robot."""
    with (
        roburoc4.Simulator(port=0) as sim,
        start("--robot", sim.address, "--enable-drive", *arguments) as running,
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
        watch = Stopwatch()
        watch.until(lambda: sim.state.last_linear_m_s == 0.0)
        assert watch.seconds() < WITHIN_S
        assert not sim.state.watchdog_tripped
        assert running.wait(LONG_S) == 128 + number


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
def test_the_robot_s_watchdog_stops_it_where_the_program_cannot(number: signal.Signals) -> None:
    with driven() as (running, sim):
        running.send_signal(number)
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


def test_without_a_browser_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    dashboard._open("http://127.0.0.1:1/")
    assert "open the link yourself" in capsys.readouterr().err


def test_a_key_with_a_password_is_refused_and_not_asked_for(tmp_path: Path) -> None:
    certificate, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"),
            *("-passout", "pass:secret", "-days", "2", "-subj", "/CN=127.0.0.1"),
            *("-out", certificate, "-keyout", key),
        ],
        check=True,
        capture_output=True,
    )
    assert "without a password" in refused("--sim", "--tls-cert", certificate, "--tls-key", key)


def test_its_output_may_be_closed_and_it_ends_quietly() -> None:
    with start("--sim") as running:
        assert running.stdout is not None
        running.stdout.close()
        assert running.wait(LONG_S) == 0
        assert running.stderr is not None
        assert running.stderr.read() == ""


def test_the_token_is_not_on_the_browsers_command_line() -> None:
    link = "http://127.0.0.1:1/?token=0123456789abcdef"
    with dashboard._private(link) as opened:
        assert "0123456789abcdef" not in opened
        path = Path(urllib.request.url2pathname(opened.removeprefix("file://")))
        assert link in path.read_text(encoding="utf-8")
        assert path.stat().st_mode & 0o077 == 0
        assert path.parent.stat().st_mode & 0o077 == 0
    assert not path.parent.exists()
    with dashboard._private("http://127.0.0.1:1/") as opened:
        assert opened == "http://127.0.0.1:1/", "there is nothing to hide"


def test_a_token_on_the_command_line_gives_a_warning() -> None:
    with start("--sim", "--token", "0123456789abcdef") as running:
        link_of(running)
        running.terminate()
        _, complaints = running.communicate(timeout=LONG_S)
    assert "$ROBUROC4_TOKEN" in complaints


def test_its_link_has_the_name_that_it_goes_by() -> None:
    with start("--sim", "--name", "localhost", "--name", "lab-pc") as running:
        link = link_of(running)
        assert link.startswith("http://localhost:")
        with urllib.request.urlopen(link, timeout=LONG_S) as answer:
            assert answer.status == 200
        running.terminate()
    with start("--sim", "--name", "lab-pc:99") as running:
        assert link_of(running) == "http://lab-pc:99/"
        running.terminate()


def test_a_token_is_made_and_printed_as_a_link() -> None:
    with start("--sim", "--bind", "127.0.0.1", "--token") as running:
        link = link_of(running)
        assert re.search(r"\?token=[\w-]{32}$", link)
        with urllib.request.urlopen(link, timeout=LONG_S) as answer:
            assert answer.status == 200
        running.terminate()


def test_its_link_is_json_where_json_is_asked_for() -> None:
    with start("--sim", "--json") as running:
        assert running.stdout is not None
        assert json.loads(running.stdout.readline())["link"].startswith("http://127.0.0.1:")
        running.terminate()


def test_other_than_loopback_needs_a_token() -> None:
    assert "add --token" in refused("--sim", "--bind", "0.0.0.0")


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--token", "short"), "16 or more"),
        (("--token", "has a blank in its midst"), "16 or more"),
        (("--bind", "robot.local"), "not an address"),
        (("--port", "70000"), "0 to 65535"),
        (("--port", "-1"), "0 to 65535"),
        (("--lease-ms", "50"), "100 to 1000"),
        (("--max-linear", "nan"), "m/s"),
        (("--period-ms", "25"), "multiple of 10"),
        (("--period-ms", "210", "--enable-drive"), "100 or less"),
        (("--name", "http://p"), "--name"),
        (("--name", "lab-pc/page"), "--name"),
        (("--name", "lab-pc:x"), "--name"),
        (("--name", ""), "--name"),
        (("--tls-cert", "x.pem"), "go together"),
        (("--tls-cert", "no.pem", "--tls-key", "no.pem"), "PEM"),
        (("--robot", "192.168.0.3", "--sim"), "omit --robot"),
        (("--robot", "192.168.0.3", "--robot", "RED=192.168.0.2"), "'192.168.0.3' has no name"),
        (("--robot", "RED=192.168.0.3", "--robot", "RED=192.168.0.2"), "its own name"),
        (("--robot", "a b=192.168.0.3"), "has no name"),
        (("--camera", "front"), "--camera"),
        (("--camera", "front=rtsp://192.168.0.20/"), "--camera"),
        (("--camera", "front=http://192.168.0.20/; script-src *"), "--camera"),
    ],
)
def test_invalid_options_are_reported_with_the_remedy(
    arguments: tuple[str, ...], text: str
) -> None:
    assert text in refused(*arguments)


def test_robots_have_names_and_one_may_have_none() -> None:
    with (
        roburoc4.Simulator(port=0) as one,
        roburoc4.Simulator(port=0) as other,
        start(
            "--robot", f"RED={one.address}", "--robot", f"BLUE={other.address}", "--no-open"
        ) as running,
    ):
        with Visitor(port=port_of(link_of(running)), path="/socket?robot=BLUE") as page:
            assert page.receive()["address"] == other.address
            page.draw()
            assert [robot["name"] for robot in page.frame["fleet"]] == ["RED", "BLUE"]
        running.terminate()


def test_a_name_without_an_address_ends_it_as_elsewhere() -> None:
    done = subprocess.run(
        [*COMMAND, "--robot", "nosuch.invalid"],
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )
    assert done.returncode == 3
    assert done.stderr.startswith("roburoc4: --robot: ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("missing", ["starlette", "uvicorn", "websockets"])
def test_without_its_extra_it_says_what_to_install(missing: str) -> None:
    without = (
        f"import sys; sys.modules['{missing}'] = None; from roburoc4_tools.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", without, "dashboard", "--no-open"],
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )
    assert done.returncode == 2
    assert 'pip install ./bindings/python "./tools[dashboard]"' in done.stderr


def test_a_port_in_use_is_reported() -> None:
    with start("--sim") as running:
        port = port_of(link_of(running))
        assert "choose another port" in refused("--sim", "--port", str(port))
        running.terminate()


def test_the_package_has_the_page_and_its_parts_licences() -> None:
    import roburoc4_tools.dashboard

    static = Path(roburoc4_tools.dashboard.__file__).parent / "static"
    assert "MIT License" in (static / "vendor/uplot/LICENSE").read_text()
    assert json.loads((static / "vendor/uplot/version.json").read_text())["license"] == "MIT"
    for path in static.rglob("*.*"):
        if path.suffix in (".html", ".css", ".js") and "vendor" not in path.parts:
            text = path.read_text(encoding="utf-8")
            assert "SPDX-License-Identifier: MIT" in text, path
            assert not re.search(r"""(src|href|url|import)\W{1,3}(https?:)?//""", text), path
