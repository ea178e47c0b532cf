# SPDX-License-Identifier: MIT
"""The socket, TLS, and the shutdown."""

from __future__ import annotations

import contextlib
import ipaddress
import logging
import signal
import socket
import ssl
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import uvicorn
from websockets.exceptions import InvalidState

from .app import application
from .fleet import Fleet
from .guard import Rules, has_port

_PING_S = 5.0
_END_S = 1
_LONGEST_MESSAGE = 4096
# Uvicorn handles SIGINT and SIGTERM. An exception, as the command raises for these, would end only
# the callback that runs in the loop, not the program.
_MORE_SIGNALS = [getattr(signal, name) for name in ("SIGHUP", "SIGQUIT") if hasattr(signal, name)]


class ServeError(Exception):
    """Why it cannot be served like this, and what to do."""


@dataclass(frozen=True)
class Place:
    """Where the dashboard is served."""

    bind: str = "127.0.0.1"
    port: int = 0
    certificate: str | None = None
    key: str | None = None

    @property
    def loopback(self) -> bool:
        """Whether only this machine reaches it."""
        return ipaddress.ip_address(self.bind).is_loopback

    @property
    def secure(self) -> bool:
        """Whether it speaks TLS."""
        return self.certificate is not None


def listen(place: Place) -> socket.socket:
    """Open the socket, or raise with the reason."""
    version = ipaddress.ip_address(place.bind).version
    family = socket.AF_INET6 if version == 6 else socket.AF_INET
    try:
        return socket.create_server((place.bind, place.port), family=family, backlog=64)
    except OSError as error:
        raise ServeError(
            f"--bind {place.bind} --port {place.port}: {error.strerror or error}; choose another "
            "port (0 takes a free one), or an address that this computer has"
        ) from None


def check_certificate(place: Place) -> None:
    """Load certificate and key once, to report here what is wrong with them."""
    if not place.secure:
        return
    try:
        ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(
            str(place.certificate), place.key, password=_no_password
        )
    except (OSError, ValueError) as error:  # an SSLError is an OSError
        reason = getattr(error, "strerror", None) or error
        raise ServeError(
            f"--tls-cert {place.certificate} --tls-key {place.key}: {reason}; give a certificate "
            "and its key as PEM files, the key without a password"
        ) from None


def _no_password() -> str:
    raise ValueError("the key asks for a password")


def link(place: Place, opened: socket.socket, rules: Rules) -> str:
    """Return the URL to open in a browser, with the first name from --name if there is one."""
    address, port = opened.getsockname()[:2]
    ip = ipaddress.ip_address(address)
    host = "localhost" if ip.is_unspecified else (f"[{ip}]" if ip.version == 6 else str(ip))
    host = rules.names[0] if rules.names else host
    where = host if has_port(host) else f"{host}:{port}"
    query = "" if rules.token is None else f"?token={rules.token}"
    return f"{'https' if place.secure else 'http'}://{where}/{query}"


def _patient(protocol: Any) -> Any:
    """Make uvicorn's WebSocket end quietly if a page is just leaving, or never was a page."""

    class Patient(protocol):  # type: ignore[misc]
        def data_received(self, data: bytes) -> None:
            super().data_received(data)
            if self.conn.handshake_exc is not None and not self.handshake_initiated:
                self.transport.close()  # nothing would ever answer it

        def shutdown(self) -> None:
            try:
                super().shutdown()
            except (InvalidState, AssertionError):
                self.transport.close()

    return Patient


def _shorten(record: logging.LogRecord) -> bool:
    """Log in one line what a client sent that is no text: a traceback looks like our mistake."""
    if "UTF-8" in record.getMessage():
        record.exc_info = None
    return True


class Server(uvicorn.Server):
    """A server that reports when it is ready, and stops the robot before it ends."""

    def __init__(self, config: uvicorn.Config, fleet: Fleet, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._fleet = fleet
        self._on_ready = on_ready

    def run(self, sockets: list[socket.socket] | None = None) -> None:
        """Serve. A signal counts before the loop runs, which would lose the exception."""
        with self.capture_signals():
            super().run(sockets)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve."""
        await super().startup(sockets)
        if self.started:
            self._on_ready()

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Also end on these signals; the command gets them once everything is closed."""
        with super().capture_signals():
            before = {}
            if threading.current_thread() is threading.main_thread():
                for number in _MORE_SIGNALS:
                    if signal.getsignal(number) is not signal.SIG_IGN:
                        before[number] = signal.signal(number, self.handle_exit)
            try:
                yield
            finally:
                for number, handler in before.items():
                    signal.signal(number, handler)

    async def on_tick(self, counter: int) -> bool:
        """Whether to end: on request, or when no more frames can be made."""
        return await super().on_tick(counter) or self._fleet.failure is not None

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End: first stop the robots, then close the connections."""
        self._fleet.close()
        await super().shutdown(sockets)


def make_server(fleet: Fleet, place: Place, rules: Rules, on_ready: Callable[[], None]) -> Server:
    """Make a server; its ``run(sockets=[...])`` serves until Ctrl-C or ``should_exit``."""
    config = uvicorn.Config(
        application(fleet, rules),
        loop="asyncio",
        http="h11",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws="websockets-sansio",
        ws_max_size=_LONGEST_MESSAGE,
        ws_ping_interval=_PING_S,
        ws_ping_timeout=_PING_S,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=_END_S,
        ssl_certfile=place.certificate,
        ssl_keyfile=place.key,
        lifespan="on",
    )
    config.load()
    logging.getLogger("uvicorn.error").addFilter(_shorten)
    config.ws_protocol_class = _patient(config.ws_protocol_class)
    return Server(config, fleet, on_ready)
