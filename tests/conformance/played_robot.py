# SPDX-License-Identifier: MIT
"""A robot by the manual, played over UDP, with ids and limits that are not the manual's."""

import select
import socket
import threading
import time
from collections.abc import Callable
from typing import Any

import telegrams
from telegrams import STATUS, LayoutError, Values, blocks, decode, encode

IDS = {"iocard": 21, "telemeter": 17, "battery": 33, "localization": 18, "differential": 300}
TYPES = {"iocard": 0x4001, "telemeter": 0x4008, "localization": 0x8002, "differential": 0x4005}
TEXTS = {"iocard": "IOCard"}
LIMITS = {"linear_m_s": (-0.4, 0.5), "angular_rad_s": (-1.0, 1.25)}
CYCLE_S = 0.01

STICKS = ("LJ left/right", "LJ down/up", "RJ left/right", "RJ down/up")
PAD = [f'Game pad "{name}"' for name in (*STICKS, "LT", "RT")]
ANALOG = ["Front telemeter voltage", "Rear telemeter voltage", "Battery voltage", *PAD]
BUTTONS = ["A", "B", "X", "Y", "Back", "Start", "D down", "D left", "D right", "D up"]
BUTTONS += ["LJ click", "RJ click", "LB", "RB"]
DIGITAL = ["Front bumper", "Rear bumper"] + ["not used"] * 6
DIGITAL += [f'Game pad "{name}" button' for name in BUTTONS]
OUTPUTS = ["Watchdog"] + ["not used"] * 7
CHANNELS = [ANALOG, [], DIGITAL, OUTPUTS]

# What a faulty robot sends in place of a telegram: its name, values and bytes are given.
Change = Callable[[str, Values, bytes], bytes | None]


class PlayedRobot:
    """Runs in a thread of its own between start() and close(). `heard` is given each datagram that
    comes in, `sent` the name and values of each that goes out."""

    def __init__(
        self,
        change: Change = lambda name, values, data: data,
        port: int = 0,
        host: str = "127.0.0.1",
        watchdog_s: float = 1.0,
    ) -> None:
        self.change: Change = change
        self.heard: Callable[[bytes], None] = lambda data: None
        self.sent: Callable[[str, Values], None] = lambda name, values: None
        self.tripped: Callable[[], None] = lambda: None
        self.watchdog_s = watchdog_s
        self.ignores: set[str] = set()  # "command", "replace", "watchdog", "period": faults
        self.answer_socket: socket.socket | None = None
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((host, port))
        self.port = self.socket.getsockname()[1]
        self.begun = time.monotonic()
        self.commanded = -1e9
        self.target = [0.0, 0.0]
        self.speed = [0.0, 0.0]
        self.pose = [0.0, 0.0, 0.0]
        self.cycle = 1000
        self.subscribed: dict[int, tuple[int, Any]] = {}  # service: period and who asked
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run)

    def start(self) -> None:
        self.thread.start()

    def close(self) -> None:
        self.ended.set()
        if self.thread.is_alive():
            self.thread.join()
        for used in {self.socket, self.answer_socket or self.socket}:
            used.close()

    def run(self) -> None:
        ended = False
        while not ended:
            ended = self.ended.is_set()  # what has arrived by then is still heard
            due = self.begun + (self.cycle - 999) * CYCLE_S
            while select.select([self.socket], [], [], max(0.0, due - time.monotonic()))[0]:
                data, sender = self.socket.recvfrom(2048)
                self.heard(data)
                self.receive(data, sender)
                if time.monotonic() >= due and not ended:
                    break
            self.step()

    def step(self) -> None:
        """One low-level cycle: they are all made, late ones too."""
        self.cycle += 1
        late = time.monotonic() - self.commanded > self.watchdog_s
        if late and "watchdog" not in self.ignores and any(self.target):
            self.target = [0.0, 0.0]
            self.tripped()
        for axis in range(2):
            self.speed[axis] += (self.target[axis] - self.speed[axis]) * 0.1
        self.pose[0] += self.speed[0] * CYCLE_S
        self.pose[2] += self.speed[1] * CYCLE_S
        for service, (period, peer) in list(self.subscribed.items()):
            if self.cycle % (2 * period if "period" in self.ignores else period) == 0:
                name = next(name for name, number in IDS.items() if number == service)
                self.send(
                    f"{name}-status",
                    peer,
                    header=STATUS,
                    service=service,
                    cycle=self.cycle,
                    **self.status(name),
                )

    def status(self, name: str) -> Values:
        if name == "iocard":
            return {"analog": [1.0, 1.0, 25.0] + [0.0] * 6, "digital": [0] * blocks(len(DIGITAL))}
        if name == "localization":
            return {"x_m": self.pose[0], "y_m": self.pose[1], "theta_rad": self.pose[2]}
        if name == "differential":
            names = (
                "target_linear_m_s",
                "current_linear_m_s",
                "target_angular_rad_s",
                "current_angular_rad_s",
            )
            return dict(
                zip(
                    names,
                    (self.target[0], self.speed[0], self.target[1], self.speed[1]),
                    strict=True,
                )
            )
        return {}

    def send(self, name: str, peer: Any, **values: Any) -> None:
        values = {**telegrams.ENTRIES[name]["values"], **values}
        data = self.change(name, values, encode(name, **values))
        if data is not None:
            other = self.answer_socket if values.get("header") != STATUS else None
            (other or self.socket).sendto(data, peer)
            self.sent(name, values)

    def receive(self, data: bytes, sender: Any) -> None:
        try:
            head = decode("get", data[:4])
            if head["id"] == STATUS:
                self.command(data)
            else:
                self.request(head, data, sender)
        except LayoutError:  # what is too short is not answered
            return

    def command(self, data: bytes) -> None:
        if int.from_bytes(data[1:3], "little") == IDS["differential"] and len(data) == 11:
            values = decode("differential-command", data)
            self.commanded = time.monotonic()
            if "command" not in self.ignores:
                self.target = [
                    min(max(values[name], low), high) for name, (low, high) in LIMITS.items()
                ]

    def request(self, head: Values, data: bytes, sender: Any) -> None:
        def answer(name: str, **values: Any) -> None:
            self.send(name, sender, **{**head, "error": 0, **values})

        action, target = head["action"], head["target"]
        service = next((name for name, number in IDS.items() if number == target), "")
        if target not in (0, 1, *IDS.values()):
            answer("error-answer", error=1)
        elif action == telegrams.GET and service:
            answer(f"{service}-properties", **self.properties(service))
        elif action == telegrams.GET and target == 0:
            listed = [(0, 0), (0, 1)] + [(TYPES.get(name, 0), IDS[name]) for name in IDS]
            answer("directory", services=[{"type": kind, "id": number} for kind, number in listed])
        elif action == telegrams.GET:
            answer(
                "notification",
                subscriptions=[
                    {"service": number, "period": period}
                    for number, (period, _) in self.subscribed.items()
                ],
            )
        elif action == telegrams.QUERY and target == 0:
            texts = ["Directory", "Notification"]
            texts += [TEXTS.get(name, name.capitalize()) for name in IDS]
            self.text(answer, "text-directory", texts, decode("query-directory", data)["index"])
        elif action == telegrams.QUERY and service == "iocard":
            query = decode("query-digital-input", data)
            texts = CHANNELS[query["type"]] if query["type"] < 4 else []
            self.text(answer, "text-iocard", texts, query["index"])
        elif action == telegrams.INSERT and target == 1:
            insert = decode("insert", data)
            known = insert["service"] in IDS.values() and insert["period"] > 0
            if known:
                self.subscribed[insert["service"]] = (insert["period"], sender)
            answer("insert-answer" if known else "error-answer", error=0 if known else 5)
        elif action == telegrams.REPLACE and service == "localization":
            pose = decode("replace-localization", data)
            if "replace" not in self.ignores:
                self.pose = [pose["x_m"], pose["y_m"], pose["theta_rad"]]
            answer("replace-answer")
        else:
            answer("error-answer", error=2)

    def text(self, answer: Callable[..., None], name: str, texts: list[str], index: int) -> None:
        if 0 <= index < len(texts):
            answer(name, text=texts[index])
        else:
            answer("error-answer", error=5)

    def properties(self, service: str) -> Values:
        if service != "differential":
            return {}
        (low, high), (turn_low, turn_high) = LIMITS.values()
        return {
            "target_linear_m_s": self.target[0],
            "target_angular_rad_s": self.target[1],
            "current_linear_m_s": self.speed[0],
            "current_angular_rad_s": self.speed[1],
            "max_linear_m_s": high,
            "min_linear_m_s": low,
            "max_angular_rad_s": turn_high,
            "min_angular_rad_s": turn_low,
        }
