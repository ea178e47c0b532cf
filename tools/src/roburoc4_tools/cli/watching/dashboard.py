# SPDX-License-Identifier: MIT
"""`roburoc4 dashboard`: the operator station in a browser."""

from __future__ import annotations

import argparse
import contextlib
import html
import ipaddress
import json
import os
import re
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...terminal.signals import unsuspendable
from ..errors import ExitCode, refused, unreachable, usage
from ..options import DEFAULT_ROBOT, Options, number, whole
from ..output import note
from ..session import note_recording, recording

if TYPE_CHECKING:
    from roburoc4 import Robot, Simulator

    from ...dashboard.guard import Rules
    from ...dashboard.hub import Hub
    from ...dashboard.server import Place

_PORT = 8400
_LEASE_MS = 250
_CEILING_LINEAR_M_S = 1.0
_CEILING_ANGULAR_RAD_S = 1.0
_SHORTEST_TOKEN = 16
_FREE_TOKEN = ""
_SLOWEST_DRIVEN_MS = 100
"""To arm, statuses must not be older than 300 ms; one may get lost."""
_NAME = re.compile(r"([\w.-]+|\[[0-9a-f:]+\])(:\d{1,5})?", re.ASCII | re.IGNORECASE)
_ROBOT_NAME = re.compile(r"[\w-]{1,20}", re.ASCII)
_CAMERA = re.compile(r"https?://[\w.:\[\]-]+(/[^\s;,'\"]*)?", re.ASCII)
_DESKTOPS = ("DISPLAY", "WAYLAND_DISPLAY")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "dashboard",
        help="watch and drive the robot in a browser",
        description="Serve a page that shows the robot and, with --enable-drive, drives it by game "
        "pad, stick or keyboard. Needs roburoc4-tools[dashboard]. Read docs/dashboard.md and "
        "docs/SAFETY.md before you drive a robot.",
    )
    parser.add_argument("--sim", action="store_true", help="start a simulator, with its panel")
    _add_driving(parser)
    _add_serving(parser)
    _add_seen(parser)
    parser.set_defaults(run=run)


def _add_seen(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--robot",
        dest="robots",
        metavar="[NAME=]HOST[:PORT]",
        action="append",
        help="the robot's address; several named robots are shown on one map, and the "
        f"chosen is driven (default: $ROBUROC4_ROBOT, else {DEFAULT_ROBOT})",
    )
    parser.add_argument(
        "--camera",
        metavar="NAME=URL",
        action="append",
        default=[],
        help="show the pictures (MJPEG) of a camera server of yours beside the map",
    )
    parser.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")


def _add_driving(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("driving")
    group.add_argument(
        "--robot-file",
        metavar="FILE",
        help="what roburoc4 first-contact or calibrate wrote for this robot",
    )
    group.add_argument("--enable-drive", action="store_true", help="let one page at a time drive")
    group.add_argument(
        "--max-linear-m-s",
        metavar="M_S",
        type=number(0.01, 5.0, "m/s"),
        default=_CEILING_LINEAR_M_S,
        help="speed at full deflection, at most the robot's own limit (default: 1 m/s)",
    )
    group.add_argument(
        "--max-angular-rad-s",
        metavar="RAD_S",
        type=number(0.01, 10.0, "rad/s"),
        default=_CEILING_ANGULAR_RAD_S,
        help="turn rate at full deflection, likewise (default: 1 rad/s)",
    )
    group.add_argument(
        "--lease-ms",
        metavar="MS",
        type=whole(100, 1000, "milliseconds"),
        default=_LEASE_MS,
        help="the robot stops this long after the driver's page last saw it (default: 250)",
    )
    group.add_argument(
        "--allow-unknown-override",
        action="store_true",
        help="drive although the robot does not report whether its game pad is in use",
    )
    group.add_argument(
        "--period-ms",
        metavar="MS",
        type=whole(10, 2550, "milliseconds"),
        help="period of all statuses, a multiple of 10; to drive, at most 100 (default: 50 to 1000 "
        "by service)",
    )


def _add_serving(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("serving")
    group.add_argument(
        "--port",
        metavar="N",
        type=whole(0, 65535, "a port"),
        default=_PORT,
        help="port to serve at, 0 for a free one (default: 8400)",
    )
    group.add_argument(
        "--bind",
        metavar="ADDRESS",
        default="127.0.0.1",
        help="address to serve at; any but loopback needs --token",
    )
    group.add_argument(
        "--token",
        nargs="?",
        const=_FREE_TOKEN,
        metavar="TEXT",
        help="require the printed link; TEXT (other users of this computer "
        "can read it), else $ROBUROC4_TOKEN, else a new one at every start",
    )
    group.add_argument("--tls-cert", metavar="FILE", help="serve https with this certificate (PEM)")
    group.add_argument("--tls-key", metavar="FILE", help="and its key (PEM)")
    group.add_argument(
        "--name",
        metavar="HOST[:PORT]",
        action="append",
        default=[],
        help="another name of this computer, such as the certificate's; the first is in the link",
    )
    group.add_argument("--no-open", action="store_true", help="do not open a browser")


def run(options: Options) -> int:
    """Serve until Ctrl-C."""
    from ...dashboard import server
    from ...dashboard.guard import Rules

    place = _place(options, server.Place)
    cameras = _cameras(options)
    rules = Rules(_token(options, place.loopback), _names(options), place.secure)
    try:
        server.check_certificate(place)
        opened = server.listen(place)
    except server.ServeError as error:
        raise usage(str(error)) from None
    named = _named(options)
    keep_awake = unsuspendable() if options.enable_drive else contextlib.nullcontext()
    link = server.link(place, opened, rules)
    with opened, keep_awake, _simulator(options) as simulator, contextlib.ExitStack() as robots:
        if simulator is not None:
            named = {"": simulator.address}
        hubs = [
            _hub(options, name, robots.enter_context(_robot(options, address)), simulator, cameras)
            for name, address in named.items()
        ]
        _print_link(options, link)
        opens = not options.no_open and _has_desktop()
        with _private(link) if opens else contextlib.nullcontext() as to_open:
            _serve(to_open, place, rules, opened, hubs)
    return ExitCode.FINE


def _hub(
    options: Options,
    name: str,
    robot: Robot,
    simulator: Simulator | None,
    cameras: list[tuple[str, str]],
) -> Hub:
    from ...dashboard.camera import Camera
    from ...dashboard.hub import Hub
    from ...dashboard.panel import Panel

    return Hub(
        robot,
        options.lease_ms / 1000,
        (options.max_linear_m_s, options.max_angular_rad_s),
        enable_drive=options.enable_drive,
        panel=None if simulator is None else Panel(simulator),
        name=name,
        cameras=[Camera(*camera) for camera in cameras],
    )


def _serve(to_open: str | None, place: Place, rules: Rules, opened: Any, hubs: list[Hub]) -> None:
    from ...dashboard.fleet import Fleet
    from ...dashboard.server import make_server

    fleet = Fleet(hubs)

    def open_it() -> None:
        if to_open is not None:
            threading.Thread(target=_open, args=(to_open,), daemon=True).start()

    make_server(fleet, place, rules, open_it).run(sockets=[opened])
    if fleet.failure is not None:
        raise fleet.failure


def _print_link(options: Options, link: str) -> None:
    """Print warnings and, on stdout, the link."""
    if ipaddress.ip_address(options.bind).is_unspecified and not options.name:
        note("from another machine, use this computer's address instead of localhost")
    if options.token:
        note("other users of this computer can read --token TEXT: put it into $ROBUROC4_TOKEN")
    if options.enable_drive and not options.sim:
        note("a page can drive the robot (140 kg): keep an emergency stop in your hand")
    text = json.dumps({"link": link}) if options.json else f"roburoc4: dashboard at {link}"
    print(text, flush=True)


@contextlib.contextmanager
def _private(link: str) -> Iterator[str]:
    """Return what to pass to a browser. Its command line is public, so the token is not in it."""
    if "?token=" not in link:
        yield link
        return
    with tempfile.TemporaryDirectory(prefix="roburoc4-") as folder:  # readable by this user only
        page = Path(folder, "open.html")
        target = html.escape(link)
        page.write_text(
            f'<!doctype html><meta http-equiv="refresh" content="0; url={target}">'
            f'<a href="{target}">the dashboard</a>\n',
            encoding="utf-8",
        )
        page.chmod(0o600)
        yield page.as_uri()


def _open(link: str) -> None:
    import webbrowser

    if not webbrowser.open(link):
        note("no browser could be started: open the link yourself")


def _has_desktop() -> bool:
    return sys.platform in ("win32", "darwin") or any(os.environ.get(name) for name in _DESKTOPS)


def _place(options: Options, make: type[Place]) -> Place:
    try:
        ipaddress.ip_address(options.bind)
    except ValueError:
        raise usage(
            f"--bind: '{options.bind}' is not an address: give a numeric address of this computer, "
            "such as 192.168.0.10, or 0.0.0.0 for all"
        ) from None
    given = options.robots or [options.robot]
    if options.sim and given not in ([DEFAULT_ROBOT], [os.environ.get("ROBUROC4_ROBOT")]):
        raise usage(f"--sim starts its own robot: omit --robot {given[0]} or --sim")
    if (options.tls_cert is None) != (options.tls_key is None):
        raise usage("--tls-cert and --tls-key go together: give both")
    if options.period_ms is not None and options.period_ms % 10:
        raise usage(f"--period-ms: {options.period_ms} is not a multiple of 10")
    if options.enable_drive and (options.period_ms or 0) > _SLOWEST_DRIVEN_MS:
        raise usage(
            f"--period-ms: at {options.period_ms} the statuses are too old for driving: give "
            f"{_SLOWEST_DRIVEN_MS} or less, or omit --enable-drive"
        )
    return make(options.bind, options.port, options.tls_cert, options.tls_key)


def _names(options: Options) -> tuple[str, ...]:
    for name in options.name:
        if not _NAME.fullmatch(name):
            raise usage(f"--name: '{name}' is not a host name: give one as lab-pc or lab-pc:8400")
    return tuple(options.name)


def _named(options: Options) -> dict[str, str]:
    """Return the addresses of the robots by name; one alone needs none."""
    given = options.robots or [options.robot]
    if len(given) == 1 and "=" not in given[0]:
        return {"": given[0]}
    named = {}
    for text in given:
        name, _, address = text.partition("=")
        if not (_ROBOT_NAME.fullmatch(name) and address):
            raise usage(f"--robot: '{text}' has no name: give several as RED=192.168.0.2")
        if name in named:
            raise usage(f"--robot: two are called {name}: give each its own name")
        named[name] = address
    return named


def _cameras(options: Options) -> list[tuple[str, str]]:
    cameras = []
    for text in options.camera:
        name, _, url = text.partition("=")
        if not (name.isprintable() and name and _CAMERA.fullmatch(url)):
            raise usage(
                f"--camera: '{text}' is not a name and URL: give one as "
                "front=http://192.168.0.20:8080/stream.mjpg"
            )
        cameras.append((name, url))
    return cameras


def _token(options: Options, loopback: bool) -> str | None:
    if options.token is None:
        if not loopback:
            raise usage(
                f"--bind {options.bind} is open to others: add --token, and open the link that is "
                "printed"
            )
        return None
    import secrets

    token = options.token or os.environ.get("ROBUROC4_TOKEN") or secrets.token_urlsafe(24)
    safe = token.isascii() and all(c.isalnum() or c in "-_.~" for c in token)
    if len(token) < _SHORTEST_TOKEN or not safe:
        raise usage(
            f"--token: give {_SHORTEST_TOKEN} or more letters, digits, - _ . ~, or no text at all "
            "for a new one at every start"
        )
    return token


@contextlib.contextmanager
def _simulator(options: Options) -> Iterator[Simulator | None]:
    if not options.sim:
        yield None
        return
    from roburoc4 import Simulator

    with Simulator(port=0) as simulator:
        yield simulator


@contextlib.contextmanager
def _robot(options: Options, address: str) -> Iterator[Robot]:
    """Connect without waiting: the page shows the progress."""
    from roburoc4 import ArgumentError, NetworkError, connect
    from roburoc4.protocol import STATUS_SERVICES
    from roburoc4.settings import Settings

    settings: Settings = {
        "lease_ms": options.lease_ms,
        "max_linear_m_s": options.max_linear_m_s,
        "max_angular_rad_s": options.max_angular_rad_s,
    }
    if options.allow_unknown_override:
        settings["allow_unknown_override"] = True
    if options.robot_file is not None:
        settings["robot_file"] = options.robot_file
    try:
        robot = connect(address, wait=False, **settings, **recording())
    except ArgumentError as error:
        raise usage(f"--robot: {error}") from None
    except NetworkError as error:
        raise unreachable(f"--robot: {error}") from None
    except OSError as error:
        raise refused(f"{error.filename}: no recording can be made: {error.strerror}") from None
    with robot:
        note_recording(robot)
        if (
            options.period_ms is not None
        ):  # not a setting: settings must be short enough for driving
            for service in STATUS_SERVICES:
                robot.subscribe(service, options.period_ms)
        yield robot
