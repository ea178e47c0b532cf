# SPDX-License-Identifier: MIT
"""Wheels off the ground: how the robot follows, stops, and obeys its game pad."""

import math
import struct
from functools import partial
from itertools import pairwise

from . import wire
from .identify import restart
from .network import hear_clock, keep_clock, restarted
from .response import Response, fit, simulate
from .session import (
    ANSWER_S,
    COMMAND_S,
    MAX_M_S,
    MAX_RAD_S,
    STOP_S,
    MissedError,
    Session,
    SilentError,
    UnsafeError,
)
from .watch import changed_inputs, decoded, digital_inputs
from .wire import CYCLE_S

LATEST_S = 0.45
LONGEST_WATCHDOG_S = 2.0
_DRAWN_S = 5.0
_SLOW = (0.02, 0.05, 0.1)
_SETTLE_S, _NOISE_S, _TRAVEL_S, _WATCHDOG_S = 12.0, 12.0, 3.0, 66.0
_CHANGES = 160
_CLEARLY = 0.95
LIFTED_BY, RESTARTED_BY = "stops", "power on"
_STEADY = 150
"""For how many cycles speeds must not change."""
_EARLIEST_S = -0.3
"""How long before a person acts the last command is sent, at most."""


def _speed(s: Session, axis: int, share: float = 0.6) -> float:
    """Return a speed that the robot may have, on either axis."""
    name, most = (("linear_m_s", MAX_M_S), ("angular_rad_s", MAX_RAD_S))[axis]
    limits = [abs(s.known.get(f"{end}_{name}", 0.0)) for end in ("max", "min")]
    return round(share * min(most, *limits), 3)


def _both(axis: int, speed: float) -> tuple[float, float]:
    return (0.0, speed) if axis else (speed, 0.0)


def may_be_driven(s: Session) -> None:
    """Refuse a robot that no program could drive safely."""
    if "differential" not in s.ids:
        raise UnsafeError("no_differential", "The robot has no service that takes speeds.")
    if "differential" not in s.usable:
        raise UnsafeError("no_speeds", "The robot does not report its speeds.")
    if s.most_subscriptions() < 2:
        raise UnsafeError(
            "list_full", "The robot reports to one subscription at a time; driving needs two."
        )
    for name in ("linear_m_s", "angular_rad_s"):
        if not s.known.get(f"min_{name}", 0.0) < 0.0 < s.known.get(f"max_{name}", 0.0):
            raise UnsafeError("limits", "The robot's speed limits make no sense.")
    for service, what in (("iocard", "That [A] is held"), ("differential", "How fast it is")):
        if s.lag_s(service) > LATEST_S:
            raise UnsafeError(
                "late",
                f"{what}, the robot reports {s.lag_s(service):.2f} s late; later than "
                f"{LATEST_S:g} s, nobody can drive it safely.",
            )


def lift(s: Session) -> None:
    """Have the robot put on its stand, and the emergency stop tried."""
    s.please("lift", "Wheels off the ground, on a stand that carries 140 kg. Nobody near them.")
    s.please("estop_press", "Press the remote emergency stop, so that you have tried it.")
    s.please("estop_release", "Release it.")
    s.please(
        "motors_on",
        "Press the green button (remote or panel): the emergency stop took the motors' power.",
    )


_DIRECTIONS = (
    ("forward", 0, 1, "m/s", "Did the wheels turn forward?"),
    ("backward", 0, -1, "m/s", "Did the wheels turn backward?"),
    ("left", 1, 1, "rad/s", "Did the left wheels turn backward, and the right ones forward?"),
    ("right", 1, -1, "rad/s", "Did the left wheels turn forward, and the right ones backward?"),
)


def stops(s: Session) -> None:
    """Try every stop before it is needed, then the slowest speed in each direction."""
    lift(s)
    _stop_or_refuse(s)
    for name, axis, sign, unit, question in _DIRECTIONS:
        what = f"{name.capitalize()}, slowly, then stop"
        s.hold()
        slowest = s.until_held(partial(_slowest_and_stop, s, axis, sign, what))
        if not slowest:
            raise UnsafeError(
                "does_not_move", "The wheels do not turn: brakes selector, motor power?"
            )
        if not (_is_yes(s, name, question) or _is_yes(s, name, f"Really not? {question}")):
            raise UnsafeError(
                "wrong_way", "The wheels turn the wrong way: do not drive this robot."
            )
        s.notes[f"slowest speed that moved {name}, {unit}"] = slowest


def _is_yes(s: Session, key: str, question: str) -> bool:
    return s.ask(key, f"{question} yes or no").lower() in ("yes", "y")


def _slowest_and_stop(s: Session, axis: int, sign: int, what: str) -> float:
    s.lasts(what, len(_SLOW) * 2.0 + STOP_S + ANSWER_S)
    slowest = _slowest(s, axis, sign)
    _stop_or_refuse(s)
    return slowest


def _stop_or_refuse(s: Session) -> None:
    if not s.stop():
        raise UnsafeError(
            "does_not_stop", "The wheels turn although zeros are sent: cut the power."
        )


def _slowest(s: Session, axis: int, sign: int) -> float:
    """Return the slowest of some speeds at which the wheels turn; 0: at none of them."""
    for speed in _SLOW:
        since_s = s.world.now_s
        s.run(2.0, _both(axis, sign * speed))
        last = [x.speed[axis] for x in s.sampled(since_s, None)[-20:]]
        moved = sign * sum(last) / len(last)
        if moved < -speed / 3:
            s.stop()
            raise UnsafeError("wrong_way", "The robot reports that the wheels turn the wrong way.")
        if moved > speed / 3:
            return speed
    return 0.0


def _settle(s: Session, command: tuple[float, float]) -> None:
    """Drive until the speeds do not change any more: for longer than at the peak of a swing."""
    begin_s = s.world.now_s
    axis = 1 if command[1] else 0

    def settled() -> bool:
        last = [x.speed[axis] for x in s.samples[-_STEADY:]]
        return (
            s.world.now_s > begin_s + _STEADY * CYCLE_S + 0.6
            and len(last) == _STEADY
            and max(last) - min(last) < 1e-3 * abs(command[axis])
        )

    s.run(_SETTLE_S, command, settled)


def _until_steady(s: Session, speed: float) -> None:
    s.lasts(f"Forward at {speed:g} m/s until that is steady", _SETTLE_S)
    _settle(s, (speed, 0.0))


def _rest(s: Session) -> None:
    """Stop, and wait until nothing is left of the last speed."""
    s.stop()
    s.run(STOP_S, (0.0, 0.0), lambda: all(max(map(abs, x.speed)) < 1e-6 for x in s.samples[-20:]))


def responses(s: Session) -> None:
    """Step from rest on both axes, and fit what the wheels do."""
    s.hold()
    for axis, name in enumerate(("linear", "angular")):
        s.begin()
        unit = ("m_s2", "rad_s2")[axis]
        slopes = (s.known.get(f"min_{name}_{unit}", -99.0), s.known.get(f"max_{name}_{unit}", 99.0))
        best: Response | None = None
        speed = _speed(s, axis)
        for share in (1.0, 0.25):
            command = _both(axis, share * speed)
            since_s, samples = s.until_held(partial(_samples_of_step, s, axis, command))
            speeds = _each_cycle(samples, since_s, axis)
            found = fit(command[axis], speeds, slopes)
            if found is not None and (best is None or found.misfit < _CLEARLY * best.misfit):
                best = found
                s.traces[name] = _step(found, command[axis], speeds, slopes)
            if axis == 0 and share == 1.0:
                _keep_targets(s, command[0], samples)
        if best is None:
            raise UnsafeError("does_not_move", f"The wheels do not follow a {name} speed.")
        s.responses[axis] = best
        s.learn(f"{name}_omega_rad_s", min(max(best.omega_rad_s, 1.5), 1000.0))
        s.learn(f"{name}_damping", min(max(best.damping, 0.6), 1.5))
        s.learn(f"{name}_gain", min(max(best.gain, 0.85), 1.15))
    surest = min(s.responses.values(), key=lambda found: found.misfit)
    s.learn("dead_time_cycles", surest.dead_cycles)


def _samples_of_step(
    s: Session, axis: int, command: tuple[float, float]
) -> tuple[float, list[wire.Speeds]]:
    """Command a speed from rest, then stop; return when it was commanded, and what was reported."""
    s.lasts(
        f"A step to {command[axis]:g} {('m/s', 'rad/s')[axis]}, and the stop",
        3 * STOP_S + _SETTLE_S + ANSWER_S,
    )
    _rest(s)
    since_s = s.world.now_s
    _settle(s, command)
    samples = s.sampled(since_s, command)
    s.stop()
    return since_s, samples


def _step(
    response: Response, target: float, speeds: list[float], slopes: tuple[float, float]
) -> dict[str, list[list[float]]]:
    """Draw a step, and what the fitted response would have done."""
    count = min(len(speeds), round(_DRAWN_S / CYCLE_S))
    rest = [0.0] * (response.dead_cycles + 1)
    fitted = rest + simulate(response, [target] * count, slopes)
    return {
        "reported": _drawn(speeds[:count]),
        "fitted": _drawn(fitted[:count]),
        "commanded": _drawn([target] * count),
    }


def _drawn(values: list[float]) -> list[list[float]]:
    return [[round(k * CYCLE_S, 2), round(v, 4)] for k, v in enumerate(values)]


def _each_cycle(samples: list[wire.Speeds], since_s: float, axis: int) -> list[float]:
    """Return the speeds at each cycle since then: the questions were not sent exactly so."""
    speeds, at = [], 0
    for k in range(round((samples[-1].asked_s - since_s) / CYCLE_S)):
        when_s = since_s + k * CYCLE_S
        while at + 2 < len(samples) and samples[at + 1].asked_s <= when_s:
            at += 1
        a, b = samples[at], samples[at + 1]
        share = min(max((when_s - a.asked_s) / (b.asked_s - a.asked_s), 0.0), 1.0)
        speeds.append(a.speed[axis] + share * (b.speed[axis] - a.speed[axis]))
    return speeds


def _keep_targets(s: Session, speed: float, samples: list[wire.Speeds]) -> None:
    shown = next((k for k, x in enumerate(samples) if abs(x.target[0] - speed) < 1e-3), None)
    if shown is not None:
        s.learn("late_targets", int(shown > 0))


def reports(s: Session) -> None:
    """Find out how late, how noisy and how often the reported speeds are measured."""
    s.hold()
    s.begin()
    s.stop()
    hear_clock(s)
    s.subscribe("differential", 1)
    speed = _speed(s, 0)
    s.pump(1.0)
    s.statuses.clear()
    since_s = s.world.now_s
    _until_steady(s, speed)
    arrived = [
        x.at_s
        for x in s.statuses
        if x.service == s.ids["differential"]
        and abs(struct.unpack_from("<f", x.payload)[0] - speed) < 1e-3
    ]
    late_s = min(arrived, default=math.inf) - since_s
    s.notes["a new target is reported after, s"] = round(late_s, 3)
    if late_s > LATEST_S:
        s.stop()
        raise UnsafeError(
            "late", "Commands reach the robot, or reports come back, later than 0.45 s."
        )
    s.statuses.clear()
    s.lasts("A steady speed", _NOISE_S)
    s.run(_NOISE_S, (speed, 0.0))
    _keep_noise(s)
    s.statuses.clear()
    s.lasts("Changing speeds, and the stop", _CHANGES * COMMAND_S + STOP_S)
    for k in range(_CHANGES):
        s.run(COMMAND_S, (speed * (0.5 + 0.1 * (k * 7 % 5)), 0.2 * (k * 3 % 4)))
    _keep_refresh(s)
    s.stop()
    s.unsubscribe("differential")


def _keep_noise(s: Session) -> None:
    """Half of the range in which steady speeds are reported."""
    found = {struct.unpack_from("<f", x.payload, 4)[0] for x in s.heard_of("differential")}
    if len(found) > 5:
        noise = (max(found) - min(found)) / 2 * (1 + 2 / len(found))
        s.learn("speed_noise", round(min(noise, 0.02), 5) if noise > 5e-4 else 0.0)
    elif found:
        s.learn("speed_noise", 0.0)


def _keep_refresh(s: Session) -> None:
    heard = s.heard_of("differential")
    stamps = [x.cycles for x in heard]
    spans = [b - a for a, b in pairwise(stamps)]
    period = int(s.known["min_period_cycles"])
    if any(span != period for span in spans) and math.gcd(*stamps) > 1:
        s.learn("stamp_measured", 1)
        s.learn("odometry_period_cycles", min(math.gcd(*stamps), 20))
        return
    changed = [
        (a.cycles, b.cycles, a.payload[4:8] + a.payload[12:] != b.payload[4:8] + b.payload[12:])
        for a, b in pairwise(heard)
    ]
    possible = [
        refresh
        for refresh in range(1, 21)
        if all(not news or b // refresh > a // refresh for a, b, news in changed)
        and (period == 1 or all(news or b // refresh == a // refresh for a, b, news in changed))
    ]
    if period == 1 and possible:
        s.learn("odometry_period_cycles", max(possible))
        if max(possible) > 1:
            s.learn("stamp_measured", 0)
    elif len(possible) == 1:
        s.learn("odometry_period_cycles", possible[0])


def watchdog(s: Session) -> None:
    """Fall silent in mid-drive, and see when the wheels stop by themselves."""
    s.hold()
    s.begin()
    hear_clock(s)
    speed = _speed(s, 0)
    s.stop()
    _until_steady(s, speed)
    last_s = s.commanded_s
    half = abs(speed * s.responses[0].gain) / 2
    s.lasts("No commands until the wheels stop by themselves", _WATCHDOG_S + ANSWER_S + STOP_S)
    s.run(_WATCHDOG_S, None, lambda: bool(s.samples) and abs(s.samples[-1].speed[0]) < 0.1 * half)
    samples = s.sampled(last_s, None)
    s.stop()
    if abs(samples[-1].speed[0]) > half:
        raise UnsafeError("no_watchdog", "The robot drives on for a minute without commands.")
    dead = s.responses[0].dead_cycles
    after = [round((x.asked_s - last_s) / CYCLE_S) for x in samples]
    zero = next((k for k, x in zip(after, samples, strict=True) if abs(x.target[0]) < 1e-3), None)
    model = simulate(s.responses[0], [-speed] * 2000, _slopes(s))
    # A model that is as fast as a cycle, beside a limit of acceleration, may never get there.
    model_half = next((k for k, x in enumerate(model) if -x >= half), 0)
    fell = next(k for k, x in zip(after, samples, strict=True) if abs(x.speed[0]) <= half)
    by_speed = fell - dead - model_half
    by_target = None if zero is None else zero - (dead if s.known["late_targets"] else 0)
    shown = by_target is None or by_target > by_speed + 30
    s.learn("tripped_target_shown", int(shown))
    cycles = by_speed if by_target is None or shown else by_target
    s.learn("robot_watchdog_ms", min(max(10 * cycles, 100), 60000))
    every = max(1, len(samples) // 1000)
    s.traces["watchdog"] = {
        label: [
            [round(x.asked_s - last_s, 2), round(getattr(x, part)[0], 4)] for x in samples[::every]
        ]
        for label, part in (("speed", "speed"), ("target", "target"))
    }


def _slopes(s: Session) -> tuple[float, float]:
    return s.known.get("min_linear_m_s2", -99.0), s.known.get("max_linear_m_s2", 99.0)


def _target_at(samples: list[wire.Speeds], at_s: float) -> float:
    return min(samples, key=lambda x: abs(x.asked_s - at_s)).target[0]


def pad(s: Session) -> None:
    """Hold [A] while commands are sent, and see what is obeyed when it is released."""
    s.please("at_pad", "Take the game pad in hand: countdowns of 1.5 s say when to press [A].")
    s.hold()
    s.begin()
    s.statuses.clear()
    s.subscribe("iocard", 1)
    first, second = _speed(s, 0, 0.5), _speed(s, 0, 0.25)
    shift_s = s.responses[0].dead_cycles * CYCLE_S if s.known["late_targets"] else 0.0
    s.stop()
    _until_steady(s, first)
    zero_s = s.world.now_s + 1.5
    s.world.countdown("press_pad_a", "Hold [A] from 0 on, and touch no stick.", 1.5)
    s.run(2.5, (first, 0.0))
    lead_s = _lead(s, s.sampled(zero_s - 1.0, (first, 0.0)), first, zero_s + shift_s)
    held_s = s.known["robot_watchdog_ms"] / 1000 + 1.0
    s.lasts("Keep [A] held until the next countdown", held_s)
    s.run(held_s, (second, 0.0))
    release_s = s.world.now_s + 1.5
    s.world.countdown("release_pad_a", "Let [A] go when the countdown reaches 0.", 1.5)
    # Before it is released; and it must be long enough before the watchdog trips.
    last_s = max(_EARLIEST_S, 0.015 - s.known["robot_watchdog_ms"] / 2000)
    s.run(1.5 + last_s - lead_s, (second, 0.0))
    samples = _silent(s, 0.7 + lead_s - last_s)
    _expect_pad_a(s, True, zero_s - 0.7, zero_s + 0.7)
    trips_s = s.known["robot_watchdog_ms"] / 1000 + last_s
    _expect_pad_a(s, False, release_s + last_s, release_s + trips_s)
    if any(abs(x.target[0] - second) < 1e-3 for x in samples):
        s.learn("pad_keeps_target", 1)
    elif any(abs(x.target[0] - first) < 1e-3 for x in samples):
        s.learn("pad_keeps_target", 2)
        s.learn("ignored_commands_feed", 1)
    elif _comes_back(s, first, shift_s, lead_s):
        s.learn("pad_keeps_target", 2)
        s.learn("ignored_commands_feed", 0)
    else:
        s.learn("pad_keeps_target", 0)
    s.subscribe("iocard", 10)
    _pad_target(s)


def _expect_pad_a(s: Session, pressed: bool, from_s: float, to_s: float) -> None:
    """Ask for it again unless the inputs, which come late, may have changed then."""
    s.stop()
    s.pump(s.lag_s("iocard") + 0.3)
    index = int(s.known["override_index"])
    seen_s = [
        x.at_s
        for x in s.heard_of("iocard")
        if x.at_s > from_s - 0.3 and decoded(s, x.payload)[1][index] == pressed
    ]
    first = seen_s[0] if seen_s else math.inf
    most_s = s.lag_s("iocard") + 2 * CYCLE_S * (s.known["min_period_cycles"] + 1)
    if not from_s < first < to_s + most_s:
        s.subscribe("iocard", 10)
        deed = "pressed" if pressed else "let go"
        raise MissedError(f"[A] was not {deed} at 0. Let it go.")


def _lead(s: Session, samples: list[wire.Speeds], target: float, zero_s: float) -> float:
    """Return how much earlier than a person must act what we send, so that both meet."""
    trip_s = s.known["queue_answer_ms"] / 1000
    dropped = [x.asked_s for x in samples if abs(x.target[0] - target) > 1e-3]
    if dropped and dropped[0] < zero_s + 0.1:  # later it is the watchdog
        lead_s = min(max(zero_s - dropped[0], 0.0), trip_s)
        s.notes["of all delays, on the way to the robot, within 0.1, s"] = round(lead_s, 2)
        return lead_s
    return trip_s if s.known["robot_watchdog_ms"] / 1000 > trip_s + 0.4 else trip_s / 2


def _silent(s: Session, seconds: float) -> list[wire.Speeds]:
    """Send no command for this long; return what was reported since the last one."""
    since_s = s.commanded_s
    s.run(seconds, None)
    return s.sampled(since_s + CYCLE_S, None)


def _comes_back(s: Session, target: float, shift_s: float, lead_s: float) -> bool:
    """Whether the target from before [A] is obeyed after a short tap on it."""
    watchdog_s = s.known["robot_watchdog_ms"] / 1000
    s.stop()
    _until_steady(s, target)
    zero_s = s.world.now_s + 1.5
    s.world.countdown("tap_pad_a", "Tap [A] shortly when the countdown reaches 0.", 1.5)
    last_s = max(_EARLIEST_S / 2, 0.175 - watchdog_s / 2)
    s.run(1.5 + last_s - lead_s, (target, 0.0))
    tripped_s = s.commanded_s + watchdog_s + shift_s
    samples = _silent(s, 0.55 + lead_s - last_s)
    dropped = next((k for k, x in enumerate(samples) if abs(x.target[0] - target) > 1e-3), None)
    _expect_pad_a(s, True, zero_s - 0.2, zero_s + 0.3)
    if dropped is None:
        return True
    came_back = any(abs(x.target[0] - target) < 1e-3 for x in samples[dropped:])
    return came_back or samples[dropped].asked_s > tripped_s - 0.1


def _pad_target(s: Session) -> None:
    s.begin()
    s.stop()
    s.please("press_pad_a", "Hold [A] again, and keep it held for the next line, too.")
    s.please("pad_forward", "Press the right trigger a little, so that the wheels turn; keep both.")
    since_s = s.world.now_s
    s.run(4.0, None)
    last = s.sampled(since_s, None)[-1]
    s.please("release_pad_a", "Let both go.")
    s.stop()
    if abs(last.speed[0]) > 0.02:
        s.learn("pad_target_hidden", int(abs(last.target[0]) < abs(last.speed[0]) / 2))


def motors(s: Session) -> None:
    """Send commands without motor power, also one beyond the limits."""
    s.begin()
    hear_clock(s)
    speed = _speed(s, 0)
    samples = _without_power(s, "estop_press", "Press the remote emergency stop.", speed)
    if max(abs(x.speed[0]) for x in samples) > 0.03:
        s.stop()
        raise UnsafeError(
            "no_emergency_stop", "The wheels turn although the emergency stop should be pressed."
        )
    ignored = abs(samples[-1].target[0] - speed) > 1e-3
    s.learn("commands_need_motors", int(ignored))
    s.stop()
    if not ignored:
        most = s.known["max_linear_m_s"]
        s.command(2 * most, 0.0, powerless=True)
        since_s = s.world.now_s
        s.run(0.25, None)
        shown = _target_at(s.sampled(since_s, None), since_s + 0.2)
        s.learn("over_limit_refused", int(abs(shown - most) > 1e-2 * most))
        s.stop()
    s.begin()
    _power_comes_back(
        s, _without_power(s, "estop_release", "Release it, and press no green button.", speed)
    )
    s.please("motors_on", "Press the green button: the wheels must stay still.")
    _power_comes_back(s, s.samples[-1:])
    _without_power(s, "brakes_released", "Turn the brakes selector to Released.", speed)
    s.stop()
    s.please("brakes_automatic", "Turn it to Automatic.")
    s.please("motors_on", "Press the green button again: the wheels must stay still.")
    _power_comes_back(s, s.samples[-1:])


def _without_power(s: Session, key: str, text: str, speed: float) -> list[wire.Speeds]:
    """Ask for something that takes motor power away, command a speed, and keep what is seen."""
    before = digital_inputs(s)
    s.please(key, text)
    changes = changed_inputs(before, digital_inputs(s))
    s.hold()
    samples = s.until_held(partial(_run_and_sample, s, 1.0, speed))
    s.watched.append(
        [
            f"{text} A speed of {speed:g} m/s was sent.",
            f"{changes}; target {samples[-1].target[0]:.2f} m/s, speed "
            f"{samples[-1].speed[0]:.2f} m/s",
        ]
    )
    return samples


def _run_and_sample(s: Session, seconds: float, speed: float) -> list[wire.Speeds]:
    since_s = s.world.now_s
    s.run(seconds, (speed, 0.0))
    return s.sampled(since_s, None)


def _power_comes_back(s: Session, samples: list[wire.Speeds]) -> None:
    """Refuse wheels that turn before the green button, or after it without a command."""
    stopped = s.stop()
    if not stopped or max((abs(x.speed[0]) for x in samples), default=0.0) > 0.03:
        raise UnsafeError("power_moves", "The wheels turned when motor power came back.")


def power_on(s: Session) -> None:
    """Restart, and see whether the motors have power at once."""
    s.begin()
    keep_clock(s)
    restart(s, "Whether the motors have power after that, is found out next.", 0)
    restarted(s)
    s.hold()
    samples = s.until_held(partial(_run_and_sample, s, 2.0, 0.1))
    moved = abs(samples[-1].speed[0]) > 0.03
    s.stop()
    s.learn("start_safe", int(not moved))
    s.please("motors_on", "Press the green button: after a restart the motors may need it.")


def odometry(s: Session) -> None:
    """Compare the pose with the speeds, and set it."""
    if "localization" not in s.usable:
        return
    s.begin()
    s.subscribe("localization", 10)
    s.lasts("The pose is set, and set back", 1.5 + 2.0 + 1.0 + 2 * ANSWER_S)
    before = _poses(s, 1.5)[-1]
    _replace(s, before)
    s.hold()
    speed = _speed(s, 0)
    ahead, driven = s.until_held(partial(_travel, s, (speed, 0.0)))
    turn, turned = s.until_held(partial(_travel, s, (0.0, _speed(s, 1))))
    scale = ahead[0] / driven[0] if driven[0] else 0.0
    s.learn("odometry_scale", round(min(max(scale, -2.0), 2.0), 3))
    if abs(scale) > 0.05 and turned[1]:
        s.learn("odometry_mirrored", int(turn[1] / turned[1] / scale < 0))
    s.unsubscribe("localization")


def _poses(s: Session, seconds: float) -> list[tuple[float, float, float]]:
    heard = s.listen(seconds)["localization"]
    if not heard:
        raise SilentError
    return [struct.unpack_from("<3d", x.payload) for x in heard]


def _replace(s: Session, pose: tuple[float, float, float]) -> None:
    number = s.ids["localization"]
    there = (pose[0] + 1.0, pose[1], pose[2])
    answer = s.request(wire.REPLACE, number, struct.pack("<Q3d", 1, *there))
    after = _poses(s, 2.0)[-1]
    if answer is not None and answer.error:
        s.learn("replace_mode", 1)
    else:
        s.learn("replace_mode", 0 if math.dist(after, there) < 0.1 else 2)
    s.request(wire.REPLACE, number, struct.pack("<Q3d", 1, *pose))
    s.pump(1.0)


def _travel(s: Session, command: tuple[float, float]) -> tuple[list[float], list[float]]:
    """Drive for 3 s; return way and turn by the pose, and by the speeds."""
    what = "In place" if command[1] else "Forward"
    s.lasts(f"{what} for {_TRAVEL_S:g} s, until all is at rest", _TRAVEL_S + 3 * STOP_S + 3.0)
    s.stop()
    s.listen(0.5)  # where it stands
    since_s = s.world.now_s
    s.run(_TRAVEL_S, command)
    _rest(s)
    spans = list(pairwise(s.sampled(since_s, None)))
    s.pump(1.0)
    poses = [struct.unpack_from("<3d", x.payload) for x in s.heard_of("localization")]
    way = turn = 0.0
    for a, b in pairwise(poses):
        way += (b[0] - a[0]) * math.cos(a[2]) + (b[1] - a[1]) * math.sin(a[2])
        turn += math.remainder(b[2] - a[2], math.tau)
    by_speeds = [
        sum((b.asked_s - a.asked_s) * (a.speed[axis] + b.speed[axis]) / 2 for a, b in spans)
        for axis in (0, 1)
    ]
    return [way, turn], by_speeds


def may_leave_the_stand(s: Session) -> None:
    """Refuse the ground to a robot whose answers endanger."""
    if s.known["robot_watchdog_ms"] > 1000 * LONGEST_WATCHDOG_S:
        raise UnsafeError(
            "slow_watchdog",
            "When the link breaks, this robot drives on for longer than 2 s: set Watchdog in "
            "its udpserver.cfg.",
        )
    if "localization" not in s.usable:
        raise UnsafeError("no_localization", "The robot reports no pose, which moves need.")
    scale = s.known.get("odometry_scale")
    if s.known.get("odometry_mirrored") or (scale is not None and scale < -0.05):
        raise UnsafeError(
            "odometry", "The pose goes the other way than the wheels do: moves would be wrong."
        )
    if scale is None or not 0.5 <= scale <= 2.0:
        raise UnsafeError("odometry", "The pose does not follow the wheels: moves would be wrong.")
