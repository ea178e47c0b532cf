# SPDX-License-Identifier: MIT
"""The simulated controller's telnet console, with its only program, netcfg."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable

from telnetlib3 import (
    TelnetReader,
    TelnetReaderUnicode,
    TelnetWriter,
    TelnetWriterUnicode,
    create_server,
)

from ..connecting.set_ip import checked
from ..errors import CommandError

_WELCOME = "Welcome to the simulated controller: netcfg ADDRESS MASK GATEWAY, exit\r\n"
_PROMPT = "\r\n\\> "
# The real one takes a few seconds.
_WORK_S = 1.0
# Nothing here depends on the other side's abilities.
_NEGOTIATION_S = 0.1


def serve(address: str, port: int, changed: Callable[[str], None]) -> int:
    """Serve the console on a thread until the program ends; return its port (0: any free one).

    `changed` is called in that thread, with the new settings in a line.
    """

    async def converse(
        reader: TelnetReader | TelnetReaderUnicode, writer: TelnetWriter | TelnetWriterUnicode
    ) -> None:
        assert isinstance(reader, TelnetReaderUnicode)
        assert isinstance(writer, TelnetWriterUnicode)
        writer.write(_WELCOME + _PROMPT)
        while line := await reader.readline():
            words = line.split()
            if words == ["exit"]:
                break
            if words:
                writer.write(await _answer(words, changed))
            writer.write(_PROMPT)
        writer.close()

    loop = asyncio.new_event_loop()
    server = loop.run_until_complete(
        create_server(address, port, shell=converse, line_mode=True, connect_maxwait=_NEGOTIATION_S)
    )
    threading.Thread(target=loop.run_forever, daemon=True).start()
    assert server.sockets
    bound: int = server.sockets[0].getsockname()[1]
    return bound


async def _answer(words: list[str], changed: Callable[[str], None]) -> str:
    if words[0] != "netcfg":
        return f"'{words[0]}' is not recognized: netcfg ADDRESS MASK GATEWAY, exit"
    if len(words) != 4:
        return "usage: netcfg ADDRESS MASK GATEWAY"
    try:
        interface, gateway = checked(*words[1:])
    except CommandError as error:
        return f"netcfg: error: {error.message}"
    await asyncio.sleep(_WORK_S)
    settings = f"address {interface.ip}, mask {interface.netmask}, gateway {gateway}"
    changed(settings)
    return f"{settings}: stored, used after a restart"
