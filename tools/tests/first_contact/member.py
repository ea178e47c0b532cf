# SPDX-License-Identifier: MIT
"""A drawn robot in virtual time, the network to it, and a person who does what is asked."""

import ctypes
import heapq
import math
import random
import struct
from collections.abc import Callable
from pathlib import Path

from roburoc4_tools.first_contact.world import Datagram, World

_POWER, _MOTORS, _ESTOP, _BRAKES, _FRONT, _REAR, _PAD = 0, 1, 3, 4, 7, 8, 10
_PAD_A, _RIGHT_TRIGGER = 108, 208
# In the order in which the page asks for them.
_STICKS = (
    *((204, 1.0), (204, -1.0), (203, -1.0), (203, 1.0)),
    *((206, 1.0), (206, -1.0), (205, -1.0), (205, 1.0)),
    *((207, 1.0), (208, 1.0)),
)
_BUTTONS = range(109, 122)
_CONFIG_BYTES = 1024
_FILE_BYTES, _TEXT_BYTES = 528, 6144
_STATE_BYTES, _WHEELS_AT = 104, 88


class Setting(ctypes.Structure):
    """A row of the simulator's table of settings."""

    _fields_ = [("name", ctypes.c_char_p), ("offset", ctypes.c_size_t)]


class Library:
    """The simulator, as a shared library with all of its symbols."""

    def __init__(self, path: Path) -> None:
        self.c = ctypes.CDLL(str(path))
        self.c.roburoc4_sim_create.restype = ctypes.c_void_p
        self.c.roburoc4_sim_next_deadline.restype = ctypes.c_uint64
        self.c.sim_setting_at.restype = ctypes.POINTER(Setting)
        self.c.sim_setting_get.restype = ctypes.c_double
        self.c.sim_battery_voltage.restype = ctypes.c_float
        self.c.roburoc4_sim_set.argtypes = (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_double)
        self.c.sim_config_set.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double)

    def member(self, seed: int, **changes: float) -> tuple[ctypes.Array, dict[str, float]]:
        """Draw a robot; return its configuration, and the same by name."""
        config = self.usual()
        size = next(n for n in range(8, _CONFIG_BYTES, 8) if self._fits(config, n))
        self.c.roburoc4_sim_config_family(config, ctypes.c_size_t(size), ctypes.c_uint64(seed))
        for name, value in changes.items():
            assert self.c.sim_config_set(config, name.encode(), value) == 0, name
        return config, self.settings(config)

    def usual(self) -> ctypes.Array:
        """Return the configuration of a simulator without options."""
        config = ctypes.create_string_buffer(_CONFIG_BYTES)
        size = next(n for n in range(8, _CONFIG_BYTES, 8) if self._fits(config, n))
        self.c.roburoc4_sim_config_init(config, ctypes.c_size_t(size))
        return config

    def _fits(self, config: ctypes.Array, size: int) -> bool:
        ok = self.c.roburoc4_sim_config_init(config, ctypes.c_size_t(size)) == 0
        larger = self.c.roburoc4_sim_config_init(config, ctypes.c_size_t(size + 8)) == 0
        return ok and not larger

    def of_robot_file(self, known: dict[str, float]) -> dict[str, float]:
        """Return the settings of a simulator with the robot file of what is known."""
        file = ctypes.create_string_buffer(_FILE_BYTES)
        for name, value in known.items():
            result = self.c.roburoc4_robot_file_set(file, name.encode(), ctypes.c_float(value))
            assert result == 0, f"{name} = {value}"
        text = ctypes.create_string_buffer(_TEXT_BYTES)
        length = self.c.roburoc4_robot_file_write(file, text, ctypes.c_size_t(_TEXT_BYTES))
        remedy = ctypes.c_char_p()
        line, size = ctypes.c_uint32(), ctypes.c_size_t(length)
        result = self.c.roburoc4_robot_file_read(
            file, text, size, ctypes.byref(line), ctypes.byref(remedy)
        )
        assert result == 0, f"line {line.value}: {remedy.value!r}"
        config = self.usual()
        self.c.roburoc4_sim_config_robot_file(config, file)
        return self.settings(config)

    def settings(self, config: ctypes.Array) -> dict[str, float]:
        found: dict[str, float] = {}
        index = 0
        while row := self.c.sim_setting_at(ctypes.c_uint32(index)):
            found[row.contents.name.decode()] = self.c.sim_setting_get(config, row)
            index += 1
        return found


class VirtualWorld(World):
    """A member of the family, and people who do what they are asked, within a tenth of a second."""

    def __init__(self, library: Library, config: ctypes.Array, other_port: bool) -> None:
        self._c = library.c
        self._sim = ctypes.c_void_p(self._c.roburoc4_sim_create(config))
        assert self._sim
        self._us = 1_000_000
        self._drawn = library.settings(config)
        self._other_port = other_port
        self._closed: set[int] = set()
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._people = random.Random(1)
        self._buffer = ctypes.create_string_buffer(512)
        self._early: list[Datagram] = []
        self.unplugged = False
        self.loses = 0.0
        """Which share of the datagrams that are sent to the robot is lost."""
        self.loses_statuses = False
        """A firewall lets answers pass, and nothing else."""
        self.misses: dict[str, int] = {}
        """How often nothing is done at the end of which countdown."""
        self.other_sender: tuple[float, float] | None = None
        self.asked: list[str] = []
        self.said: list[tuple[float, float, str]] = []
        """From when until when people read what, and did it."""
        self.holds = True
        self.fastest = 0.0
        self.let_go_at_s = math.inf
        self.let_go: list[tuple[float, float]] = []
        """From when until when the key was not held."""
        self.waits = 0
        self.interrupt_at_wait = -1
        self._c.roburoc4_sim_advance(self._sim, ctypes.c_uint64(self._us))

    def __del__(self) -> None:
        self._c.roburoc4_sim_destroy(self._sim)

    @property
    def now_s(self) -> float:
        return self._us / 1e6

    def send(self, port: int, data: bytes) -> None:
        self._closed.discard(port)
        if self.other_sender:
            other = struct.pack(
                "<BH2f", 0xFF, int(self._drawn["differential_id"]), *self.other_sender
            )
            self._c.roburoc4_sim_receive(self._sim, ctypes.c_uint64(99), other, ctypes.c_size_t(11))
        lost = self.loses and self._people.random() < self.loses
        if not self.unplugged and not lost:
            self._c.roburoc4_sim_receive(
                self._sim, ctypes.c_uint64(port + 1), data, ctypes.c_size_t(len(data))
            )

    def wait(self, seconds: float) -> list[Datagram]:
        self.waits += 1
        if self.waits == self.interrupt_at_wait:
            raise KeyboardInterrupt
        heard, self._early = self._early, []
        self._pass(seconds, heard)
        return heard

    def _pass(self, seconds: float, heard: list[Datagram]) -> None:
        end_us = self._us + max(1, round(seconds * 1e6))
        while self._us < end_us:
            due_us = self._c.roburoc4_sim_next_deadline(self._sim)
            event_us = self._events[0][0] if self._events else end_us
            self._us = min(end_us, max(self._us + 1, min(due_us, event_us)))
            while self._events and self._events[0][0] <= self._us:
                heapq.heappop(self._events)[2]()
            self._c.roburoc4_sim_advance(self._sim, ctypes.c_uint64(self._us))
            self._take(heard)
        self._watch()

    def _watch(self) -> None:
        """Read the wheels' true speeds, behind the robot's back."""
        state = ctypes.create_string_buffer(struct.pack("<I", _STATE_BYTES), _STATE_BYTES)
        assert self._c.roburoc4_sim_get_state(self._sim, state) == 0
        speeds = struct.unpack_from("<2d", state, _WHEELS_AT)
        self.fastest = max(self.fastest, *map(abs, speeds))

    def _take(self, heard: list[Datagram]) -> None:
        peer = ctypes.c_uint64()
        while (
            size := self._c.roburoc4_sim_poll_transmit(
                self._sim, ctypes.byref(peer), self._buffer, ctypes.c_size_t(512)
            )
        ) > 0:
            port, data = peer.value - 1, self._buffer.raw[:size]
            if self.unplugged or (self.loses_statuses and data[:1] == b"\xff"):
                continue
            if port in self._closed:
                self._c.roburoc4_sim_receive(self._sim, peer, None, ctypes.c_size_t(0))
            else:
                other = self._other_port and data[:1] == b"\xff"
                heard.append(Datagram(self.now_s, port, data, other))

    def close(self, port: int) -> None:
        self._closed.add(port)

    def reopen(self, port: int) -> None:
        self._closed.discard(port)

    def _set(self, control: int, value: float) -> None:
        self._c.roburoc4_sim_set(self._sim, control, value)

    def _later(self, seconds: float, control: int, value: float) -> None:
        self._do_later(seconds, lambda: self._set(control, value))

    def _do_later(self, seconds: float, deed: Callable[[], None]) -> None:
        at_us = self._us + round(seconds * 1e6)
        heapq.heappush(self._events, (at_us, len(self._events), deed))

    def _act(self, seconds: float) -> None:
        """Take this time; what arrives is heard afterwards."""
        self._pass(seconds, self._early)

    def _touch(self, control: int, value: float, rest: float) -> None:
        self._set(control, value)
        self._act(0.5)
        self._set(control, rest)
        self._act(0.4)

    def _hold_board(self, index: int) -> None:
        """Put a box where a telemeter looks, if the robot is not there itself."""
        place = 2 * math.pi * index / self._drawn["telemeters"]
        angle = place + (index + 1) * self._drawn["telemeter_turn_rad"]
        x_m = 0.655 * math.cos(place) + 0.505 * math.cos(angle)
        y_m = 0.375 * math.sin(place) + 0.505 * math.sin(angle)
        self._c.roburoc4_sim_clear_obstacles(self._sim)
        numbers = [ctypes.c_double(v) for v in (x_m, y_m, 0.01, 0.01, 0.0)]
        self._c.roburoc4_sim_add_box(self._sim, *numbers)

    def say(self, text: str) -> None:
        self._say(self.now_s, text)

    def _say(self, from_s: float, text: str) -> None:
        self.said.append((from_s, self.now_s, text))

    def please(self, key: str, text: str) -> None:
        self.asked.append(key)
        from_s = self.now_s
        self._please(key)
        self._say(from_s, text)

    def _please(self, key: str) -> None:
        if key == "restart":
            self._set(_POWER, 0)
            self._act(5.0)
            self._set(_POWER, 1)
        elif key.startswith("board_") and key != "board_away":
            self._hold_board(int(key[6:]))
        elif key == "sticks":
            for control, value in _STICKS:
                self._touch(control, value, -1.0 if control > 206 else 0.0)
        elif key == "buttons":
            for control in _BUTTONS:
                self._touch(control, 1, 0)
        elif key == "missed":
            self._set(_PAD_A, 0)
        elif key in ("cable_in", "silent"):
            self.unplugged = False
        elif key.startswith("brakes"):
            self._set(_BRAKES, key == "brakes_released")
        elif key in ("lift", "board_away"):
            self._c.roburoc4_sim_clear_obstacles(self._sim)  # the wheels turn freely
        elif key == "pad_forward":
            self._set(_RIGHT_TRIGGER, -0.6)
        elif key == "motors_on":
            self._set(_MOTORS, 1)
        elif key.startswith(("press_", "release_")):
            deed, _, what = key.partition("_")
            control = {"front_bumper": _FRONT, "rear_bumper": _REAR, "pad_a": _PAD_A}[what]
            if key == "release_pad_a":
                self._set(_PAD, 0)
            self._set(control, deed == "press")
        elif key.startswith("estop"):
            self._set(_ESTOP, key == "estop_press")
        self._act(self._people.uniform(0.5, 2.0))

    def ask(self, key: str, text: str) -> str:
        self.asked.append(key)
        self.say(text)
        if key == "battery_v":
            return f"{self._c.sim_battery_voltage(self._sim):.1f}"
        return "yes"

    def countdown(self, key: str, text: str, seconds: float) -> None:
        self.asked.append(key)
        self.say(text)
        if self.misses.get(key):
            self.misses[key] -= 1
            return
        at_s = seconds + self._people.uniform(-0.08, 0.08)
        if key in ("tap_pad_a", "press_pad_a"):
            self._later(at_s, _PAD_A, 1)
        if key == "tap_pad_a":
            self._later(at_s + 0.15, _PAD_A, 0)
        elif key == "release_pad_a":
            self._later(at_s, _PAD_A, 0)
        elif key == "cable_out":
            self._do_later(at_s, lambda: setattr(self, "unplugged", True))

    def hold(self, text: str) -> None:
        self.asked.append("hold")
        self.say(text)
        if not self.held():
            self.let_go.append((self.let_go_at_s, self.now_s))
            self.let_go_at_s = math.inf
        self.holds = True

    def held(self) -> bool:
        if self.now_s >= self.let_go_at_s:
            self.holds = False
        return self.holds
