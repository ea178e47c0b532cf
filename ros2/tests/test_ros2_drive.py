# SPDX-License-Identifier: MIT
"""`roburoc4 ros2 --enable-drive`: other processes drive and stop a robot over DDS."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from cli_support import start
from robot_support import until

import roburoc4
from roburoc4 import Simulator
from roburoc4_ros2.commands import Commands, DriveConfig
from roburoc4_ros2.listener import Listener
from roburoc4_ros2.participant import Participant
from roburoc4_tools.ros.cdr import Cdr
from roburoc4_tools.ros.published import CMD_VEL, Profile

PERIOD_S = 0.05


@pytest.fixture
def domain(worker_id: str) -> int:
    """A domain of this process: tests that run beside it must not hear each other."""
    return 150 + int(worker_id.removeprefix("gw") or 0) if worker_id != "master" else 149


class Bridge:
    """The command, as a process, and what it tells."""

    def __init__(self, domain: int, robot: str, *arguments: str) -> None:
        options = ("--domain", str(domain), "--interface", "lo", "--enable-drive")
        self.process = start("ros2", *options, *arguments, robot=robot)
        self.notes: list[str] = []
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()
        assert self.process.stdout is not None
        assert self.process.stdout.readline()

    def _read(self) -> None:
        assert self.process.stderr is not None
        self.notes.extend(iter(self.process.stderr.readline, ""))

    def told(self, text: str) -> bool:
        return any(text in note for note in self.notes)


@pytest.fixture
def bridge(domain: int, served: Simulator) -> Iterator[Callable[..., Bridge]]:
    started: list[Bridge] = []

    def start_it(*arguments: str) -> Bridge:
        started.append(Bridge(domain, served.address, *arguments))
        until(lambda: started[-1].told("connected to the robot"))
        return started[-1]

    yield start_it
    for one in started:
        if one.process.poll() is None:
            one.process.kill()
            one.process.wait()


@pytest.fixture
def others(domain: int) -> Iterator[Participant]:
    participant = Participant(domain, interface="lo")
    yield participant
    participant.close()


def sender(others: Participant, name: str) -> Callable[[bytes], None]:
    """Return what sends a forward speed in a frame, 20 times a second if called in a loop."""
    node = others.node("/", name)
    publisher = node.publisher("cmd_vel", "geometry_msgs/TwistStamped", Profile(10))
    others.announce()

    def send(frame: bytes) -> None:
        whole = bytes(Cdr().header(time.time(), "f").numbers("d", 0.3, *[0.0] * 5).data)
        publisher.publish(whole.replace(b"f\0", frame + b"\0"))
        time.sleep(PERIOD_S)

    return send


def drives(served: Simulator) -> bool:
    return served.state.last_linear_m_s > 0.29


def stands(served: Simulator) -> bool:
    return served.state.last_linear_m_s == 0 and served.state.target_linear_m_s == 0


def test_a_stop_sent_before_the_bridge_knew_its_sender_is_obeyed(
    bridge: Callable[..., Bridge], others: Participant
) -> None:
    # Transient local, as `ros2 topic pub --once` sends it.
    stop = others.node("/", "operator").publisher(
        "stop", "std_msgs/Empty", Profile(1, latched=True)
    )
    stop.publish(bytes(Cdr().numbers("B", 0).data))
    running = bridge()
    until(lambda: running.told("stopped by "))


def test_a_message_that_is_none_is_refused_and_the_next_drives(
    served: Simulator, bridge: Callable[..., Bridge], others: Participant
) -> None:
    running = bridge()
    send = sender(others, "broken")

    def refused() -> bool:
        send(b"\xff")  # no UTF-8; what is not CDR at all, DDS drops
        return running.told("it is not a message")

    def obeyed() -> bool:
        send(b"f")
        return drives(served)

    until(refused)
    time.sleep(1.0)  # the pause that the start of the bridge asks for
    until(obeyed)


def test_a_file_and_options_say_what_drives(
    served: Simulator, bridge: Callable[..., Bridge], others: Participant, tmp_path: Path
) -> None:
    file = tmp_path / "robots.yaml"
    file.write_text("lease_ms: 400\nmax_linear_m_s: 0.1\n", encoding="utf-8")
    bridge("--config", str(file))
    send = sender(others, "planner")
    time.sleep(1.0)  # the pause that the start of the bridge asks for

    def reduced() -> bool:
        send(b"f")
        return served.state.last_linear_m_s == pytest.approx(0.1)

    until(reduced)


def test_without_dds_the_robot_stands_and_a_person_is_told(domain: int, served: Simulator) -> None:
    ended, notes = threading.Event(), list[str]()
    participant = Participant(domain, interface="lo")
    with roburoc4.connect(served.address) as robot:
        commands = Commands(robot, DriveConfig(enabled=True), notes.append)
        listener = Listener(
            participant, participant.node("/", "x"), commands, [CMD_VEL], notes.append
        )
        thread = threading.Thread(target=listener.run, args=(ended,))
        thread.start()
        robot.arm()
        robot.drive(0.3, 0.0, lease_s=1.0)
        until(lambda: drives(served))
        participant.close()
        until(lambda: stands(served))
        until(lambda: notes)
        assert "commands cannot be read" in notes[-1]
        assert not robot.facts.armed
        ended.set()
        thread.join()


def test_an_unforeseen_error_stops_the_robot_and_reading_goes_on(
    domain: int, served: Simulator, others: Participant, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended, notes, looks = threading.Event(), list[str](), list[float]()
    with roburoc4.connect(served.address) as robot:
        commands = Commands(robot, DriveConfig(enabled=True), notes.append)

        def look(*arguments: float) -> None:
            looks.append(time.monotonic())
            if len(looks) == 1:
                raise RuntimeError("odd")

        monkeypatch.setattr(commands, "look", look)
        listener = Listener(others, others.node("/", "x"), commands, [CMD_VEL], notes.append)
        robot.arm()
        thread = threading.Thread(target=listener.run, args=(ended,))
        thread.start()
        until(lambda: len(looks) > 2)
        assert "RuntimeError('odd')" in notes[0]
        assert not robot.facts.armed
        ended.set()
        thread.join()
