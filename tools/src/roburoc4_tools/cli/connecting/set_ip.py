# SPDX-License-Identifier: MIT
"""`roburoc4 set-ip`: the procedure of manual section 5.3 to change the robot's address."""

from __future__ import annotations

import argparse
import sys
from ipaddress import AddressValueError, IPv4Address, IPv4Interface, IPv4Network, NetmaskValueError

from ..errors import ExitCode, unreachable, usage
from ..options import Options, add_robot, whole
from ..output import note, print_json, printable
from ..session import address_of

TELNET_PORT = 23


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "set-ip",
        help="give the robot another IP address",
        description="Open a telnet session to the robot's controller and run its netcfg there. The "
        "new settings take effect when the robot is switched off and on.",
        epilog="example: roburoc4 set-ip 10.0.0.10 255.0.0.0 10.0.0.1",
    )
    parser.add_argument("address", metavar="ADDRESS", help="the robot's new address")
    parser.add_argument("mask", metavar="MASK", help="its network's mask, as 255.255.255.0")
    parser.add_argument("gateway", metavar="GATEWAY", help="its gateway, in the same network")
    parser.add_argument(
        "--telnet-port",
        metavar="PORT",
        type=whole(1, 65535, "a port"),
        default=TELNET_PORT,
        help=f"telnet port (default: {TELNET_PORT})",
    )
    parser.add_argument("--yes", "-y", action="store_true", help="do not ask")
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Check, ask, change, and print what comes next."""
    settings = checked(options.address, options.mask, options.gateway)
    host = _host(options.robot)
    _confirm(options, host, settings)

    from .netcfg import set_address

    answer = set_address(host, options.telnet_port, settings, note)
    if options.json:
        print_json(
            {
                "robot": host,
                "address": str(settings[0].ip),
                "mask": str(settings[0].netmask),
                "gateway": str(settings[1]),
                "answer": answer,
            }
        )
        return ExitCode.FINE
    address = settings[0]
    print(f"the controller says: {printable(answer)}")
    print("now switch the robot off and on: until then it keeps its old address")
    print(f"then give this machine an address in {address.network}, and try")
    print(f"  roburoc4 doctor --robot {address.ip}")
    return ExitCode.FINE


def checked(address: str, mask: str, gateway: str) -> tuple[IPv4Interface, IPv4Address]:
    """Reject settings that would make the robot unreachable."""
    host = _address("ADDRESS", address)
    way_out = _address("GATEWAY", gateway)
    try:
        network = IPv4Network(f"0.0.0.0/{mask}") if "." in mask else None
    except (AddressValueError, NetmaskValueError, ValueError):
        network = None
    if network is None or str(network.netmask) != mask or not 1 <= network.prefixlen <= 30:
        raise usage(
            f"MASK '{mask}' is not valid: give 128.0.0.0 to 255.255.255.252, such as 255.255.255.0"
        )
    interface = IPv4Interface(f"{host}/{mask}")
    for name, value in (("ADDRESS", host), ("GATEWAY", way_out)):
        if value in (interface.network.network_address, interface.network.broadcast_address):
            raise usage(
                f"{name} {value} is the network or broadcast address of {interface.network}: "
                "give a host's"
            )
    if way_out not in interface.network:
        raise usage(f"GATEWAY {way_out} is not in {interface.network}, the network of {host}")
    if way_out == host:
        raise usage(f"GATEWAY {way_out} is the robot itself: give another, used or not")
    return interface, way_out


def _address(name: str, text: str) -> IPv4Address:
    try:
        address = IPv4Address(text)
    except AddressValueError:
        raise usage(f"{name} '{text}' is not an IPv4 address: give one as 10.0.0.10") from None
    if address.is_multicast or address.is_reserved or address.is_unspecified or address.is_loopback:
        raise usage(f"{name} {address} cannot be a host's on a network: give one as 10.0.0.10")
    return address


def _host(robot: str) -> str:
    """Leave out the port of `--robot`, which is not telnet's."""
    from roburoc4 import ArgumentError, NetworkError

    try:
        address = address_of(robot)
    except ArgumentError as error:
        raise usage(f"--robot: {error}") from None
    except NetworkError as error:
        raise unreachable(str(error)) from None
    return address.rpartition(":")[0].strip("[]")


def _confirm(options: Options, host: str, settings: tuple[IPv4Interface, IPv4Address]) -> None:
    """Let a person decide: a wrong address can only be corrected at the robot."""
    if options.yes:
        return
    if not sys.stdin.isatty():
        raise usage("a new address must be confirmed: give --yes, or use a terminal")
    interface, gateway = settings
    print(
        f"Change the address of the robot at {host} to {interface.ip}, mask {interface.netmask}, "
        f"gateway {gateway}? After a restart it answers there only. [y/N] ",
        end="",
        file=sys.stderr,
        flush=True,
    )
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise usage("not confirmed: nothing was changed; answer y, or give --yes")
