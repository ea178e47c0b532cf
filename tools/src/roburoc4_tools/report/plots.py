# SPDX-License-Identifier: MIT
"""SVG pictures in the page's colours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

from .figures import Path, Series

_WIDTH, _HEIGHT = 960, 240
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 12, 10, 26
_STEPS_S = (
    0.1,
    0.2,
    0.5,
    1,
    2,
    5,
    10,
    15,
    30,
    60,
    120,
    300,
    600,
    900,
    1800,
    3600,
    7200,
    10800,
    21600,
    43200,
    86400,
)
_TICKS = 8


class Line(NamedTuple):
    """A series, and its style: a class in the page's style sheet."""

    name: str
    style: str
    series: Series


def clock(seconds: float, *, exact: bool = False) -> str:
    """Write a time from the beginning: 1:02:03, or 2:03; exact or below a second 2:03.5."""
    tenths = round(seconds * 10)
    whole, tenth = divmod(tenths, 10)
    text = f"{whole // 60 % 60}:{whole % 60:02d}"
    if whole >= 3600:
        text = f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"
    return f"{text}.{tenth}" if tenth or exact else text


def _nice(span: float, parts: int) -> float:
    """Return a step of 1, 2 or 5 that divides a span into about this many parts."""
    raw = span / parts
    power = 10.0 ** math.floor(math.log10(raw))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= raw * 0.999)


def _ticks(low: float, high: float, step: float) -> Iterable[float]:
    at = math.ceil(low / step - 1e-9)
    while at * step <= high + step * 1e-9:
        yield at * step
        at += 1


def _number(value: float, step: float) -> str:
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{value:.{digits}f}".replace("-0" if value == 0 else "\0", "0")


class _Frame:
    """Axes, and the positions of values."""

    def __init__(self, seconds: float, low: float, high: float, height: int) -> None:
        if high - low < 1e-6:
            low, high = low - 0.5, high + 0.5
        margin = (high - low) * 0.06
        self.low, self.high, self.height = low - margin, high + margin, height
        self.seconds = max(seconds, 1e-3)

    def x(self, seconds: float) -> float:
        return _LEFT + seconds / self.seconds * (_WIDTH - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return self.height - _BOTTOM - share * (self.height - _TOP - _BOTTOM)

    def time_axis(self) -> str:
        step = next((s for s in _STEPS_S if self.seconds / s <= _TICKS), self.seconds)
        parts = []
        for tick in _ticks(0, self.seconds, step):
            x = self.x(tick)
            parts.append(
                f'<path class="grid" d="M{x:.1f} {_TOP}V{self.height - _BOTTOM}"/>'
                f'<text x="{x:.1f}" y="{self.height - 8}" class="mid">{clock(tick)}</text>'
            )
        return "".join(parts)

    def value_axis(self, unit: str) -> str:
        step = _nice(self.high - self.low, 5)
        parts = []
        for tick in _ticks(self.low, self.high, step):
            y = self.y(tick)
            parts.append(
                f'<path class="{"zero" if abs(tick) < step / 2 else "grid"}" '
                f'd="M{_LEFT} {y:.1f}H{_WIDTH - _RIGHT}"/>'
                f'<text x="{_LEFT - 6}" y="{y + 4:.1f}" class="end">{_number(tick, step)}</text>'
            )
        parts.append(f'<text x="2" y="{_TOP + 8}" class="unit">{escape(unit)}</text>')
        return "".join(parts)


def _trace(frame: _Frame, series: Series) -> str:
    parts: list[str] = []
    before_s = -math.inf
    for seconds, low, high in series.points:
        x = f"{frame.x(seconds):.1f}"
        first = "M" if seconds - before_s > series.gap_s else "L"
        parts.append(f"{first}{x} {frame.y(low):.1f}")
        if high != low:
            parts.append(f"V{frame.y(high):.1f}")
        elif first == "M":
            parts.append("h.1")  # a single value should be visible, too
        before_s = seconds
    return "".join(parts)


def _svg(width: int, height: int, label: str, content: str) -> str:
    head = f'<svg viewBox="0 0 {width} {height}" role="img" aria-label="{escape(label)}">'
    return f"{head}{content}</svg>"


def chart(
    title: str, unit: str, seconds: float, lines: Sequence[Line], bounds: Sequence[float] = ()
) -> str:
    """Draw values over time; the axis includes these bounds."""
    drawn = [line for line in lines if line.series.points]
    if not drawn:
        return ""
    low = min(*bounds, *(line.series.low for line in drawn), math.inf)
    high = max(*bounds, *(line.series.high for line in drawn), -math.inf)
    frame = _Frame(seconds, low, high, _HEIGHT)
    traces = "".join(
        f'<path class="{line.style}" d="{_trace(frame, line.series)}"/>' for line in drawn
    )
    keys = "".join(
        f'<span><i class="{line.style}"></i>{escape(line.name)}</span>' for line in drawn
    )
    picture = _svg(
        _WIDTH, _HEIGHT, f"{title} in time", frame.value_axis(unit) + frame.time_axis() + traces
    )
    caption = f'{escape(title)}<b class="keys">{keys}</b>'
    return f"<figure><figcaption>{caption}</figcaption>{picture}</figure>"


def way(path: Path) -> str:
    """Draw the path by odometry; both axes have the same scale."""
    if len(path.points) < 2:
        return ""
    xs, ys = [place[0] for place in path.points], [place[1] for place in path.points]
    span = max(max(xs) - min(xs), max(ys) - min(ys), 0.2) * 1.12
    size = 520
    middle_x, middle_y = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2
    inner = size - _LEFT - _BOTTOM

    def x(value: float) -> float:
        return _LEFT + (value - middle_x + span / 2) / span * inner

    def y(value: float) -> float:
        return size - _BOTTOM - (value - middle_y + span / 2) / span * inner

    step = _nice(span, 6)
    parts = []
    for tick in _ticks(middle_x - span / 2, middle_x + span / 2, step):
        parts.append(
            f'<path class="grid" d="M{x(tick):.1f} {_BOTTOM}V{size - _BOTTOM}"/>'
            f'<text class="mid" x="{x(tick):.1f}" y="{size - 8}">{_number(tick, step)}</text>'
        )
    for tick in _ticks(middle_y - span / 2, middle_y + span / 2, step):
        parts.append(
            f'<path class="grid" d="M{_LEFT} {y(tick):.1f}H{_LEFT + inner}"/>'
            f'<text class="end" x="{_LEFT - 6}" y="{y(tick) + 4:.1f}">{_number(tick, step)}</text>'
        )
    trace = "".join(
        f"{'M' if at == 0 or at in path.breaks else 'L'}{x(px):.1f} {y(py):.1f}"
        for at, (px, py) in enumerate(path.points)
    )
    first, last = path.points[0], path.end or path.points[-1]
    parts.append(
        f'<path class="s1" d="{trace}"/>'
        f'<circle class="begin" cx="{x(first[0]):.1f}" cy="{y(first[1]):.1f}" r="6"/>'
        f'<circle class="finish" cx="{x(last[0]):.1f}" cy="{y(last[1]):.1f}" r="5"/>'
    )
    return (
        '<figure class="square"><figcaption>Path by odometry: x to the right, y up, in metres'
        '<b class="keys">'
        '<span><i class="begin"></i>beginning</span><span><i class="finish"></i>end</span></b>'
        f"</figcaption>{_svg(size, size, 'path by odometry', ''.join(parts))}</figure>"
    )


def lamps(seconds: float, rows: Sequence[tuple[str, Sequence[Sequence[float]]]]) -> str:
    """Draw when each input was on."""
    if not rows:
        return ""
    left, row_height = 210, 22
    height = _TOP + row_height * len(rows) + _BOTTOM
    frame = _Frame(seconds, 0, 1, height)
    scale = (_WIDTH - left - _RIGHT) / frame.seconds
    parts = []
    step = next((s for s in _STEPS_S if frame.seconds / s <= _TICKS), frame.seconds)
    for tick in _ticks(0, frame.seconds, step):
        x = left + tick * scale
        parts.append(
            f'<path class="grid" d="M{x:.1f} {_TOP}V{height - _BOTTOM}"/>'
            f'<text x="{x:.1f}" y="{height - 8}" class="mid">{clock(tick)}</text>'
        )
    for at, (name, spans) in enumerate(rows):
        y = _TOP + at * row_height
        parts.append(
            f'<text x="{left - 8}" y="{y + 15}" class="end">{escape(name)}</text>'
            f'<path class="grid" d="M{left} {y + row_height}H{_WIDTH - _RIGHT}"/>'
        )
        parts += [
            f'<rect class="on" x="{left + a * scale:.1f}" y="{y + 4}" '
            f'width="{max(1.5, (b - a) * scale):.1f}" height="{row_height - 8}"/>'
            for a, b in spans
        ]
    picture = _svg(_WIDTH, height, "when inputs were on", "".join(parts))
    return f"<figure><figcaption>Inputs that were on</figcaption>{picture}</figure>"
