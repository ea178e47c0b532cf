# SPDX-License-Identifier: MIT
"""SVG pictures in the page's colours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from .figures import Path
    from .series import Series

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

STYLE = """
:root{color-scheme:light dark;--ink:#1b2330;--soft:#5b6675;--grid:#dde3ea;--paper:#fff;
--card:#f5f7fa;--s1:#1d5fd1;--s2:#c2410c;--s3:#0f7b52;--s4:#8a3ab9;--bad:#b3261e;--weak:#8a5a00;--good:#0f6b45}
@media (prefers-color-scheme:dark){:root{--ink:#e6ebf2;--soft:#9aa7b8;--grid:#2b3543;
--paper:#10161f;--card:#18212d;--s1:#7cb0ff;--s2:#ffab70;--s3:#5fd6a4;--s4:#d4a3f5;--bad:#ff9a91;--weak:#f2c268;
--good:#6fdba8}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1060px;padding:24px 20px 60px;background:var(--paper);color:var(--ink);
font:15px/1.5 system-ui,sans-serif}
h1{font-size:24px;margin:0 0 2px}h2{font-size:18px;margin:34px 0 8px}
p{margin:4px 0;color:var(--soft)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(170px,1fr));gap:10px;margin:18px 0}
.tiles div{background:var(--card);border-radius:8px;padding:10px 14px}
.tiles b{display:block;font-size:20px;font-weight:600}.tiles span{color:var(--soft);font-size:13px}
figure{margin:14px 0;background:var(--card);border-radius:8px;padding:10px 12px}
figure.square{max-width:560px}
figcaption{font-weight:600;display:flex;flex-wrap:wrap;gap:4px 18px;align-items:baseline}
.keys{font-weight:400;font-size:13px;color:var(--soft);display:flex;flex-wrap:wrap;gap:0 14px}
.keys i{display:inline-block;width:18px;height:0;border-top:2.5px solid;margin:0 5px 4px 0}
.keys i.s1{border-color:var(--s1)}.keys i.s2{border-color:var(--s2);border-top-style:dashed}
.keys i.s3{border-color:var(--s3)}.keys i.s4{border-color:var(--s4)}
.keys i.begin,.keys i.finish{width:11px;height:11px;border:2.5px solid var(--s3);border-radius:50%;
margin:0 5px -1px 0}.keys i.finish{border-color:var(--s2);background:var(--s2)}
svg{width:100%;height:auto;display:block}
svg text{fill:var(--soft);font:12px system-ui,sans-serif}
.mid{text-anchor:middle}.end{text-anchor:end}
svg path{fill:none;stroke-width:1.6;stroke-linejoin:round}
svg .grid{stroke:var(--grid);stroke-width:1}svg .zero{stroke:var(--soft);stroke-width:1}
svg .s1{stroke:var(--s1)}svg .s2{stroke:var(--s2);stroke-dasharray:6 4}
svg .s3{stroke:var(--s3)}svg .s4{stroke:var(--s4)}
svg .on{fill:var(--s1)}svg .begin{fill:none;stroke:var(--s3);stroke-width:3}
svg .finish{fill:var(--s2)}
.table{overflow-x:auto}
table{border-collapse:collapse;min-width:60%;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid var(--grid);white-space:nowrap}
th{color:var(--soft);font-weight:500;font-size:13px}td.number,th.number{text-align:right}
td.text{white-space:normal;width:100%}
.bad{color:var(--bad)}.weak{color:var(--weak)}.good{color:var(--good)}
.note{background:var(--card);border-left:4px solid var(--weak);padding:8px 12px;
color:var(--ink);margin:8px 0}
@media print{body{max-width:none}figure{break-inside:avoid}}
"""
"""For pages with pictures."""


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
