#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Judges a robot or a simulator by the manual: names each fault that it finds."""

import argparse
import itertools
import math
import select
import socket
import statistics
import sys
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from telegrams import SERVICES, STATUS, LayoutError, Report, Values, blocks, decode, encode

PERIOD = 5  # cycles
COUNT = 10  # statuses of each service that are judged
CYCLE_S = 0.01
SECTIONS = {
    "iocard": "4.2.2.4",
    "telemeter": "4.2.2.5",
    "battery": "4.2.2.6",
    "localization": "4.2.2.7",
    "differential": "4.2.2.8",
}
STATUS_SECTIONS = {
    "iocard": "4.2.4.4",
    "telemeter": "4.2.4.5",
    "battery": "4.2.4.6",
    "localization": "4.2.4.7",
    "differential": "4.2.4.8",
}
TARGETS = {"target_linear_m_s": 0.2, "target_angular_rad_s": -0.3}


class RobotJudge:
    def __init__(
        self, address: tuple[str, int], watchdog_s: float = 1.0, patience_s: float = 1.0
    ) -> None:
        self.address = (socket.gethostbyname(address[0]), address[1])
        self.watchdog_s, self.patience_s = watchdog_s, patience_s
        self.report = Report()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("", 0))
        self.id = 0
        self.asked: deque[int] = deque(maxlen=100)
        self.ids: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        self.statuses: dict[str, list[tuple[float, Values]]] = {name: [] for name in SERVICES}

    # ----------------------------------------------------------------------------- the wire

    def hear(self, until: float) -> tuple[bytes, Any] | None:
        """The next datagram that is no status; statuses are kept."""
        while select.select([self.socket], [], [], max(0.0, until - time.monotonic()))[0]:
            data, sender = self.socket.recvfrom(65536)
            if data[:1] != bytes([STATUS]):
                return data, sender
            self.keep_status(data)
        return None

    def keep_status(self, data: bytes) -> None:
        service = int.from_bytes(data[1:3], "little")
        name = next((name for name, number in self.ids.items() if number == service), None)
        if name is None:
            self.report.fault("status-service", "4.2.4", f"service {service} is unknown", data)
            return
        try:
            values = decode(f"{name}-status", data, **self.counts)
        except LayoutError as error:
            self.report.fault("status-length", STATUS_SECTIONS[name], f"{name}: {error}", data)
            return
        self.statuses[name].append((time.monotonic(), values))

    def ask(self, telegram: str, **values: Any) -> bytes | None:
        """The answer to a request, repeated twice; None where there is none."""
        for _ in range(3):
            self.asked.append(self.id)
            self.id = self.id % 254 + 1
            request = encode(telegram, id=self.id, **values)
            self.socket.sendto(request, self.address)
            until = time.monotonic() + self.patience_s
            while (heard := self.hear(until)) is not None:
                data, sender = heard
                if data[:1] and data[0] > 1 and data[0] in self.asked:
                    continue  # a late answer to an earlier request
                self.judge_head(request, data, sender)
                return data if len(data) >= 5 else None
        return None

    def judge_head(self, request: bytes, data: bytes, sender: Any) -> None:
        fault = self.report.fault
        if len(data) < 5:
            fault("answer-length", "4.2.2.2", "shorter than its head", data)
        if sender != self.address:
            fault("answer-source", "4.2.1", f"it comes from {sender[0]}:{sender[1]}", data)
        if data[0] not in (request[0], 1, 0):
            fault("answer-id", "4.2.2.2", f"0x{request[0]:02X} was asked", data)
        if data[1] != request[1]:
            fault("answer-action", "4.2.2.2", f"action {request[1]} was asked", data)
        if data[2:4] != request[2:4]:
            fault("answer-target", "4.2.2.2", "another service was asked", data)

    @staticmethod
    def refused(data: bytes) -> bool:
        return data[0] == 0 or data[4:5] != b"\0"

    def properties(self, name: str, section: str, target: int) -> Values | None:
        data = self.ask("get", target=target)
        if data is None:
            if "answer-length" not in self.report.faults:
                self.report.fault(f"{name}-silent", section, "GET was not answered")
        elif self.refused(data):
            self.report.fault(f"{name}-refused", section, "GET was refused", data)
        else:
            try:
                return decode(name, data)
            except LayoutError as error:
                self.report.fault(f"{name}-length", section, str(error), data)
        return None

    # ------------------------------------------------------------------------- what is judged

    def judge(self, drive: bool) -> Report:
        if self.directory():
            for name in self.ids:
                self.judge_properties(name)
            self.judge_refusals()
            self.judge_texts()
            self.judge_statuses()
            if drive and "differential" in self.ids:
                self.judge_command()
            if drive and "localization" in self.ids:
                self.judge_replace()
        self.socket.close()
        return self.report

    def directory(self) -> bool:
        listed = self.properties("directory", "4.2.2.2", 0)
        if listed is None:
            return False
        numbers = [service["id"] for service in listed["services"]]
        if numbers[:1] != [0]:
            self.report.fault("directory-first", "4.2.1", f"the first service is {numbers[:1]}")
        if not {0, 1} <= set(numbers) or len(set(numbers)) != len(numbers):
            self.report.fault("directory-ids", "4.2.1", f"0 and 1, each once: {numbers}")
        for index, number in enumerate(numbers):
            data = self.ask("query-directory", index=index)
            if data is None or self.refused(data):
                self.report.fault("text-missing", "4.2.3.1", f"of element {index}", data or b"")
                continue
            text = data[5:].decode("latin-1")
            self.judge_text(text, data)
            self.ids.update(
                {
                    name: number
                    for name in SERVICES
                    if text.lower().replace(" ", "").startswith(name[:6])
                }
            )
        for name, number in SERVICES.items():  # what no text names has the manual's id, if any
            if name not in self.ids and number in numbers and number not in self.ids.values():
                self.ids[name] = number
            if name not in self.ids:
                self.report.fault("service-missing", "4.2.1", name)
        return True

    def judge_text(self, text: str, data: bytes) -> None:
        if any(ord(c) < 32 for c in text):
            self.report.fault("text-characters", "4.2.3.1", "a text has only its characters", data)

    def judge_properties(self, name: str) -> None:
        values = self.properties(f"{name}-properties", SECTIONS[name], self.ids[name])
        if values is None:
            return
        wrong = ""
        if name == "iocard":
            counts = [values[key] for key in list(values)[4:]]
            wrong = "" if all(0 <= count < 4096 for count in counts) else "counts"
            if not wrong:
                self.counts.update(analog=counts[0], digital=blocks(counts[2]))
        elif name == "telemeter":
            sensors = values["telemeters"]
            self.counts["distances_m"] = len(sensors)
            if values["count"] != len(sensors):
                wrong = "count"
            elif not all(
                0 <= s["min_m"] < s["max_m"] and s["field_of_view_rad"] > 0 for s in sensors
            ):
                wrong = "range"
        elif name == "battery":
            wrong = "" if values["minimum_percent"] <= 100 and values["nominal_v"] > 0 else "values"
        elif name == "localization":
            wrong = self.wrong_pose(values)
        elif not all(
            values[f"min_{axis}"] <= 0 <= values[f"max_{axis}"]
            for axis in ("linear_m_s", "angular_rad_s", "linear_m_s2", "angular_rad_s2")
        ):
            wrong = "limits"
        elif not 0 < values["width_m"] < 10:
            wrong = "width"
        if wrong:
            self.report.fault(f"{name}-{wrong}", SECTIONS[name], f"{values}")

    @staticmethod
    def wrong_pose(values: Values) -> str:
        numbers = (values["x_m"], values["y_m"], values["theta_rad"])
        if not all(map(math.isfinite, numbers)):
            return "not-finite"
        return "flags" if values["flags"] >= 1 << 7 else ""

    def judge_refusals(self) -> None:
        unknown = next(n for n in range(200, 300) if n not in self.ids.values())
        insert = {"service": 0, "period": PERIOD}
        for fault, section, telegram, values in (
            ("unknown-service", "4.2.2.2", "get", {"target": unknown}),
            ("unknown-action", "4.2.2.2", "get", {"action": 200, "target": 0}),
            ("query-index", "4.2.3.1", "query-directory", {"index": 1000}),
            ("subscribe-directory", "4.2.4.2", "insert", insert),
        ):
            data = self.ask(telegram, **values)
            if data is not None and not self.refused(data):
                self.report.fault(fault, section, f"no error answers {telegram} {values}", data)

    def judge_texts(self) -> None:
        for kind, count in ((0, self.counts.get("analog", 0)), (2, 2)):
            for index in range(count if "analog" in self.counts else 0):
                data = self.ask(
                    "query-digital-input", target=self.ids["iocard"], type=kind, index=index
                )
                if data is None:
                    self.report.fault("iocard-text-silent", "4.2.3.3", f"type {kind} {index}")
                    return
                self.judge_text(data[5:].decode("latin-1"), data)

    def judge_statuses(self) -> None:
        for name, number in self.ids.items():
            data = self.ask("insert", target=1, service=number, period=PERIOD)
            if data is None or self.refused(data):
                self.report.fault("subscribe-answer", "4.2.4.1", f"of {name}", data or b"")
        self.wait(
            lambda: all(len(kept) >= COUNT for kept in self.statuses.values()), 3 * self.patience_s
        )
        listed = self.properties("notification", "4.2.2.3", 1)
        wanted = {(number, PERIOD) for number in self.ids.values()}
        if listed is not None and not wanted <= {
            (s["service"], s["period"]) for s in listed["subscriptions"]
        }:
            self.report.fault("notification-list", "4.2.2.3", f"{listed['subscriptions']}")
        for name in self.ids:
            if self.statuses[name]:
                self.judge_times(name, STATUS_SECTIONS[name])
                self.judge_values(name, self.statuses[name][-1][1], STATUS_SECTIONS[name])
            elif not {"status-length", "status-service"} & self.report.faults.keys():
                self.report.fault("status-missing", STATUS_SECTIONS[name], f"none of {name}")

    def judge_times(self, name: str, section: str) -> None:
        times = [time_s for time_s, _ in self.statuses[name]]
        cycles = [values["cycle"] for _, values in self.statuses[name]]
        steps = [b - a for a, b in itertools.pairwise(cycles)]
        if not steps:
            return
        host_s, robot_s = times[-1] - times[0], (cycles[-1] - cycles[0]) * CYCLE_S
        if statistics.median(steps) <= 0:
            self.report.fault("status-clock-stands", section, f"{name}: cycles {cycles[:4]}")
        elif robot_s > 3 * host_s + 0.5 or host_s > 3 * robot_s + 0.5:
            self.report.fault(
                "status-clock", section, f"{name}: {robot_s:.2f} s of cycles in {host_s:.2f} s"
            )
        elif abs(statistics.median(steps) - PERIOD) > 1:
            self.report.fault(
                "status-period", "4.2.4.1", f"{name}: {PERIOD} cycles were asked, {steps[:4]} came"
            )

    def judge_values(self, name: str, values: Values, section: str) -> None:
        wrong = ""
        if name == "battery":
            wrong = "state" if values["state"] > 3 else ""
            wrong = "percent" if values["remaining_percent"] > 100 else wrong
        elif name == "localization":
            wrong = self.wrong_pose(values)
        elif name != "iocard":
            numbers = values["distances_m"] if name == "telemeter" else list(values.values())[3:]
            wrong = "" if all(map(math.isfinite, numbers)) else "not-finite"
        if wrong:
            self.report.fault(f"{name}-status-{wrong}", section, f"{values}")

    # ------------------------------------------------------------------ what moves the robot

    def wait(
        self,
        condition: Callable[[], bool],
        seconds: float,
        every: Callable[[], None] = lambda: None,
    ) -> bool:
        until = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > until:
                return False
            every()
            self.hear(time.monotonic() + 0.05)
        return True

    def last(self, name: str) -> Values:
        return self.statuses[name][-1][1] if self.statuses[name] else {}

    def shows(self, telegram: str, targets: list[float]) -> bool:
        """Whether the last status, read as the fields of `telegram`, has these targets."""
        last = self.last("differential")
        names = ["target_linear_m_s", "target_angular_rad_s"]
        if telegram != "differential-status":  # in the order of the properties
            names = ["target_linear_m_s", "current_linear_m_s"]
        return bool(last) and all(
            abs(last[name] - target) < 0.01 for name, target in zip(names, targets, strict=True)
        )

    def judge_command(self) -> None:
        targets = list(TARGETS.values())
        command = encode(
            "differential-command",
            service=self.ids["differential"],
            linear_m_s=targets[0],
            angular_rad_s=targets[1],
        )

        def send() -> None:
            self.socket.sendto(command, self.address)

        if not self.wait(lambda: self.shows("differential-status", targets), self.patience_s, send):
            last = self.last("differential")
            if self.shows("differential-properties", targets):
                self.report.fault("status-order", "4.2.4.8", f"it is TLS, CLS, TAS, CAS: {last}")
            else:
                self.report.fault("command-target", "4.2.5.6", f"{targets} shows as {last}")
            return
        if not self.wait(
            lambda: (
                self.last("differential")["current_linear_m_s"] > 0.1
                and self.last("differential")["current_angular_rad_s"] < -0.1
            ),
            3 * self.patience_s,
            send,
        ):
            self.report.fault("command-speed", "4.2.5.6", f"{self.last('differential')}")
        # Nothing more is sent: the watchdog ends it.
        if not self.wait(
            lambda: self.shows("differential-status", [0.0, 0.0]), 1.5 * self.watchdog_s + 1.0
        ):
            self.report.fault(
                "watchdog", "4.2.5.6", f"it drives on without commands: {self.last('differential')}"
            )
            self.socket.sendto(
                encode(
                    "differential-command",
                    service=self.ids["differential"],
                    linear_m_s=0.0,
                    angular_rad_s=0.0,
                ),
                self.address,
            )

    def judge_replace(self) -> None:
        before = self.last("localization")
        if not before:
            return
        pose = {
            "x_m": before["x_m"] + 10,
            "y_m": before["y_m"] - 5,
            "theta_rad": before["theta_rad"] + 0.5,
        }

        def replace(to: Values) -> bool:
            data = self.ask(
                "replace-localization",
                target=self.ids["localization"],
                cycle=before["cycle"],
                **to,
            )
            if data is None or self.refused(data):
                self.report.fault("replace-answer", "4.2.6.5", "no answer, or refused", data or b"")
                return False
            return True

        if replace(pose):
            if not self.wait(
                lambda: all(
                    abs(self.last("localization")[key] - value) < 0.5 for key, value in pose.items()
                ),
                self.patience_s,
            ):
                self.report.fault(
                    "replace-pose",
                    "4.2.6.5",
                    f"{pose} was sent, it is at {self.last('localization')}",
                )
            replace({key: before[key] for key in pose})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("host", help="the robot's address")
    parser.add_argument("port", type=int, nargs="?", default=60000)
    parser.add_argument(
        "--drive",
        action="store_true",
        help="also commands 0.2 m/s and -0.3 rad/s, waits for the watchdog and "
        "replaces the pose: the wheels must be off the ground",
    )
    parser.add_argument("--watchdog", type=float, default=1.0, help="the robot's, in seconds")
    options = parser.parse_args()
    judge = RobotJudge((options.host, options.port), options.watchdog)
    return judge.judge(options.drive).print("robot")


if __name__ == "__main__":
    sys.exit(main())
