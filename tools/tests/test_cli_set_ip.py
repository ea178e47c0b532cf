# SPDX-License-Identifier: MIT
"""`roburoc4 set-ip`: the manual's telnet procedure, against the simulated controller and others."""

import re
import socket
import threading
from collections.abc import Callable, Iterator

import pytest
from cli_support import Terminal, document, one_line, run, start

from roburoc4_tools.cli.connecting import netcfg
from roburoc4_tools.cli.connecting.set_ip import checked
from roburoc4_tools.cli.errors import CommandError

NEW = ("10.0.0.10", "255.0.0.0", "10.0.0.1")
ASKED = b"netcfg 10.0.0.10 255.0.0.0 10.0.0.1\r\n"


@pytest.fixture
def console() -> Iterator[tuple[str, Callable[[], str]]]:
    """A simulator's telnet port, and a function that reads its next line."""
    process = start("sim", "--port", "0", "--telnet", "0")
    assert process.stdout is not None
    read = process.stdout.readline
    try:
        read(), read()
        port = re.fullmatch(r"telnet console on 127\.0\.0\.1:(\d+)\n", read())
        assert port
        yield port[1], read
    finally:
        process.terminate()
        process.communicate(timeout=120)


class Scripted:
    """A telnet console with one text at the start, and one after a line."""

    def __init__(self, welcome: bytes, answer: bytes | None = None, *, ends: bool = False) -> None:
        self._ends = ends
        self.heard = b""
        self._texts = (welcome, answer)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        welcome, answer = self._texts
        connection, _ = self._listener.accept()
        with connection:
            connection.sendall(welcome)
            while answer is not None and not self.heard.endswith(b"\n"):
                if not (heard := connection.recv(1000)):
                    return
                self.heard += heard
            if answer is not None:
                connection.sendall(answer)
                if not self._ends:
                    connection.recv(1000)

    def set(self) -> str:
        return netcfg.set_address("127.0.0.1", self.port, checked(*NEW), lambda _: None)


@pytest.fixture
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("_WELCOME_S", "_ANSWER_S"):
        monkeypatch.setattr(netcfg, name, 0.5)
    monkeypatch.setattr(netcfg, "_QUIET_S", 0.1)


def test_the_simulated_controller_accepts_the_address(
    console: tuple[str, Callable[[], str]],
) -> None:
    port, read = console
    done = run("set-ip", *NEW, "--robot", "127.0.0.1", "--telnet-port", port, "--yes")
    assert done.returncode == 0, done.stderr
    assert "switch the robot off and on" in done.stdout
    assert "roburoc4 doctor --robot 10.0.0.10" in done.stdout
    assert read() == "telnet: address 10.0.0.10, mask 255.0.0.0, gateway 10.0.0.1\n"


def test_json_has_the_settings_and_the_controllers_words(
    console: tuple[str, Callable[[], str]],
) -> None:
    arguments = ("--robot", "127.0.0.1:60000", "--telnet-port", console[0], "--yes", "--json")
    said = document(run("set-ip", *NEW, *arguments))
    assert said.pop("answer").endswith("used after a restart")
    assert said == {
        "robot": "127.0.0.1",
        "address": NEW[0],
        "mask": NEW[1],
        "gateway": NEW[2],
    }


def test_only_a_person_or_yes_confirms() -> None:
    done = run("set-ip", *NEW, "--robot", "127.0.0.1", "--telnet-port", "9")
    assert done.returncode == 2
    assert "--yes" in one_line(done.stderr)


def test_a_person_who_says_no_changes_nothing() -> None:
    terminal = Terminal("set-ip", *NEW, "--robot", "127.0.0.1", "--telnet-port", "9")
    terminal.wait_for(r"Change the address of the robot at 127\.0\.0\.1 to 10\.0\.0\.10")
    terminal.type("n\r")
    assert terminal.wait() == 2
    assert "nothing was changed" in terminal.text


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        (("10.0.0.x", NEW[1], NEW[2]), "10.0.0.x"),
        (("127.0.0.1", NEW[1], NEW[2]), "127.0.0.1"),
        (("10.0.0.0", NEW[1], NEW[2]), "10.0.0.0/8"),
        (("10.255.255.255", NEW[1], NEW[2]), "10.0.0.0/8"),
        ((NEW[0], "255.0.255.0", NEW[2]), "255.0.255.0"),
        ((NEW[0], "0.0.0.255", NEW[2]), "0.0.0.255"),
        ((NEW[0], "255.255.255.255", NEW[2]), "255.255.255.255"),
        ((NEW[0], NEW[1], "11.0.0.1"), "11.0.0.1"),
        ((NEW[0], NEW[1], NEW[0]), NEW[0]),
    ],
)
def test_settings_that_would_lose_the_robot_are_refused(
    settings: tuple[str, str, str], named: str
) -> None:
    with pytest.raises(CommandError, match=re.escape(named)) as raised:
        checked(*settings)
    assert raised.value.code == 2


def test_without_a_console_it_says_that_nothing_was_changed() -> None:
    done = run("set-ip", *NEW, "--yes", "--robot", "127.0.0.1", "--telnet-port", "1")
    assert done.returncode == 3
    assert "nothing was changed" in done.stderr.splitlines()[-1]


@pytest.mark.usefixtures("hurried")
@pytest.mark.parametrize(
    ("welcome", "complaint"),
    [
        (b"CE\r\nlogin: ", "asks for a login"),
        (b"", "said nothing"),
        (b"HTTP/1.1 400 Bad Request\r\n", "showed no prompt"),
    ],
)
def test_nothing_is_sent_to_other_machines(welcome: bytes, complaint: str) -> None:
    other = Scripted(welcome, b"")
    with pytest.raises(CommandError, match=complaint) as raised:
        other.set()
    assert raised.value.code == 1
    assert "nothing was changed" in raised.value.message
    assert other.heard == b""


@pytest.mark.usefixtures("hurried")
@pytest.mark.parametrize(
    ("answer", "complaint"),
    [
        (ASKED + b"'netcfg' is not recognized as a command\r\n\\> ", "not recognized"),
        (ASKED + b"IP settings saved, 0 errors\r\n\\> ", "saved, 0 errors"),
        (b"", "did not confirm"),
        (ASKED + b"\\> ", "did not confirm"),
    ],
)
def test_no_confirmation_is_neither_success_nor_failure(answer: bytes, complaint: str) -> None:
    robot = Scripted(b"Welcome\r\n\\> ", answer)
    with pytest.raises(CommandError, match=complaint) as raised:
        robot.set()
    assert raised.value.code == 1
    assert "whether the address was changed is not known" in raised.value.message
    assert robot.heard == ASKED


@pytest.mark.usefixtures("hurried")
def test_after_a_broken_session_the_result_is_unknown() -> None:
    robot = Scripted(b"Welcome\r\n\\> ", b"", ends=True)
    with pytest.raises(CommandError, match=r"broke off .*is not known"):
        robot.set()


def test_a_port_that_cannot_be_used_ends_the_simulator() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        done = run("sim", "--port", "0", "--telnet", port)
    assert done.returncode == 1
    assert port in one_line(done.stderr)
    done = run("sim", "--port", "0", "--telnet", "x")
    assert done.returncode == 2
