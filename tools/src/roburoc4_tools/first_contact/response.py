# SPDX-License-Identifier: MIT
"""The response of one axis: a second-order model with a limit of its slope, fitted to a step."""

import cmath
from collections.abc import Callable, Sequence
from typing import NamedTuple

from .wire import CYCLE_S

IMMEDIATE_RAD_S = 1000.0
_FAST_RAD_S, _ALIKE = 60.0, 0.01
"""From this frequency on, a response is immediate if that is as good within 1 % of the step."""


class Response(NamedTuple):
    """How an axis follows its target."""

    omega_rad_s: float
    damping: float
    gain: float
    dead_cycles: int
    misfit: float
    """Largest deviation from the samples, as a share of the step."""


def _transition(omega: float, damping: float) -> tuple[float, float, float, float]:
    """Return what error and slope become within a cycle."""
    root = cmath.sqrt(damping * damping - 1) * omega
    fast, slow = -damping * omega - root, -damping * omega + root
    if abs(fast - slow) < 1e-6 * omega:
        slow += 1e-4 * omega
    e_fast, e_slow = cmath.exp(fast * CYCLE_S), cmath.exp(slow * CYCLE_S)
    width = slow - fast
    return (
        ((slow * e_fast - fast * e_slow) / width).real,
        ((e_slow - e_fast) / width).real,
        (fast * slow * (e_fast - e_slow) / width).real,
        ((slow * e_slow - fast * e_fast) / width).real,
    )


def simulate(
    response: Response, targets: Sequence[float], slopes: tuple[float, float]
) -> list[float]:
    """Return the speed after each cycle with these targets, from rest."""
    ee, es, se, ss = _transition(response.omega_rad_s, response.damping)
    immediate = response.omega_rad_s >= IMMEDIATE_RAD_S
    speed = slope = 0.0
    speeds = []
    for target in targets:
        wanted = target * response.gain
        error = speed - wanted
        new = se * error + ss * slope
        if immediate:
            speed, slope = wanted, 0.0
        elif slopes[0] <= new <= slopes[1]:
            speed, slope = wanted + ee * error + es * slope, new
        else:
            new = min(max(new, slopes[0]), slopes[1])
            speed, slope = speed + (slope + new) / 2 * CYCLE_S, new
        speeds.append(speed)
    return speeds


def _least(
    cost: Callable[[float, float], float], begin: tuple[float, float]
) -> tuple[float, float]:
    """Return where the cost is least: downhill from there, with steps that halve."""
    at, best, step = begin, cost(*begin), 0.1
    while step > 1e-3:
        around = [
            (at[0] * (1 + i * step), min(max(at[1] + j * step, 0.55), 1.6))
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
            if i or j
        ]
        costs = [(cost(*there), there) for there in around]
        if min(costs)[0] < best:
            best, at = min(costs)
        else:
            step /= 2
    return at


def fit(target: float, speeds: Sequence[float], slopes: tuple[float, float]) -> Response | None:
    """Fit the response from rest to a target; speeds[k] is that k cycles after the command.

    None: the axis did not move.
    """
    tail = speeds[-max(5, len(speeds) // 10) :]
    final = sum(tail) / len(tail)
    moving = next((k for k, v in enumerate(speeds) if abs(v) > 2e-6 + 1e-5 * abs(target)), None)
    if moving is None or abs(final) < 0.1 * abs(target):
        return None
    gain = final / target
    best: Response | None = None
    for dead in range(max(0, moving - 3), max(1, moving)):
        targets = [target] * (len(speeds) - 1 - dead)
        heard = list(speeds[dead + 1 :])

        def cost(omega: float, damping: float) -> float:
            model = Response(omega, damping, gain, dead, 0.0)  # noqa: B023
            simulated = simulate(model, targets, slopes)  # noqa: B023
            return sum((a - b) ** 2 for a, b in zip(simulated, heard, strict=True))  # noqa: B023

        # What settles within a few cycles looks alike for many frequencies: search more closely.
        fast = abs(heard[min(4, len(heard) - 1)]) > 0.9 * abs(final)
        first, step, count = (60.0, 1.03, 96) if fast else (1.5, 1.25, 24)
        if fast:
            heard, targets = heard[:30], targets[:30]
        starts = [
            (first * step**i, 0.6 + 0.1 * j)
            for i in range(count)
            for j in range(0, 10, 1 + (not fast))
        ]
        begins = sorted(starts, key=lambda s: cost(*s))[:5]
        candidates = [(IMMEDIATE_RAD_S, 1.0), *(_least(cost, begin) for begin in begins)]
        omega, damping = min(candidates, key=lambda s: cost(*s))
        model = Response(omega, damping, gain, dead, 0.0)
        found = _judged(model, targets, heard, slopes)
        if best is None or found.misfit < best.misfit:
            best = found
            at_once = model._replace(omega_rad_s=IMMEDIATE_RAD_S, damping=1.0)
            immediate = _judged(at_once, targets, heard, slopes)
    if best is None or best.omega_rad_s < _FAST_RAD_S:
        return best
    return immediate if immediate.misfit < best.misfit + _ALIKE else best


def _judged(
    model: Response, targets: list[float], heard: list[float], slopes: tuple[float, float]
) -> Response:
    """Return this response with its misfit."""
    simulated = simulate(model, targets, slopes)
    furthest = max(abs(a - b) for a, b in zip(simulated, heard, strict=True))
    return model._replace(misfit=furthest / abs(model.gain * targets[0]))
