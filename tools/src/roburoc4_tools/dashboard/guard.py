# SPDX-License-Identifier: MIT
"""Checks requests: Host, Origin and token, and sets the headers of every answer.

A page of another site, open in the same browser, can send requests to the loopback interface. It
cannot choose their Host (which defeats DNS rebinding) nor their Origin, so both must be ours. The
WebSocket, which browsers let any site open, must have an Origin. There is no polling: everything
that is not the WebSocket is a plain GET.
"""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self' {socket}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "gamepad=(self), camera=(), microphone=(), geolocation=(), usb=()",
}
_REFUSED = 403
_GETS = ("GET", "HEAD")
_WEBSOCKET_REFUSED = 1008


@dataclass(frozen=True)
class Rules:
    """What this server accepts."""

    token: str | None = None
    names: tuple[str, ...] = ()
    """Further hosts by which it is reached, "HOST" or "HOST:PORT", such as a certificate's."""
    secure: bool = False
    """It speaks TLS itself."""


class Guard:
    """Middleware around the whole application."""

    def __init__(self, app: ASGIApp, rules: Rules) -> None:
        self._app = app
        self._rules = rules

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request pass, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        complaint = self.complaint(scope)
        if complaint and scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": _WEBSOCKET_REFUSED})
            return
        answer = PlainTextResponse(f"{complaint}\n", _REFUSED) if complaint else self._app
        await answer(scope, receive, self._with_headers(scope, send))

    # ---- requests ----

    def complaint(self, scope: Scope) -> str:
        """Return why this request is refused; empty if it is not."""
        headers = Headers(scope=scope)
        websocket = scope["type"] == "websocket"
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or hosts[0].lower() not in self._own_hosts(scope):
            return (
                "This dashboard does not go by that name: use the address that it printed, or "
                "start it with --name."
            )
        if len(origins) > 1 or (websocket and not origins):
            return "The request must have exactly one Origin."
        if origins and origins[0].lower() != f"{self._scheme}://{hosts[0].lower()}":
            return "A page of another site asks."
        if not websocket and (why := _odd_fetch(scope, headers)):
            return why
        if self._rules.token is not None and not self._has_token(scope, headers):
            return "A token is missing or wrong: open the link that the dashboard printed."
        return ""

    @property
    def _scheme(self) -> str:
        return "https" if self._rules.secure else "http"

    def _own_hosts(self, scope: Scope) -> set[str]:
        address, port = scope["server"]
        try:
            ip = ipaddress.ip_address(address.partition("%")[0])
        except ValueError:
            return set()
        ip = getattr(ip, "ipv4_mapped", None) or ip
        hosts = {f"[{ip}]" if ip.version == 6 else str(ip), *self._rules.names}
        if ip.is_loopback:
            hosts.add("localhost")
        default = 443 if self._rules.secure else 80
        return {host.lower() for host in hosts if has_port(host) or port == default} | {
            f"{host}:{port}".lower() for host in hosts if not has_port(host)
        }

    def _has_token(self, scope: Scope, headers: Headers) -> bool:
        assert self._rules.token is not None
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        shown = query.get("token", [""])[0]
        if scope["path"] == "/" and _same(shown, self._rules.token):
            scope["roburoc4.set_cookie"] = True
            return True
        try:
            cookies = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            return False
        cookie = cookies.get(self._cookie_name(scope))
        return cookie is not None and _same(cookie.value, self._pass)

    @property
    def _pass(self) -> str:
        """The cookie's value: not the token itself."""
        key = (self._rules.token or "").encode()
        return hmac.new(key, b"roburoc4 dashboard", hashlib.sha256).hexdigest()

    def _cookie_name(self, scope: Scope) -> str:
        # Cookies do not distinguish ports.
        return f"roburoc4-{scope['server'][1]}"

    # ---- answers ----

    def _with_headers(self, scope: Scope, send: Send) -> Send:
        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._add_headers(scope, MutableHeaders(scope=message))
            await send(message)

        return send_with_headers

    def _add_headers(self, scope: Scope, headers: MutableHeaders) -> None:
        host = Headers(scope=scope).get("host", "")
        socket = f"{'wss' if self._rules.secure else 'ws'}://{host}"
        # An unknown host was refused, and might contain anything.
        socket = socket if host.lower() in self._own_hosts(scope) else ""
        headers["Content-Security-Policy"] = _POLICY.format(socket=socket)
        for name, value in _HEADERS.items():
            headers[name] = value
        headers.setdefault("Cache-Control", "no-cache")
        if scope.get("roburoc4.set_cookie"):
            secure = "; Secure" if self._rules.secure else ""
            headers.append(
                "Set-Cookie",
                f"{self._cookie_name(scope)}={self._pass}; Path=/; HttpOnly; "
                f"SameSite=Strict{secure}",
            )


def _odd_fetch(scope: Scope, headers: Headers) -> str:
    if scope["method"] not in _GETS:
        return "Only GET is allowed here."
    site = headers.get("sec-fetch-site", "none")
    if site in ("none", "same-origin"):
        return ""
    # A link on another page may lead here; its scripts, frames and images may not.
    link = headers.get("sec-fetch-mode") == "navigate"
    if link and headers.get("sec-fetch-dest") == "document" and scope["path"] == "/":
        return ""
    return "A page of another site asks."


def _same(one: str, other: str) -> bool:
    return hmac.compare_digest(one.encode(), other.encode())


def has_port(host: str) -> bool:
    """Whether a host as browsers name it has a port."""
    return ":" in host.rpartition("]")[2]
