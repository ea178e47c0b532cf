# SPDX-License-Identifier: MIT
"""`roburoc4 doctor`: each staged fault has its own verdict."""

import errno
import json
import select
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from cli_support import doctor
from robot_support import until

import roburoc4
from roburoc4_tools.cli import app


def _verdict(*arguments: str, robot: str, verdict: str | None = None) -> dict[str, Any]:
    done = doctor("--json", "--seconds", "3", *arguments, robot=robot, verdict=verdict)
    assert done.stderr == ""
    document = json.loads(done.stdout)
    assert document["verdict"]["code"] == done.returncode
    assert document["verdict"]["remedy"]
    return {**document, "exit": done.returncode, "name": document["verdict"]["name"]}


@contextmanager
def _socket() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as somebody:
        somebody.bind(("127.0.0.1", 0))
        yield somebody


def _address(somebody: socket.socket) -> str:
    return f"127.0.0.1:{somebody.getsockname()[1]}"


def test_a_good_link_is_healthy() -> None:
    with roburoc4.Simulator(port=0) as sim:
        found = _verdict(robot=sim.address)
        assert (sim.state.speed_commands, sim.state.io_commands) == (0, 0)
    assert (found["name"], found["exit"], found["verdict"]["number"]) == ("healthy", 0, 0)
    assert found["loss"] == 0.0
    assert found["round_trip_ms"] < 50.0
    assert [stream["service"] for stream in found["streams"]] == [
        "iocard",
        "telemeter",
        "battery",
        "localization",
        "differential",
    ]
    for stream in found["streams"]:
        assert stream["received"] >= 2
        assert stream["rate_hz"] == pytest.approx(stream["asked_hz"], rel=0.05)


def test_fault_refused() -> None:
    with _socket() as somebody:
        port = somebody.getsockname()[1]
    found = _verdict(robot=f"127.0.0.1:{port}")
    assert (found["name"], found["exit"]) == ("refused", 3)


def test_fault_silence() -> None:
    with _socket() as somebody:
        found = _verdict(robot=_address(somebody))
    assert (found["name"], found["exit"]) == ("silence", 3)
    assert found["asked"] > 3
    assert found["answered"] == 0


def test_fault_no_statuses() -> None:
    with roburoc4.Simulator(port=0, refused_inserts=1 << 5) as sim:
        found = _verdict(robot=sim.address)
    assert (found["name"], found["exit"]) == ("no statuses", 1)
    assert "the robot refused localization" in found["verdict"]["sentence"]
    assert (found["refused"], found["other_source"]) == (["localization"], None)


@contextmanager
def _from_another_port(robot: str) -> Iterator[tuple[str, str]]:
    """Serve a robot whose statuses come from another port; both addresses."""
    host, _, port = robot.rpartition(":")
    to_robot: dict[tuple[str, int], socket.socket] = {}
    ended = threading.Event()
    with _socket() as front, _socket() as other:

        def relay() -> None:
            while not ended.is_set():
                for ready in select.select([front, *to_robot.values()], [], [], 0.1)[0]:
                    if ready is front:
                        data, client = front.recvfrom(2048)
                        if client not in to_robot:
                            to_robot[client] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                            to_robot[client].connect((host, int(port)))
                        to_robot[client].send(data)
                    else:
                        data = ready.recv(2048)
                        (client,) = [c for c, upstream in to_robot.items() if upstream is ready]
                        (other if data[:1] == b"\xff" else front).sendto(data, client)

        thread = threading.Thread(target=relay)
        thread.start()
        try:
            yield _address(front), _address(other)
        finally:
            ended.set()
            thread.join()
            for upstream in to_robot.values():
                upstream.close()


def test_fault_statuses_from_another_port() -> None:
    with roburoc4.Simulator(port=0) as sim, _from_another_port(sim.address) as (robot, other):
        found = _verdict(robot=robot)
    assert (found["name"], found["exit"]) == ("no statuses", 1)
    assert found["other_source"] == other
    assert f"come from {other} instead of {robot}" in found["verdict"]["sentence"]


def test_fault_loss() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set_faults(loss=0.2)
        found = _verdict(robot=sim.address)
    assert (found["name"], found["exit"]) == ("loss", 1)
    assert 0.05 < found["loss"] < 0.4


def test_fault_jitter() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set_faults(jitter_ms=150.0)
        for _ in range(10):
            found = _verdict(robot=sim.address, verdict="jitter")
            if found["name"] == "jitter":  # else the jitter was low
                break
    assert (found["name"], found["exit"]) == ("jitter", 1)


def test_repeated_datagrams_are_a_note_and_do_not_slow_answers() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set_faults(duplicate=0.3)
        found = _verdict(robot=sim.address)
    assert (found["name"], found["exit"]) == ("healthy", 0)
    assert found["round_trip_ms"] < 50.0
    assert found["answered"] <= found["asked"]
    assert 0.1 * found["received"] < found["repeated"] < 0.4 * found["received"]
    assert [note for note in found["notes"] if "repeated" in note]


def test_fault_damaged() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set_faults(corrupt=0.2)
        found = _verdict(robot=sim.address)
    assert (found["name"], found["exit"], found["verdict"]["number"]) == ("damaged", 1, 14)
    assert found["damaged"] > 0.01 * found["received"]


def test_fault_route(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Each address has a route on some machine, so the system's error is faked."""

    def no_route(_self: socket.socket, _address: object) -> None:
        raise OSError(errno.ENETUNREACH, "Network is unreachable")

    connect = "roburoc4_tools.cli.connecting.probe.socket.socket.connect"
    monkeypatch.setattr(connect, no_route, raising=False)
    options = app.parser().parse_args(["doctor", "--robot", "192.0.2.1"])
    assert options.run(options) == 3
    assert "verdict 2, route" in capsys.readouterr().out


def test_fault_missing_service() -> None:
    with roburoc4.Simulator(port=0, hidden_services=1 << 4) as sim:
        found = _verdict(robot=sim.address)
    assert (found["name"], found["exit"]) == ("service missing", 1)
    assert found["missing"] == ["battery"]


def test_fault_interrupted() -> None:
    with roburoc4.Simulator(port=0) as sim:

        def reboot_in_the_midst() -> None:
            while sim.state.subscriptions < 5:
                time.sleep(0.02)
            time.sleep(1.0)
            sim.reboot()

        # It was on for longer than the silence lasts, so that its clock is seen to go back.
        until(lambda: sim.state.cycles > 300)
        thread = threading.Thread(target=reboot_in_the_midst)
        thread.start()
        found = _verdict("--seconds", "6", robot=sim.address)
        thread.join()
    assert (found["name"], found["exit"]) == ("interrupted", 1)


def test_people_get_every_check_and_what_to_do_next() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set("battery_percent", 5)
        done = doctor("--seconds", "3", robot=sim.address)
    assert (done.returncode, done.stderr) == (0, "")
    for text in (
        "ok    name",
        "ok    answer",
        "ok    discovery",
        "iocard",
        "20.0/s",
        "charge it",
        "verdict 0, healthy",
        "next: ",
    ):
        assert text in done.stdout
    table = done.stdout.partition("\nservice")[2].partition("\nround trip")[0]
    assert max(map(len, table.splitlines())) <= 40
