# SPDX-License-Identifier: MIT
"""A simulated RobuROC4: in virtual time, or in real time behind a UDP port."""

import contextlib
import errno
import math
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from os import PathLike
from typing import Any, Concatenate, ParamSpec, Self, SupportsFloat, TypedDict, TypeVar, Unpack

from . import _native
from .constants import Result
from .errors import (
    ArgumentError,
    NetworkError,
    RobotError,
    duration_s,
    error_of,
    finite,
    is_within,
    unusable,
)
from .records import Pose, SimState
from .robot import Robot, connect
from .settings import STATUS_SERVICES, Settings, known_of, set_member
from .virtual import VirtualConnection, run

__all__ = ["SimSettings", "Simulator"]

_P = ParamSpec("_P")
_R = TypeVar("_R")
_WALL_THICKNESS_M = 0.1
_FARTHEST_M = 1e6
_SMALLEST_BOX_M = 0.01
_LARGEST_BOX_M = 1e4


class SimSettings(TypedDict, total=False):
    """Settings of a simulated robot; all have defaults.

    ``roburoc4_sim.h`` describes each, and docs/PROTOCOL.md those that the manual leaves open.
    """

    robot_file: str | PathLike[str]
    """Be the robot of this file; other settings take precedence."""
    watchdog_cycles: int
    iocard_id: int
    telemeter_id: int
    battery_id: int
    localization_id: int
    differential_id: int
    iocard_type: int
    telemeter_type: int
    battery_type: int
    localization_type: int
    differential_type: int
    plain_types: bool
    hidden_services: int
    refused_inserts: int
    query_mode: int
    answer_id_fixed: bool
    only_id_fixed: bool
    error_header: int
    """How errors come: 0 as an answer, 1 as an error telegram, 2 as the byte 0x00 alone."""
    start_safe: bool
    as_manual: bool
    """Exactly as in the manual; the defaults make a first drive easier."""
    localization_flags: int
    analog_inputs: int
    analog_outputs: int
    digital_inputs: int
    digital_outputs: int
    max_linear_m_s: float
    min_linear_m_s: float
    max_angular_rad_s: float
    min_angular_rad_s: float
    max_linear_m_s2: float
    min_linear_m_s2: float
    max_angular_rad_s2: float
    min_angular_rad_s2: float
    width_m: float
    slip: float
    """Fraction of a turn that is lost to skidding, 0 (none, and no noise) to 0.9."""
    nominal_voltage_v: float
    capacity_ah: float
    battery_percent: float
    minimum_percent: int
    start_x_m: float
    start_y_m: float
    start_theta_rad: float
    uptime_cycles: int
    clock_ppm: int
    stamp_measured: bool
    error_code: int
    surplus_bytes: int
    delete_refused: bool
    replace_mode: int
    input_shift: int
    texts: int
    telemeters: int
    reported_distances: int
    telemeter_turn_rad: float
    other_status_port: bool
    subscription_lists: int
    min_period_cycles: int
    max_subscriptions: int
    full_list: int
    keep_subscriptions: bool
    pad_keeps_target: int
    ignored_commands_feed: bool
    pad_target_hidden: bool
    tripped_target_shown: bool
    commands_need_motors: bool
    over_limit_refused: bool
    linear_omega_rad_s: float
    angular_omega_rad_s: float
    linear_damping: float
    angular_damping: float
    linear_gain: float
    angular_gain: float
    dead_time_cycles: int
    late_targets: bool
    speed_noise: float
    odometry_period_cycles: int
    odometry_scale: float
    odometry_mirrored: bool
    queue_uplink_ms: int
    queue_answer_ms: int
    queue_text_ms: int
    queue_iocard_ms: int
    queue_telemeter_ms: int
    queue_battery_ms: int
    queue_localization_ms: int
    queue_differential_ms: int


def _set(config: "_native.SimConfig", name: str, value: Any) -> None:
    service, _, kind = name.rpartition("_")
    if name == "robot_file":
        _native.robot_file_sim_config(known_of(value), config)
    elif service in STATUS_SERVICES and kind == "id":
        _native.roburoc4_sim_config_service_ids_set(config, STATUS_SERVICES[service], value)
    elif service in STATUS_SERVICES and kind == "type":
        _native.roburoc4_sim_config_service_types_set(config, STATUS_SERVICES[service], value)
    else:
        set_member("sim_config", config, name, value)


def _config_of(seed: int | None, family: int | None, settings: SimSettings) -> "_native.SimConfig":
    config = _native.new_sim_config()
    if family is not None:
        if not is_within(0, family, 2**53):
            raise unusable("family", family, f"0 to {2**53}", Result.CONFIG)
        _native.draw_family(config, int(family))
    seeds = {} if seed is None else {"seed": seed}
    given = {**seeds, **settings}
    for name, value in sorted(given.items(), key=lambda item: item[0] != "robot_file"):
        if name not in SimSettings.__annotations__ and name != "seed":
            known = ", ".join(sorted(SimSettings.__annotations__))
            raise ArgumentError(f"no setting {name!r}: there are {known}", Result.CONFIG)
        try:
            _set(config, name, value)
        except (OverflowError, TypeError) as error:
            raise ArgumentError(
                f"{name}: {value!r} cannot be used: {error}", Result.CONFIG
            ) from None
    wrong = _native.roburoc4_sim_config_error(config)
    if wrong is not None:
        about = wrong.partition(":")[0].removeprefix("service_").removesuffix("s")
        named = ", ".join(f"{n}={v!r}" for n, v in settings.items() if n.endswith(about))
        raise ArgumentError(f"{named or 'a setting'} is out of range: {wrong}", Result.CONFIG)
    return config


def _serve(config: "_native.SimConfig", host: str, port: int) -> "_native.Simulation":
    try:
        return _native.new_simulation(config, host, port)
    except (TypeError, ValueError):
        raise unusable("host", host, "an IPv4 address of this machine") from None
    except OSError as error:
        problem = f"{host}:{port} cannot be used ({error.strerror})"
        if error.errno == errno.EADDRINUSE:
            problem = f"{host}:{port} is in use: give another port, or port=0 for a free one"
        elif error.errno in (errno.EADDRNOTAVAIL, errno.EINVAL):
            problem += ": give an IPv4 address of this machine"
        raise NetworkError(problem, Result.SYSTEM) from error


def _check_place(**metres: float) -> None:
    for name, value in metres.items():
        if not is_within(-_FARTHEST_M, value, _FARTHEST_M):
            raise unusable(name, value, f"-{_FARTHEST_M:g} to {_FARTHEST_M:g} m")


def _number_of(control: str) -> int:
    number = -1
    if isinstance(control, str):
        with contextlib.suppress(ValueError):  # a NUL character
            number = _native.roburoc4_sim_control_find(control)
    if number < 0:
        raise ArgumentError(
            f"no control {control!r}: see help(roburoc4.Simulator.set)", Result.ARGUMENT
        )
    return number


class Simulator:
    """A simulated robot for trying out programs and for tests.

    In virtual time (the default) time passes only in ``step`` and in waiting calls on a robot of
    ``connect``: a test takes no real time and is reproducible.

        with roburoc4.Simulator() as sim, sim.connect() as robot:
            robot.arm()
            robot.drive_for(0.5, 0.0, seconds=2)
            assert sim.true_pose.x_m > 0.5

    With a port (0 picks a free one) it serves UDP in real time, on a thread that needs no Python,
    at ``address``. ``sim.connect`` then returns a robot in real time.

    ``family`` draws a robot of the family that the manual allows (docs/PROTOCOL.md): the same one
    for the same number. Settings change it.
    """

    def __init__(
        self,
        *,
        port: int | None = None,
        host: str = "127.0.0.1",
        seed: int | None = None,
        family: int | None = None,
        **settings: Unpack[SimSettings],
    ) -> None:
        self._process = os.getpid()
        self._closed = False
        if port is not None and not (is_within(0, port, 65535) and port == int(port)):
            raise unusable("port", port, "0 to 65535")
        config = _config_of(seed, family, settings)
        self._virtual = port is None
        if port is None:
            self._sim = _native.simulation_in_world(config)
            self._address = "virtual"
        else:
            self._sim = _serve(config, host, int(port))
            self._address = f"{host}:{_native.simulation_port(self._sim)}"
        self._closing = threading.Lock()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<roburoc4.Simulator {self._address}>"

    def close(self) -> None:
        """End the simulator; may be called repeatedly. Its state can still be read."""
        with self._closing:
            if self._closed or self._process != os.getpid():
                return
            self._closed = True
            _native.simulation_stop(self._sim)

    def _act(
        self,
        function: "Callable[Concatenate[_native.Simulation, _P], _R]",
        *arguments: _P.args,
        **names: _P.kwargs,
    ) -> _R:
        """Call a native function on the simulator."""
        if self._process != os.getpid():
            raise error_of(Result.CLOSED)
        return function(self._sim, *arguments, **names)

    # ---- time and network ----

    @property
    def address(self) -> str:
        """``HOST:PORT``, or "virtual"."""
        return self._address

    @property
    def now_s(self) -> float:
        """The simulator's clock in seconds; its zero is arbitrary."""
        return self.state.now_us / 1e6

    def step(self, seconds: float) -> None:
        """Let virtual time pass, also for the robots of ``connect``."""
        if not self._virtual:
            raise RobotError(
                "a simulator on a port runs in real time: use time.sleep()", Result.STATE
            )
        run(self._sim, duration_s("seconds", seconds))

    def connect(self, timeout: float = 10.0, **settings: Unpack[Settings]) -> Robot:
        """Connect a robot object; in virtual time it uses the simulator's clock."""
        if not self._virtual:
            return connect(self._address, timeout=timeout, **settings)
        robot = Robot(VirtualConnection(self._sim, settings), settings)
        robot.wait_ready(timeout)
        return robot

    def set_faults(
        self,
        *,
        loss: float = 0.0,
        duplicate: float = 0.0,
        reorder: float = 0.0,
        corrupt: float = 0.0,
        delay_ms: float = 0.0,
        jitter_ms: float = 0.0,
    ) -> None:
        """Degrade the network in both directions; shares are 0 to 1; no arguments: restore it."""
        shares = {"loss": loss, "duplicate": duplicate, "reorder": reorder, "corrupt": corrupt}
        for name, share in shares.items():
            if not is_within(0, share, 1):
                raise unusable(name, share, "0 to 1")
        for name, milliseconds in (("delay_ms", delay_ms), ("jitter_ms", jitter_ms)):
            if not is_within(0, milliseconds, 1e6):
                raise unusable(name, milliseconds, "0 to 1000000")
        delays = {"delay_us": round(delay_ms * 1e3), "jitter_us": round(jitter_ms * 1e3)}
        faults = _native.new_sim_faults()
        for name, value in (shares | delays).items():
            set_member("sim_faults", faults, name, value)
        self._act(_native.simulation_set_faults, faults)

    # ---- observation ----

    @property
    def state(self) -> SimState:
        """The robot's whole state."""
        return self._act(_native.roburoc4_sim_get_state)

    @property
    def true_pose(self) -> Pose:
        """The robot's true pose, which odometry does not report."""
        state = self.state
        return Pose(state.true_x_m, state.true_y_m, state.true_theta_rad)

    # ---- controls ----

    def set(self, control: str, value: float) -> None:
        """Do what a person beside the robot can do; `panel("help")` lists everything.

        Controls are named as in ``roburoc4_sim.h``: "power", "motor_button", "estop_local",
        "estop_remote", "brakes_released", "charger", "front_bumper", "rear_bumper" and the game
        pad's buttons, "pad_a" to "pad_rb", take True and False; "battery_percent" 0 to 100; the
        axes, "pad_lj_x" to "pad_rt", -1 to 1 ("pad" 0 releases everything); "localization_flags" 0
        to 127. "pin_analog_2" and "pin_digital_8" fix what an input reports, "pin" 0 undoes this.
        Faults are "frozen" and "nan" (masks of services), "blocked_linear", "blocked_angular",
        "creep_m_s", "creep_rad_s", "odometry_scale", "odometry_x_m", "odometry_y_m",
        "odometry_theta_rad", and delays, "queue_uplink_ms" to "queue_differential_ms". "family"
        puts another robot in its place.
        """
        number = _number_of(control)
        if not isinstance(value, SupportsFloat) or getattr(value, "shape", ()) != ():
            raise unusable("value", value, "a number, True or False")
        result = self._act(_native.roburoc4_sim_set, number, value)
        if result == Result.STATE:
            raise RobotError(
                f"{control}: impossible now; turn power on, release both emergency stops and set "
                "the brakes to automatic first",
                Result.STATE,
            )
        if result < 0:
            what = "this robot has none" if result == Result.INDEX else f"{value} cannot be used"
            raise ArgumentError(f"{control}: {what}; see help(roburoc4.Simulator.set)", result)

    def get(self, control: str) -> float:
        """Read a control, an input ("pin_analog_2") or an output ("digital_output_3")."""
        return self._act(_native.roburoc4_sim_get, _number_of(control))

    @contextmanager
    def held(self, control: str) -> Iterator[None]:
        """Press something, such as "pad_a", for the duration of a ``with`` block."""
        self.set(control, True)
        try:
            yield
        finally:
            self.set(control, False)

    def reboot(self) -> None:
        """Switch the power off and on."""
        self.set("power", False)
        self.set("power", True)

    # ---- obstacles ----

    def add_box(
        self, x_m: float, y_m: float, size_x_m: float, size_y_m: float, theta_rad: float = 0.0
    ) -> int:
        """Put a box on the floor, and return its number."""
        _check_place(x_m=x_m, y_m=y_m)
        finite(theta_rad=theta_rad)
        for name, size_m in (("size_x_m", size_x_m), ("size_y_m", size_y_m)):
            if not is_within(_SMALLEST_BOX_M, size_m, _LARGEST_BOX_M):
                raise unusable(name, size_m, f"{_SMALLEST_BOX_M:g} to {_LARGEST_BOX_M:g} m")
        return self._act(_native.roburoc4_sim_add_box, x_m, y_m, size_x_m, size_y_m, theta_rad)

    def add_wall(self, x1_m: float, y1_m: float, x2_m: float, y2_m: float) -> int:
        """Build a wall, 0.1 m thick, between two points, and return its number."""
        _check_place(x1_m=x1_m, y1_m=y1_m, x2_m=x2_m, y2_m=y2_m)
        dx_m, dy_m = x2_m - x1_m, y2_m - y1_m
        return self.add_box(
            (x1_m + x2_m) / 2,
            (y1_m + y2_m) / 2,
            math.hypot(dx_m, dy_m),
            _WALL_THICKNESS_M,
            math.atan2(dy_m, dx_m),
        )

    def clear_obstacles(self) -> None:
        """Remove all boxes and walls."""
        self._act(_native.roburoc4_sim_clear_obstacles)

    def place(self, x_m: float, y_m: float, theta_rad: float = 0.0) -> None:
        """Lift the robot to another place, unnoticed by its odometry."""
        _check_place(x_m=x_m, y_m=y_m)
        finite(theta_rad=theta_rad)
        self._act(_native.roburoc4_sim_place, x_m, y_m, theta_rad)

    def panel(self, line: str) -> str:
        """Execute a line such as "pad a down", and return the reply; "help" lists all commands."""
        if not (isinstance(line, str) and line.isascii() and "\0" not in line):
            raise ArgumentError(f"{line!r}: give letters without accents", Result.ARGUMENT)
        result, reply = self._act(_native.roburoc4_sim_panel, line)
        if result < 0:
            raise ArgumentError(f"{line!r}: {reply}", result)
        return reply
