#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plays a robot and judges what a client sends to it by the manual: names each fault."""

import argparse
import contextlib
import math
import struct
import subprocess
import sys
import time

import telegrams
from played_robot import CHANNELS, IDS, LIMITS, PlayedRobot
from telegrams import STATUS, LayoutError, Report, Values, blocks, decode

FLOOD = 100  # commands
FLOOD_S = 0.5  # half the time of as many cycles of 10 ms
REPEATS = 5  # subscriptions of one service that are not yet a fault
NAMES = {number: name for name, number in IDS.items()}


def sane(value: float) -> bool:
    return value == 0 or (math.isfinite(value) and abs(value) > 1e-6)


class ClientJudge:
    """Hears a PlayedRobot. The answer to the first GET of the directory is lost on purpose."""

    def __init__(self, robot: PlayedRobot) -> None:
        self.robot = robot
        self.report = Report()
        self.properties: set[int] = set()  # services whose properties the client was sent
        self.inserted: dict[int, int] = {}
        self.commands: list[tuple[float, tuple[float, float]]] = []
        self.asked_directory = 0
        self.tripped = False
        self.change = robot.change
        robot.change, robot.heard, robot.sent = self.lose, self.hear, self.answered
        robot.tripped = self.trip

    def trip(self) -> None:
        self.tripped = True

    def lose(self, name: str, values: Values, data: bytes) -> bytes | None:
        if name == "directory" and self.asked_directory == 1:
            return None
        return self.change(name, values, data)

    def answered(self, name: str, values: Values) -> None:
        if name.endswith("-properties") or (name == "directory" and self.asked_directory > 1):
            self.properties.add(values["target"])

    def hear(self, data: bytes) -> None:
        fault = self.report.fault
        if len(data) < 3:
            fault("telegram-length", "4.2.2.1", "shorter than any telegram", data)
        elif data[0] == STATUS:
            self.command(int.from_bytes(data[1:3], "little"), data)
        elif len(data) < 4:
            fault("telegram-length", "4.2.2.1", "shorter than any request", data)
        else:
            self.request(decode("get", data[:4]), data)

    # ------------------------------------------------------------------------------ requests

    def request(self, head: Values, data: bytes) -> None:
        fault = self.report.fault
        action, target = head["action"], head["target"]
        if head["id"] == 0:
            fault("request-header", "4.2.2.1", "0x00 heads errors", data)
        if target not in (0, 1, *NAMES):
            swapped = int.from_bytes(data[2:4], "big") in (1, *NAMES)
            fault(
                "byte-order" if swapped else "unlisted-service",
                "4.2.1",
                f"the directory has no service {target}",
                data,
            )
            return
        if target in NAMES and 0 not in self.properties:
            fault("directory-unread", "4.2.1", "the ids are those that the directory gives", data)
        actions = (telegrams.GET, telegrams.QUERY, telegrams.REPLACE, telegrams.INSERT)
        judges = dict(zip(actions, (self.get, self.query, self.replace, self.insert), strict=True))
        if action in judges:
            judges[action](target, data)
        elif action > 6:  # 3, 5 and 6 are known from drivers
            fault("request-action", "4.2.2.1", f"action {action}", data)

    def read(self, telegram: str, section: str, data: bytes) -> Values | None:
        try:
            return decode(telegram, data)
        except LayoutError as error:
            self.report.fault(f"{telegram.split('-')[0]}-length", section, str(error), data)
            return None

    def get(self, target: int, data: bytes) -> None:
        self.asked_directory += target == 0
        self.read("get", "4.2.2.1", data)

    def query(self, target: int, data: bytes) -> None:
        fault = self.report.fault
        if target == 0:
            values = self.read("query-directory", "4.2.3.1", data)
            if values and values["index"] >= 2 + len(IDS):
                fault("query-index", "4.2.3.1", f"element {values['index']}", data)
        elif target == IDS["iocard"]:
            values = self.read("query-digital-input", "4.2.3.3", data)
            if values and values["type"] > 3:
                fault("query-type", "4.2.3.3", f"type {values['type']}", data)
            elif values and not 0 <= values["index"] < len(CHANNELS[values["type"]]):
                fault("query-index", "4.2.3.3", f"channel {values['index']}", data)
        else:
            fault("query-target", "4.2.3", "only directory and IO card have texts", data)

    def insert(self, target: int, data: bytes) -> None:
        fault = self.report.fault
        if target != 1:
            fault("insert-target", "4.2.4.1", "it is for the notification service", data)
        values = self.read("insert", "4.2.4.1", data)
        if values is None:
            return
        service = values["service"]
        if service not in NAMES:
            fault("insert-service", "4.2.4.2", f"service {service} has no status", data)
        if values["period"] == 0:
            fault("insert-period", "4.2.4.1", "a period of 0 cycles", data)
        self.inserted[service] = self.inserted.get(service, 0) + 1
        if self.inserted[service] > REPEATS:
            fault("insert-repeated", "4.2.4", "only one time at the startup", data)

    def replace(self, target: int, data: bytes) -> None:
        if target != IDS["localization"]:
            self.report.fault("replace-target", "4.2.6", "only localization is replaced", data)
            return
        values = self.read("replace-localization", "4.2.6.5", data)
        if values and not all(math.isfinite(values[key]) for key in ("x_m", "y_m", "theta_rad")):
            self.report.fault("replace-not-finite", "4.2.6.5", "a pose has numbers", data)

    # ------------------------------------------------------------------------------ commands

    def command(self, service: int, data: bytes) -> None:
        fault = self.report.fault
        if service not in NAMES or NAMES[service] not in ("iocard", "differential"):
            fault("command-service", "4.2.5", f"service {service} has no command", data)
            return
        if service not in self.properties:
            fault("properties-unread", "4.2.5", "properties are read before a command", data)
        if NAMES[service] == "iocard":
            try:
                values = decode("iocard-command", data, digital=blocks(len(CHANNELS[3])))
            except LayoutError as error:
                fault("command-length", "4.2.5.2", str(error), data)
                return
            if values["digital"][0] & 1:
                fault("output-watchdog", "5.5.1", "output 0 is the robot's own", data)
            return
        try:
            values = decode("differential-command", data)
        except LayoutError as error:
            fault("command-length", "4.2.5.6", str(error), data)
            return
        self.drive((values["linear_m_s"], values["angular_rad_s"]), data)

    def drive(self, speeds: tuple[float, float], data: bytes) -> None:
        fault = self.report.fault
        if not all(map(math.isfinite, speeds)):
            fault("command-not-finite", "4.2.5.6", f"{speeds}", data)
        elif not all(map(sane, speeds)) and all(map(sane, struct.unpack(">2f", data[3:]))):
            fault("byte-order", "4.2.1", f"the lower byte is sent first: {speeds}", data)
        elif not all(
            low * 1.00001 <= speed <= high * 1.00001
            for speed, (low, high) in zip(speeds, LIMITS.values(), strict=True)
        ):
            fault("command-limits", "4.2.2.8", f"{speeds} is beyond {LIMITS}", data)
        if self.tripped and any(speeds):
            fault("command-gap", "4.2.5.6", "the watchdog stopped it while it was driven", data)
        self.commands.append((time.monotonic(), speeds))
        if len(self.commands) > FLOOD and (
            self.commands[-1][0] - self.commands[-FLOOD][0] < FLOOD_S
        ):
            fault("command-flood", "4.2.5.6", f"{FLOOD} commands within {FLOOD_S} s", data)

    def end(self) -> Report:
        """To be called when the robot has ended."""
        fault = self.report.fault
        if not self.asked_directory:
            fault("silent", "4.2.1", "it never asked for the directory")
        elif self.asked_directory == 1:
            fault("gives-up", "4.2.2.1", "the answer to its first request was lost: no other came")
        if self.commands and any(self.commands[-1][1]):
            fault("left-moving", "4.2.5.6", f"its last command was {self.commands[-1][1]}")
        return self.report


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, epilog="example: judge_client.py -- my_client {address}"
    )
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on")
    parser.add_argument("--port", type=int, default=0, help="0, the default, picks a free one")
    parser.add_argument(
        "program",
        nargs="*",
        help="the client to run, with {address}, {host} and {port} replaced; "
        "without it, any client until Ctrl+C",
    )
    options = parser.parse_args()
    with contextlib.closing(PlayedRobot(port=options.port, host=options.host)) as robot:
        judge = ClientJudge(robot)
        robot.start()
        names = {
            "host": options.host,
            "port": robot.port,
            "address": f"{options.host}:{robot.port}",
        }
        print(f"a robot is played at {names['address']}", flush=True)
        try:
            if options.program:
                subprocess.run([word.format(**names) for word in options.program], check=False)
            else:
                robot.thread.join()
        except KeyboardInterrupt:
            pass
    return judge.end().print("client")


if __name__ == "__main__":
    sys.exit(main())
