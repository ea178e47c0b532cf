# SPDX-License-Identifier: MIT
"""`roburoc4 info`: shows what the robot reports about itself."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from .. import session
from ..errors import ExitCode
from ..names import TELEMETER_NAMES, flag_names, names_of
from ..options import Options, add_robot
from ..output import console, note, print_json, printable

if TYPE_CHECKING:
    from roburoc4 import Robot
    from roburoc4.records import ChannelNames, Properties

_NEXT_TEXT_S = 4.0  # texts are requested several times; by then a robot that has one has answered


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "info",
        help="show services, properties and the names of inputs and outputs",
        description="Show what the robot reports about itself: its services, their properties, and "
        "the names of its inputs and outputs.",
    )
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Ask for everything, and print it."""
    with session.connected(options) as robot:
        _wait_for_descriptions(robot)
        address, properties, channels = robot.address, robot.properties, names_of(robot)
        missing = [service.name.lower() for service in robot.facts.missing]
    if options.json:
        print_json({**_document(address, properties, channels), "missing": missing})
    else:
        _print(address, properties, channels)
        if missing:
            note(f"{address} sends no {', '.join(missing)} statuses: run roburoc4 doctor")
    return ExitCode.FINE


def _wait_for_descriptions(robot: Robot) -> None:
    from roburoc4 import Event, RobotTimeoutError

    while not robot.facts.descriptions_done:
        try:
            robot.wait_for(Event.DESCRIPTION | Event.DESCRIPTIONS_DONE, timeout=_NEXT_TEXT_S)
        except RobotTimeoutError:
            if not robot.facts.descriptions_done:
                note(
                    f"{robot.address} sends no more texts: the manual's names replace those "
                    "that are missing"
                )
            return


def _document(address: str, properties: Properties, channels: ChannelNames) -> dict[str, Any]:
    listed = {entry.service for entry in properties.services}
    return {
        "robot": address,
        "services": properties.services,
        "iocard": properties.iocard,
        "telemeter": properties.telemeter if "telemeter" in listed else None,
        "battery": properties.battery,
        "localization": properties.localization,
        "differential": properties.differential,
        "channels": channels,
    }


def _print(address: str, properties: Properties, channels: ChannelNames) -> None:
    screen = console()
    screen.print(f"robot at {address}", style="bold", markup=False)
    for title, rows in _sections(properties, channels):
        screen.print(f"\n{title}", style="bold", markup=False)
        width = max((len(name) for name, _ in rows), default=0)
        for name, value in rows:
            screen.print(f"  {name:<{width}}  {value}", markup=False, soft_wrap=True)


def _sections(
    properties: Properties, channels: ChannelNames
) -> list[tuple[str, list[tuple[str, str]]]]:
    services = [
        (
            f"{entry.id}",
            f"{printable(entry.name) or '(no name)'}  type 0x{entry.type:04x}  "
            f"{entry.service or ''}",
        )
        for entry in properties.services
    ]
    sections = [("services", services)]
    if properties.iocard is not None:
        sections.append(("iocard", _fields(properties.iocard)))
    for index, telemeter in enumerate(properties.telemeter):
        name = TELEMETER_NAMES[index] if index < len(TELEMETER_NAMES) else ""
        sections.append((f"telemeter {index} {name}".rstrip(), _fields(telemeter)))
    for title in ("battery", "localization", "differential"):
        record = getattr(properties, title)
        if record is not None:
            sections.append((title, _fields(record)))
    for title, names in channels._asdict().items():
        rows = [(f"{index}", printable(name) or "(no name)") for index, name in enumerate(names)]
        sections.append((title.replace("_", " "), rows or [("none", "")]))
    return sections


_UNITS = {
    "_m_s2": "m/s²",
    "_rad_s2": "rad/s²",
    "_m_s": "m/s",
    "_rad_s": "rad/s",
    "_rad": "rad",
    "_m": "m",
    "_v": "V",
    "_ah": "Ah",
    "_percent": "%",
}


def _fields(record: Any) -> list[tuple[str, str]]:
    return [_field(name, value) for name, value in record._asdict().items()]


def _field(name: str, value: float) -> tuple[str, str]:
    if name == "flags":
        return name, f"{int(value)} ({', '.join(flag_names(int(value))) or 'none'})"
    for suffix, unit in _UNITS.items():
        if name.endswith(suffix):
            text = f"{value:.6g} {unit}"
            if unit == "rad" and math.isfinite(value):
                text += f" ({math.degrees(value):.1f}°)"
            name = name.removesuffix(suffix).replace("_", " ")
            return name + (" acceleration" if unit.endswith("s²") else ""), text
    return name.replace("_", " "), f"{value}"
