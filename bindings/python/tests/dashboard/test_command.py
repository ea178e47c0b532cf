# SPDX-License-Identifier: MIT
"""The command as a person starts it."""

import json
import re
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

COMMAND = [sys.executable, "-c", "from roburoc4.cli import main; main()", "dashboard", "--no-open"]
LONG_S = 30.0


def start(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, "--port", "0", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


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
    assert found is not None
    return found[1]


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


def test_a_token_is_made_and_printed_as_a_link() -> None:
    with start("--sim", "--bind", "127.0.0.1", "--token") as running:
        link = link_of(running)
        assert re.search(r"\?token=[\w-]{32}$", link)
        with urllib.request.urlopen(link, timeout=LONG_S) as answer:
            assert answer.status == 200
        running.terminate()


def test_other_than_loopback_needs_a_token() -> None:
    assert "add --token" in refused("--sim", "--bind", "0.0.0.0")


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--token", "short"), "16 or more"),
        (("--token", "has a blank in its midst"), "16 or more"),
        (("--bind", "robot.local"), "no address"),
        (("--port", "70000"), "0 to 65535"),
        (("--port", "-1"), "0 to 65535"),
        (("--lease-ms", "50"), "100 to 1000"),
        (("--max-linear", "nan"), "m/s"),
        (("--period-ms", "25"), "multiple of 10"),
        (("--tls-cert", "x.pem"), "go together"),
        (("--tls-cert", "no.pem", "--tls-key", "no.pem"), "PEM"),
        (("--robot", "no such name.invalid"), "--robot"),
    ],
)
def test_what_cannot_be_used_is_told_with_the_remedy(arguments: tuple[str, ...], text: str) -> None:
    assert text in refused(*arguments)


def test_a_port_that_is_taken_is_told() -> None:
    with start("--sim") as running:
        port = link_of(running).rstrip("/").rpartition(":")[2]
        assert "choose another port" in refused("--sim", "--port", port)
        running.terminate()


def test_the_page_is_in_the_package_with_the_licence_of_what_is_vendored() -> None:
    import roburoc4.dashboard

    static = Path(roburoc4.dashboard.__file__).parent / "static"
    assert "MIT License" in (static / "vendor/uplot/LICENSE").read_text()
    assert json.loads((static / "vendor/uplot/version.json").read_text())["license"] == "MIT"
    for path in static.rglob("*.*"):
        if path.suffix in (".html", ".css", ".js") and "vendor" not in path.parts:
            text = path.read_text(encoding="utf-8")
            assert "SPDX-License-Identifier: MIT" in text, path
            assert not re.search(r"""(src|href|url|import)\W{1,3}(https?:)?//""", text), path
