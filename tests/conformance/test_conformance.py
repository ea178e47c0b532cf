# SPDX-License-Identifier: MIT
"""The judges pass what is right and name what is wrong. ROBUROC4_SIM_PROGRAM and
ROBUROC4_DRIVE_PROGRAM are roburoc4-sim and examples/drive, STALLS is tests/adapters/stalls.c."""

import contextlib
import math
import os
import select
import socket
import subprocess
import sys
import unittest
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from unittest import mock

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "support"))

from judge_client import ClientJudge
from judge_robot import RobotJudge
from judged import judged
from played_robot import IDS, PlayedRobot
from telegrams import ENTRIES, STATUS, Report, Values, decode, encode

WATCHDOG_S = 0.3
PATIENCE_S = 0.5  # of the judge with a robot in the same process


def judge_robot(prepare: Callable[[PlayedRobot], None], drive: bool) -> Report:
    with contextlib.closing(PlayedRobot(watchdog_s=WATCHDOG_S)) as robot:
        prepare(robot)
        robot.start()
        return RobotJudge(("127.0.0.1", robot.port), WATCHDOG_S, PATIENCE_S).judge(drive)


# ------------------------------------------------------------------------------- robots


def sends(telegram: str, edit: Callable[[Values], Any]) -> Callable[[PlayedRobot], None]:
    """A robot whose telegrams of this name have other values."""

    def change(name: str, values: Values, data: bytes) -> bytes | None:
        if telegram not in (name, "answer" if "error" in values else "status"):
            return data
        changed = dict(values)
        edit(changed)
        return encode(name, **changed)

    return lambda robot: setattr(robot, "change", change)


def sends_bytes(telegram: str, edit: Callable[[bytes], bytes | None]) -> Callable[..., None]:
    def change(name: str, values: Values, data: bytes) -> bytes | None:
        return edit(data) if name == telegram else data

    return lambda robot: setattr(robot, "change", change)


def puts(**others: Any) -> Callable[[Values], None]:
    return lambda values: values.update(others)


def swaps(first: str, second: str) -> Callable[[Values], None]:
    return lambda values: values.update({first: values[second], second: values[first]})


def accepts(action: int, error: int) -> Callable[[Values], None]:
    """An error of this action is answered as none."""
    return lambda values: values.update(
        error=0 if (values["action"], values["error"]) == (action, error) else values["error"]
    )


def turn_bytes(value: int, size: int) -> int:
    return int.from_bytes(value.to_bytes(size, "little"), "big")


def answers_elsewhere(robot: PlayedRobot) -> None:
    robot.answer_socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


def ignores(what: str) -> Callable[[PlayedRobot], None]:
    return lambda robot: robot.ignores.add(what)


def swaps_ranges(values: Values) -> None:
    values["telemeters"] = [
        {**sensor, "max_m": sensor["min_m"], "min_m": sensor["max_m"]}
        for sensor in values["telemeters"]
    ]


def becomes(call: Callable[[Values], Any]) -> Callable[[Values], None]:
    return lambda values: values.update(call(values))


ROBOTS: list[tuple[str, Callable[[PlayedRobot], None]]] = [
    ("answer-id", sends("answer", becomes(lambda v: {"id": v["id"] % 254 + 1}))),
    ("answer-action", sends("battery-properties", puts(action=1))),
    ("answer-target", sends("answer", becomes(lambda v: {"target": turn_bytes(v["target"], 2)}))),
    ("answer-source", answers_elsewhere),
    ("answer-length", sends_bytes("battery-properties", lambda data: data[:4])),
    ("directory-silent", sends_bytes("directory", lambda data: None)),
    ("directory-length", sends_bytes("directory", lambda data: data + b"\0")),
    (
        "directory-first",
        sends(
            "directory", becomes(lambda v: {"services": v["services"][1::-1] + v["services"][2:]})
        ),
    ),
    (
        "directory-ids",
        sends(
            "directory", becomes(lambda v: {"services": v["services"][:1] * 2 + v["services"][2:]})
        ),
    ),
    (
        "text-missing",
        sends("text-directory", becomes(lambda v: {"error": v["text"] == "Directory"})),
    ),
    ("text-characters", sends("text-directory", becomes(lambda v: {"text": v["text"] + "\0"}))),
    (
        "service-missing",
        sends("text-directory", becomes(lambda v: {"text": v["text"].replace("Battery", "Power")})),
    ),
    ("iocard-properties-length", sends_bytes("iocard-properties", lambda data: data[:-1])),
    ("iocard-counts", sends("iocard-properties", puts(analog_inputs=0x09000000))),
    ("iocard-text-silent", sends_bytes("text-iocard", lambda data: None)),
    ("telemeter-count", sends("telemeter-properties", puts(count=3))),
    ("telemeter-range", sends("telemeter-properties", swaps_ranges)),
    ("battery-values", sends("battery-properties", puts(minimum_percent=200))),
    ("battery-properties-refused", sends("battery-properties", puts(error=2))),
    ("localization-flags", sends("localization-properties", puts(flags=0x80))),
    ("differential-properties-length", sends_bytes("differential-properties", lambda d: d[:-4])),
    (
        "differential-limits",
        sends("differential-properties", swaps("max_linear_m_s", "min_linear_m_s")),
    ),
    ("differential-width", sends("differential-properties", puts(width_m=-0.68))),
    ("notification-list", sends("notification", puts(subscriptions=[]))),
    ("unknown-service", sends("error-answer", accepts(0, 1))),
    ("unknown-action", sends("error-answer", accepts(200, 2))),
    ("query-index", sends("error-answer", accepts(1, 5))),
    ("subscribe-directory", sends("error-answer", accepts(4, 5))),
    ("subscribe-answer", sends("insert-answer", puts(error=5))),
    ("status-missing", sends_bytes("battery-status", lambda data: None)),
    ("status-length", sends_bytes("iocard-status", lambda data: data[:-1])),
    ("status-service", sends("telemeter-status", puts(service=turn_bytes(IDS["telemeter"], 2)))),
    ("status-period", ignores("period")),
    ("status-clock", sends("status", becomes(lambda v: {"cycle": v["cycle"] * 10}))),
    ("status-clock-stands", sends("status", puts(cycle=7))),
    ("localization-status-not-finite", sends("localization-status", puts(x_m=math.nan))),
    ("battery-status-state", sends("battery-status", puts(state=7))),
    ("battery-status-percent", sends("battery-status", puts(remaining_percent=255))),
]
DRIVEN: list[tuple[str, Callable[[PlayedRobot], None]]] = [
    (
        "status-order",
        sends("differential-status", swaps("current_linear_m_s", "target_angular_rad_s")),
    ),
    ("command-target", ignores("command")),
    ("command-speed", sends("differential-status", puts(current_linear_m_s=0.0))),
    ("watchdog", ignores("watchdog")),
    ("replace-pose", ignores("replace")),
    ("replace-answer", sends("replace-answer", puts(error=2))),
]

# ------------------------------------------------------------------------------ clients

Telegrams = Callable[[str, Values, bytes], Iterable[bytes]]


class Client:
    """Does each thing once, as the manual has it; `change` gives what is sent instead."""

    def __init__(self, robot: PlayedRobot, change: Telegrams) -> None:
        self.change = change
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", robot.port))

    def send(self, name: str, **values: Any) -> None:
        for data in self.change(name, values, encode(name, **values)):
            self.socket.send(data)

    def heard(self, wanted: Callable[[bytes], bool], seconds: float = 5.0) -> bool:
        while select.select([self.socket], [], [], seconds)[0]:
            if wanted(self.socket.recv(2048)):
                return True
        return False

    def shows(self, data: bytes, stopped: bool) -> bool:
        if data[:3] != bytes([STATUS]) + IDS["differential"].to_bytes(2, "little"):
            return False
        return not stopped or decode("differential-status", data)["target_linear_m_s"] == 0

    def run(self, waits_for_watchdog: bool = False, repeats: int = 20) -> None:
        with self.socket:
            self.talk(waits_for_watchdog, repeats)

    def talk(self, waits_for_watchdog: bool, repeats: int) -> None:
        for _ in range(1 + repeats):
            self.send("get", target=0)
            if self.heard(lambda data: data[:4] == b"\1\0\0\0", 0.1):
                break
        else:
            return
        self.send("query-directory")
        for number in IDS.values():
            self.send("get", target=number)
        for name in ("query-analog-input", "query-digital-input", "query-digital-output"):
            self.send(name, target=IDS["iocard"])
        for name in ("battery", "differential"):
            self.send("insert", service=IDS[name])
        self.send("replace-localization", target=IDS["localization"])
        self.send("iocard-command", service=IDS["iocard"])
        for speed in (0.3, 0.3, 0.3, 0.0, 0.0):
            self.heard(lambda data: self.shows(data, False))
            if waits_for_watchdog:
                self.heard(lambda data: self.shows(data, True))
            self.send(
                "differential-command",
                service=IDS["differential"],
                linear_m_s=speed,
                angular_rad_s=0.0,
            )


def judge_client(run: Callable[[PlayedRobot], None], watchdog_s: float = 1.0) -> Report:
    with contextlib.closing(PlayedRobot(watchdog_s=watchdog_s)) as robot:
        judge = ClientJudge(robot)
        robot.start()
        run(robot)
    return judge.end()


def client(change: Telegrams, **how: Any) -> Callable[[PlayedRobot], None]:
    return lambda robot: Client(robot, change).run(**how)


def gives(
    telegram: str, edit: Callable[[bytes], bytes] = lambda data: data, times: int = 1, **others: Any
) -> Callable[[PlayedRobot], None]:
    """A client whose telegrams of this name have other values, or bytes, or come many times."""

    def change(name: str, values: Values, data: bytes) -> Iterable[bytes]:
        return [edit(encode(name, **{**values, **others}))] * times if name == telegram else [data]

    return client(change)


def floods(count: int) -> Callable[[PlayedRobot], None]:
    """A client that sends its first command this often: more could overflow a busy socket."""
    left = [count]

    def change(name: str, values: Values, data: bytes) -> Iterable[bytes]:
        return [data] * (left.pop() if name == "differential-command" and left else 1)

    return client(change)


def adds(*extra: bytes, before: str) -> Callable[[PlayedRobot], None]:
    """A client that sends this as well, before the first telegram of a name."""
    return client(lambda name, values, data: [*extra, data] if name == before else [data])


def leaves_out(telegram: str, **matching: Any) -> Callable[[PlayedRobot], None]:
    return client(
        lambda name, values, data: (
            [] if name == telegram and matching.items() <= values.items() else [data]
        )
    )


OWN = IDS["differential"]


def same(name: str, values: Values, data: bytes) -> Iterable[bytes]:
    return [data]


CLIENTS: list[tuple[str, Callable[[PlayedRobot], None]]] = [
    ("silent", lambda robot: None),
    ("gives-up", client(same, repeats=0)),
    ("telegram-length", adds(b"\1", before="insert")),
    ("request-header", gives("query-directory", id=0)),
    ("request-action", gives("query-directory", action=9)),
    ("byte-order", adds(encode("get", target=turn_bytes(OWN, 2)), before="insert")),
    ("unlisted-service", adds(encode("get", target=6), before="insert")),
    ("directory-unread", adds(encode("get", target=OWN), before="get")),
    ("get-length", adds(encode("get", target=OWN) + b"\0", before="insert")),
    ("query-length", gives("query-digital-input", edit=lambda data: data[:-2])),
    ("query-index", gives("query-digital-input", index=22)),
    ("query-type", gives("query-digital-input", type=4)),
    ("query-target", gives("query-digital-input", target=IDS["battery"])),
    ("insert-length", adds(encode("insert", service=OWN) + b"\0", before="insert")),
    ("insert-target", adds(encode("insert", target=OWN, service=OWN), before="insert")),
    ("insert-service", adds(encode("insert", service=0), before="insert")),
    ("insert-period", adds(encode("insert", service=OWN, period=0), before="insert")),
    ("insert-repeated", gives("insert", times=6)),
    ("replace-length", gives("replace-localization", edit=lambda data: data[:28])),
    ("replace-target", gives("replace-localization", target=IDS["battery"])),
    ("replace-not-finite", gives("replace-localization", x_m=math.inf)),
    ("properties-unread", leaves_out("get", target=OWN)),
    ("command-service", gives("iocard-command", service=IDS["battery"])),
    ("command-length", gives("differential-command", edit=lambda data: data + bytes(8))),
    (
        "command-not-finite",
        adds(
            encode("differential-command", service=OWN, linear_m_s=math.nan),
            before="differential-command",
        ),
    ),
    (
        "command-limits",
        adds(
            encode("differential-command", service=OWN, angular_rad_s=-1.5),
            before="differential-command",
        ),
    ),
    ("byte-order", gives("differential-command", edit=lambda d: d[:3] + d[6:2:-1] + d[:6:-1])),
    ("command-flood", floods(120)),
    ("command-gap", client(same, waits_for_watchdog=True)),
    ("output-watchdog", gives("iocard-command", digital=[1])),
    ("left-moving", leaves_out("differential-command", linear_m_s=0.0)),
]


def judge_simulator() -> list[Any]:
    with subprocess.Popen(
        [os.environ["ROBUROC4_SIM_PROGRAM"], "--port", "0"], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            port = int(process.stdout.readline().split()[3].rstrip(",").split(":")[1])
            return list(RobotJudge(("127.0.0.1", port)).judge(drive=True).faults)
        finally:
            process.terminate()


class Conformance(unittest.TestCase):
    def expect(
        self,
        seeded: list[tuple[str, Callable[..., None]]],
        judge: Callable[[Callable[..., None]], Report],
    ) -> None:
        with ThreadPoolExecutor(8) as pool:
            reports = list(pool.map(judge, [subject for _, subject in seeded]))
        found = {name: report.faults for (name, _), report in zip(seeded, reports, strict=True)}
        wrong = {name: faults for name, faults in found.items() if [name] != list(faults)}
        assert not wrong, wrong

    def test_telegrams_have_the_bytes_of_their_values(self) -> None:
        for name, entry in ENTRIES.items():
            with self.subTest(name):
                data = bytes.fromhex(entry["bytes"])
                assert data == encode(name)
                assert data == encode(name, **decode(name, data))

    @judged
    def test_a_right_robot_has_no_fault(self) -> None:
        assert not judge_robot(lambda robot: None, drive=True).faults

    @judged
    def test_each_wrong_robot_is_told_its_fault(self) -> None:
        self.expect(ROBOTS, lambda prepare: judge_robot(prepare, drive=False))
        self.expect(DRIVEN, lambda prepare: judge_robot(prepare, drive=True))

    @judged
    def test_a_right_client_has_no_fault(self) -> None:
        assert not judge_client(client(same)).faults

    @judged
    def test_each_wrong_client_is_told_its_fault(self) -> None:
        self.expect(
            CLIENTS,
            lambda run: judge_client(
                run, WATCHDOG_S if run is dict(CLIENTS)["command-gap"] else 1.0
            ),
        )

    @judged
    def test_the_simulator_conforms(self) -> None:
        faults = judge_simulator()
        assert not faults, faults

    @judged
    def test_the_library_conforms(self) -> None:
        ended: list[int] = []

        def drive(robot: PlayedRobot) -> None:
            program = os.environ["ROBUROC4_DRIVE_PROGRAM"]
            done = subprocess.run([program, f"127.0.0.1:{robot.port}"], check=False, timeout=60)
            ended.append(done.returncode)

        # On a busy machine the played robot is late, and the library rightly stops it.
        while 0 not in ended and len(ended) < 3:
            assert not judge_client(drive).faults
        assert 0 in ended


class Judged(unittest.TestCase):
    """Only a stall that was measured excuses a failure, and only a long one the last try's."""

    def judge(self, *stalls_ms: int) -> tuple[int, type[Exception] | None]:
        """How a test ends that fails on a machine that stalls so, and after how many tries."""
        tries = 0
        ended: type[Exception] | None = None

        def fails(test: unittest.TestCase) -> None:
            nonlocal tries
            tries += 1
            test.fail("a fault")

        watch = contextlib.nullcontext(stalls_ms)
        with (
            mock.patch("judged.watch_stalls", return_value=watch),
            contextlib.redirect_stdout(None),
        ):
            try:
                judged(fails)(self)
            except (AssertionError, unittest.SkipTest) as error:
                ended = type(error)
        return tries, ended

    def test_a_fault_on_a_machine_that_keeps_time_is_one_at_once(self) -> None:
        assert self.judge() == (1, AssertionError)

    def test_a_fault_after_short_stalls_is_one_in_the_last_try(self) -> None:
        assert self.judge(60, 199) == (3, AssertionError)

    def test_long_stalls_judge_nothing(self) -> None:
        assert self.judge(250) == (3, unittest.SkipTest)


if __name__ == "__main__":
    unittest.main()
