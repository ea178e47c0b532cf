# SPDX-License-Identifier: MIT
"""Who is let in: Host, Origin, token, TLS, and the headers of every answer."""

import http.client
import socket
import ssl
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from page_client import Visitor
from playwright.sync_api import Page, expect
from station import PATIENCE_S, Station, ready
from websockets.exceptions import InvalidStatus

from roburoc4_tools.dashboard.guard import Guard, Rules
from roburoc4_tools.dashboard.server import Place

Make = Callable[..., Station]
TOKEN = "a-token-of-these-tests"
HERE = ("127.0.0.1", 8400)
HOST = "127.0.0.1:8400"


async def nothing(*_: object) -> None:
    pass


def passes(
    rules: Rules | None = None,
    server: tuple[str, int] = HERE,
    kind: str = "http",
    path: str = "/static/main.js",
    method: str = "GET",
    query: str = "",
    **headers: str,
) -> bool:
    """Whether a request with these headers passes; the Host is the right one if none is given."""
    named = {"Host": HOST} | {name.replace("_", "-"): value for name, value in headers.items()}
    pairs = [(name.lower().encode(), value.encode()) for name, value in named.items()]
    request = {"type": kind, "method": method, "path": path, "server": server, "headers": pairs}
    guard = Guard(nothing, rules or Rules())
    return guard.complaint(request | {"query_string": query.encode()}) == ""


@pytest.mark.parametrize(
    ("server", "secure", "host", "fine"),
    [
        (HERE, False, HOST, True),
        (HERE, False, "localhost:8400", True),
        (HERE, False, "127.0.0.1", False),
        (HERE, False, "127.0.0.1.evil.example:8400", False),
        (HERE, False, "192.168.0.10:8400", False),
        (HERE, False, "", False),
        (("::1", 8400), False, "[::1]:8400", True),
        (("::1", 8400), False, "[::2]:8400", False),
        (("::ffff:127.0.0.1", 8400), False, HOST, True),
        (("192.168.0.10", 8400), False, "192.168.0.10:8400", True),
        (("192.168.0.10", 8400), False, "localhost:8400", False),
        (HERE, False, "LAB-PC:8400", True),
        (HERE, False, "proxy.example:99", True),
        (HERE, False, "proxy.example:8400", False),
        (("127.0.0.1", 80), False, "127.0.0.1", True),
        (("127.0.0.1", 80), True, "127.0.0.1", False),
        (("127.0.0.1", 443), True, "127.0.0.1", True),
    ],
)
def test_it_goes_by_its_own_names_only(
    server: tuple[str, int], secure: bool, host: str, fine: bool
) -> None:
    rules = Rules(None, ("lab-pc", "proxy.example:99"), secure)
    origin = f"{'https' if secure else 'http'}://{host}"
    assert passes(rules, server, Host=host, Origin=origin) is fine


def test_another_origin_is_refused() -> None:
    for kind in ("http", "websocket"):
        assert passes(kind=kind, Origin=f"http://{HOST}")
        for origin in (
            "http://evil.example",
            "http://evil.example:8400",
            f"https://{HOST}",
            "http://localhost:8400",
            "http://127.0.0.1",
            "null",
            "",
        ):
            assert not passes(kind=kind, Origin=origin), origin
    assert not passes(kind="websocket"), "any program that is no browser could drive"


def test_other_sites_may_link_and_neither_script_nor_frame_nor_post() -> None:
    for site in ("cross-site", "same-site"):
        assert not passes(Sec_Fetch_Site=site, Sec_Fetch_Mode="no-cors", Sec_Fetch_Dest="script")
        for dest in ("iframe", "document"):
            fetch = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "navigate", "Sec_Fetch_Dest": dest}
            assert passes(path="/", **fetch) is (dest == "document")
    assert not passes(method="POST")


def test_nothing_is_given_without_the_token() -> None:
    rules = Rules(TOKEN)
    assert passes(rules, path="/", query=f"token={TOKEN}")
    for kind, path, query, cookie in (
        ("http", "/", "", ""),
        ("http", "/", "token=", ""),
        ("http", "/", f"token={TOKEN}x", ""),
        ("http", "/static/main.js", f"token={TOKEN}", ""),
        ("http", "/", "", f"roburoc4-8400={TOKEN}"),
        ("websocket", "/socket", f"token={TOKEN}", "roburoc4-8400=wrong"),
    ):
        origin = f"http://{HOST}"
        assert not passes(rules, kind=kind, path=path, query=query, Cookie=cookie, Origin=origin)


def get(here: Station, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", here.port, timeout=10)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def test_every_answer_is_guarded_and_has_the_security_headers(station: Make) -> None:
    here = station()
    for path, host, status in (
        ("/", "127.0.0.1", 200),
        ("/static/main.js", "127.0.0.1", 200),
        ("/x", "127.0.0.1", 404),
        ("/", "evil", 403),
        ("/recording.csv", "evil", 403),
    ):
        answer = get(here, path, Host=f"{host}:{here.port}")
        assert answer.status == status
        policy = answer.getheader("Content-Security-Policy", "")
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert "evil" not in policy
        assert answer.getheader("X-Content-Type-Options") == "nosniff"
        assert answer.getheader("Referrer-Policy") == "no-referrer"
        assert answer.getheader("Cross-Origin-Resource-Policy") == "same-origin"
        assert answer.getheader("Server") is None
    with pytest.raises(InvalidStatus, match="403"):
        Visitor(here, origin="http://evil.example")
    assert not here.hub.pages


def test_a_bad_handshake_is_closed_and_leaves_no_traceback(
    station: Make, caplog: pytest.LogCaptureFixture
) -> None:
    here = station()
    lines = [
        "GET /socket HTTP/1.1",
        f"Host: 127.0.0.1:{here.port}",
        f"Origin: http://127.0.0.1:{here.port}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
    ]
    for header in ("Sec-WebSocket-Protocol: \x01", "Cookie: \x7f"):
        with socket.create_connection(("127.0.0.1", here.port), PATIENCE_S) as bad:
            bad.sendall("\r\n".join([*lines, header, "", ""]).encode())
            assert bad.recv(1000) == b""
    with socket.create_connection(("127.0.0.1", here.port), PATIENCE_S) as bad:
        bad.sendall("\r\n".join([*lines, "", ""]).encode())
        assert bad.recv(1000).startswith(b"HTTP/1.1 101")
        bad.sendall(b"\x81\x82\0\0\0\0\xff\xff")  # a text that is not UTF-8
        while bad.recv(10000):
            pass
    here.stop_serving()
    assert not any(record.exc_info for record in caplog.records)


def test_the_link_opens_the_page_and_hides_its_token(
    station: Make, visit: Callable[..., Page], tmp_path: Path
) -> None:
    certificate, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"),
            *("-nodes", "-days", "2", "-subj", "/CN=127.0.0.1"),
            *("-addext", "subjectAltName=IP:127.0.0.1", "-out", certificate, "-keyout", key),
        ],
        check=True,
        capture_output=True,
    )
    place = Place(certificate=certificate, key=key)
    here = station(place=place, rules=Rules(TOKEN, secure=True))
    page = visit(f"{here.url}?token={TOKEN}", ignore_https_errors=True, forgive="403")
    ready(page)
    assert TOKEN not in page.url
    cookie = page.context.cookies()[0]
    assert (cookie["httpOnly"], cookie["secure"], cookie["sameSite"]) == (True, True, "Strict")
    assert TOKEN not in cookie["value"]
    page.reload()
    ready(page)
    context = ssl.create_default_context(cafile=certificate)
    connection = http.client.HTTPSConnection("127.0.0.1", here.port, context=context, timeout=10)
    connection.request("GET", "/")
    assert connection.getresponse().status == 403  # trusted, but without the token
    connection.close()
    here.stop_serving()
    station(
        place=Place("127.0.0.1", here.port, certificate, key), rules=Rules("another", secure=True)
    )
    expect(page.locator("#banner-text")).to_contain_text("open the link that the dashboard printed")
