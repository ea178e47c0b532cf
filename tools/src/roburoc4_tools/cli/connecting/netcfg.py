# SPDX-License-Identifier: MIT
"""The dialogue with the controller's telnet console: its prompt, `netcfg`, its answer."""

from __future__ import annotations

import re
import select
import time
from collections.abc import Callable
from ipaddress import IPv4Address, IPv4Interface

from telnetlib3.telnetlib import Telnet

from ..errors import refused, unreachable
from ..output import printable

_CONNECT_S = 5.0
_WELCOME_S = 10.0
# The manual promises the confirmation "after a few seconds".
_ANSWER_S = 20.0
# After this much silence, the console waits for our input.
_QUIET_S = 1.0
_LONGEST = 20_000
_NOT_KNOWN = (
    "whether the address was changed is not known; try both, after the robot was switched off "
    "and on"
)

_PROMPT = re.compile(r"[>#$] ?\Z")
_LOGIN = re.compile(r"(login|user ?name|password) ?: ?\Z", re.IGNORECASE)
_REFUSAL = re.compile(
    r"not recogni[sz]ed|not found|unknown|error|invalid|usage|fail|cannot|denied", re.IGNORECASE
)


def set_address(
    host: str,
    port: int,
    settings: tuple[IPv4Interface, IPv4Address],
    report: Callable[[str], None],
) -> str:
    """Run netcfg on the controller, and return its confirmation in one line."""
    interface, gateway = settings
    where = f"{host}:{port}"
    report(f"1/3 open a telnet session to {where}")
    console = _open(host, port)
    try:
        report("2/3 wait for its prompt")
        try:
            _wait_for_prompt(console, where)
        except (OSError, EOFError) as error:
            raise refused(f"{_broke_off(where, error)}: nothing was changed") from None
        command = f"netcfg {interface.ip} {interface.netmask} {gateway}"
        report(f"3/3 {command}")
        try:
            return _ask(console, command, where)
        except (OSError, EOFError) as error:
            raise refused(f"{_broke_off(where, error)}: {_NOT_KNOWN}") from None
    finally:
        console.close()


def _broke_off(where: str, error: OSError | EOFError) -> str:
    return f"the telnet session to {where} broke off ({error or 'closed'})"


def _open(host: str, port: int) -> Telnet:
    try:
        return Telnet(host, port, _CONNECT_S)
    except TimeoutError:
        why = "no answer: check power, cable and address"
    except ConnectionRefusedError:
        why = "refused: that machine has no telnet console; is it the robot's controller?"
    except OSError as error:
        why = f"{error.strerror or error}: check the address, and this machine's network"
    raise unreachable(f"telnet to {host}:{port}: {why}; nothing was changed")


def _hear(console: Telnet, patience_s: float, done: Callable[[str], bool]) -> str:
    """Read until `done` accepts the output and the console is quiet, or until a timeout."""
    heard = ""
    until_s = time.monotonic() + patience_s
    while (left_s := until_s - time.monotonic()) > 0.0 and len(heard) < _LONGEST:
        wait_s = min(_QUIET_S, left_s) if done(heard) else left_s
        if not select.select([console.fileno()], [], [], wait_s)[0]:
            break
        try:
            heard += console.read_very_eager().decode("latin-1")
        except EOFError:
            if done(heard):
                break
            raise
    return heard


def _wait_for_prompt(console: Telnet, where: str) -> None:
    welcome = _hear(
        console, _WELCOME_S, lambda text: bool(_PROMPT.search(text) or _LOGIN.search(text))
    )
    if _LOGIN.search(welcome):
        raise refused(
            f"{where} asks for a login, which the robot's controller does not: log in with telnet "
            "yourself and run netcfg there, if this is the robot; nothing was changed"
        )
    if not _PROMPT.search(welcome):
        said = f"said '{_line(welcome)}'" if welcome.strip() else "said nothing"
        raise refused(f"{where} {said} and showed no prompt: is it the robot? nothing was changed")


def _ask(console: Telnet, command: str, where: str) -> str:
    console.write(command.encode("ascii") + b"\r\n")

    def answered(text: str) -> bool:
        return bool(_words(text, command)) and bool(_PROMPT.search(text))

    heard = _hear(console, _ANSWER_S, answered)
    answer = _words(heard, command)
    if not answer:
        raise refused(f"{where} did not confirm within {_ANSWER_S:g} s: {_NOT_KNOWN}")
    if not answered(heard):
        raise refused(f"{where} said '{answer}' and did not finish: {_NOT_KNOWN}")
    if _REFUSAL.search(answer):
        raise refused(f"{where} said '{answer}': {_NOT_KNOWN}")
    return answer


def _words(text: str, command: str) -> str:
    """Remove the echo of the command, and the prompt."""
    return _line(_PROMPT.sub("", text.replace(command, "", 1)).rstrip("\\ "))


def _line(text: str) -> str:
    return printable(" ".join(text.split()))
