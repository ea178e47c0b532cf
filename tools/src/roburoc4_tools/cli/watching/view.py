# SPDX-License-Identifier: MIT
"""The live table of `monitor`: a Snapshot in a terminal, or as one line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich import box
from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from ..names import TELEMETER_NAMES, flag_names
from ..output import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rich.console import RenderableType

    from roburoc4 import (
        DifferentialStatus,
        Facts,
        IoCardStatus,
        LocalizationStatus,
        TelemeterStatus,
    )

    from .snapshot import Snapshot, StreamFigures

_BAR_CELLS = 12
_STALE_PERIODS = 3.0


def bar(share: float, style: str, cells: int = _BAR_CELLS) -> Text:
    """Draw a share of 0 to 1."""
    filled = round(max(0.0, min(1.0, share)) * cells) if math.isfinite(share) else 0
    return Text.assemble(("█" * filled, style), ("░" * (cells - filled), "dim"))


def lamp(name: str, lit: bool | None, style: str) -> Text:
    """Draw an indicator: on, off, or unknown."""
    if lit is None:
        return Text(f" ? {name} ", "dim")
    return Text(f" {'●' if lit else '○'} {name} ", f"bold white on {style}" if lit else "dim")


_NARROW_CELLS = 100


def flow(parts: Iterable[Text | str], cells: int, gap: str = "  ") -> Text:
    """Put parts on lines of this width, which break between parts only."""
    lines: list[Text] = []
    for part in map(_text, parts):
        if lines and lines[-1].cell_len + len(gap) + part.cell_len <= cells:
            lines[-1].append(gap).append_text(part)
        else:
            lines.append(part.copy())
    return Text("\n").join(lines)


def render(seen: Snapshot, cells: int = _NARROW_CELLS) -> RenderableType:
    """Draw everything, for a terminal of this width: if it is narrow, values are listed below."""
    if cells < _NARROW_CELLS:
        return Group(_headline(seen, cells), lamps(seen.facts, cells), *_stack(seen, cells))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, expand=False)
    table.add_column("service", no_wrap=True)
    for heading in ("rate", "age", "loss", "jitter"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("values")
    for figures in seen.streams:
        table.add_row(*_figures(figures), _values(seen, figures.service))
    return Group(_headline(seen, cells), lamps(seen.facts, cells), table)


def _stack(seen: Snapshot, cells: int) -> Iterator[RenderableType]:
    for figures in seen.streams:
        service, *numbers = _figures(figures)
        yield Text("\n") + flow([Text(str(service), "bold"), *numbers], cells)
        yield Padding(_values(seen, figures.service, cells - 2), (0, 0, 0, 2))


def _text(cell: Text | str) -> Text:
    return cell if isinstance(cell, Text) else Text(cell)


def _headline(seen: Snapshot, cells: int) -> Text:
    style = "green" if seen.state == "ready" else "bold red"
    return flow(
        [
            Text(seen.address, "bold"),
            Text(seen.state, style),
            f"round trip {seen.round_trip_ms:.1f} ms",
            f"loss {seen.loss:.1%}",
            f"{seen.elapsed_s:.0f} s",
        ],
        cells,
    )


def lamps(facts: Facts, cells: int = _NARROW_CELLS) -> Text:
    """Draw the active warnings: the game pad's override, bumpers, battery, another commander."""
    return flow(
        [
            lamp("OVERRIDE", facts.overridden, "red"),
            lamp("FRONT BUMPER", facts.front_bumper, "red"),
            lamp("REAR BUMPER", facts.rear_bumper, "red"),
            lamp("BATTERY LOW", facts.battery_low, "yellow"),
            lamp("ANOTHER COMMANDER", facts.other_commander, "yellow"),
        ],
        cells,
        gap=" ",
    )


def _figures(figures: StreamFigures) -> list[Text | str]:
    if figures.age_s is None:
        return [Text(figures.service, "dim"), "-", "-", "-", "-"]
    stale = figures.age_s * figures.rate_hz > _STALE_PERIODS
    return [
        figures.service,
        f"{figures.rate_hz:.1f}/s",
        Text(f"{figures.age_s * 1e3:.0f} ms", "red" if stale else ""),
        Text(f"{figures.loss:.1%}", "yellow" if figures.loss > 0.0 else ""),
        f"{figures.jitter_ms:.1f} ms",
    ]


def _values(seen: Snapshot, service: str, cells: int = _NARROW_CELLS) -> RenderableType:
    if service == "iocard" and seen.iocard is not None:
        return _inputs(seen, seen.iocard)
    if service == "telemeter" and seen.telemeter is not None:
        return _distances(seen, seen.telemeter)
    if service == "battery" and seen.battery is not None:
        percent = seen.battery.remaining_percent
        style = "red" if seen.facts.battery_low else "green"
        return Text.assemble(
            bar(percent / 100.0, style), f" {percent:3d} %  {seen.battery.state_name}"
        )
    if service == "localization" and seen.localization is not None:
        return flow(_pose(seen.localization).split("  "), cells)
    if service == "differential" and seen.differential is not None:
        return flow(speeds(seen.differential).split("  "), cells)
    missing = service in (absent.name.lower() for absent in seen.facts.missing)
    return Text("not sent by the robot" if missing else "nothing yet", "dim")


def speeds(status: DifferentialStatus) -> str:
    """Show the measured speeds and the targets."""
    return (
        f"{status.current_linear_m_s:+.2f} m/s (target {status.target_linear_m_s:+.2f})  "
        f"{status.current_angular_rad_s:+.2f} rad/s (target {status.target_angular_rad_s:+.2f})"
    )


def _inputs(seen: Snapshot, status: IoCardStatus) -> Text:
    analog = (
        f"{printable(name) or index} {value:.2f}{' V' if 'olt' in name else ''}"
        for index, (name, value) in enumerate(
            zip(seen.channels.analog_inputs, status.analog_inputs, strict=False)
        )
    )
    pressed = [
        printable(name) or f"input {index}"
        for index, (name, on) in enumerate(
            zip(seen.channels.digital_inputs, status.digital_inputs, strict=False)
        )
        if on
    ]
    return Text("; ".join(analog) + "\n" + "on: " + (", ".join(pressed) or "none"))


def _named(status: TelemeterStatus) -> Iterator[tuple[str, float]]:
    for index, distance_m in enumerate(status.distances_m):
        yield (
            TELEMETER_NAMES[index] if index < len(TELEMETER_NAMES) else f"number {index}",
            distance_m,
        )


def _distances(seen: Snapshot, status: TelemeterStatus) -> Text:
    lines = []
    for index, (name, distance_m) in enumerate(_named(status)):
        reach_m = seen.reaches_m[index] if index < len(seen.reaches_m) else math.nan
        share = distance_m / reach_m if reach_m > 0.0 else 0.0
        lines.append(Text.assemble(bar(share, "cyan"), f" {distance_m:5.2f} m  {name}"))
    return Text("\n").join(lines)


def _pose(status: LocalizationStatus) -> str:
    return (
        f"x {status.x_m:.3f} m  y {status.y_m:.3f} m  theta {status.theta_rad:.3f} rad "
        f"({math.degrees(status.theta_rad):.1f}°)  {', '.join(flag_names(status.flags))}"
    )


def line(seen: Snapshot) -> str:
    """Print the same in one line, for a stdout that is not a terminal."""
    parts = [f"{seen.elapsed_s:6.1f} s  {seen.state}"]
    if seen.differential is not None:
        parts.append(
            f"{seen.differential.current_linear_m_s:+.2f} m/s "
            f"{seen.differential.current_angular_rad_s:+.2f} rad/s"
        )
    if seen.localization is not None:
        pose = seen.localization
        parts.append(f"x {pose.x_m:.2f} m y {pose.y_m:.2f} m theta {pose.theta_rad:.2f} rad")
    if seen.telemeter is not None:
        parts.append(" ".join(f"{name} {metres:.2f} m" for name, metres in _named(seen.telemeter)))
    if seen.battery is not None:
        parts.append(f"battery {seen.battery.remaining_percent} %")
    lamps = (
        ("override", seen.facts.overridden),
        ("front bumper", seen.facts.front_bumper),
        ("rear bumper", seen.facts.rear_bumper),
    )
    shown = [name if lit else f"{name} unknown" for name, lit in lamps if lit is not False]
    parts.append(", ".join(shown) or "no warning")
    parts.append(f"loss {seen.loss:.1%}")
    return "  ".join(parts)
