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
PATHS = ("/", "/static/main.js", "/static/vendor/uplot/uPlot.iife.min.js", "/nothing")


def get(
    station: Station, path: str, method: str = "GET", **headers: str
) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", station.port, timeout=10)
    names = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.putrequest(method, path, skip_host="Host" in names)
    for name, value in names.items():
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


@pytest.mark.parametrize("path", PATHS)
def test_another_host_is_refused_everywhere(path: str, station: Make) -> None:
    here = station()
    assert get(here, path).status == (404 if path == "/nothing" else 200)
    assert get(here, path, Host=f"localhost:{here.port}").status != 403
    for host in (
        "evil.example",
        f"evil.example:{here.port}",
        "127.0.0.1",
        "127.0.0.1:1",
        f"127.0.0.1.evil.example:{here.port}",
        f"192.168.0.10:{here.port}",
        "",
    ):
        assert get(here, path, Host=host).status in (400, 403), host


@pytest.mark.parametrize("path", PATHS)
def test_another_origin_is_refused_everywhere(path: str, station: Make) -> None:
    here = station()
    assert get(here, path, Origin=f"http://127.0.0.1:{here.port}").status != 403
    for origin in (
        "http://evil.example",
        f"http://evil.example:{here.port}",
        f"https://127.0.0.1:{here.port}",
        f"http://localhost:{here.port}",
        "http://127.0.0.1",
        "null",
        "",
    ):
        assert get(here, path, Origin=origin).status == 403, origin


def test_other_sites_may_link_and_neither_script_nor_frame(station: Make) -> None:
    here = station()
    for site in ("cross-site", "same-site"):
        fetch = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "no-cors", "Sec_Fetch_Dest": "script"}
        assert get(here, "/static/main.js", **fetch).status == 403
        frame = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "navigate", "Sec_Fetch_Dest": "iframe"}
        assert get(here, "/", **frame).status == 403
        link = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "navigate", "Sec_Fetch_Dest": "document"}
        assert get(here, "/", **link).status == 200


def test_nothing_takes_anything_but_get(station: Make) -> None:
    here = station()
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
        assert get(here, "/", method).status == 403


@pytest.mark.parametrize(
    "origin", [None, "http://evil.example", "null", "http://127.0.0.1", "https://127.0.0.1:{port}"]
)
def test_a_websocket_of_another_origin_is_refused(origin: str | None, station: Make) -> None:
    here = station()
    named = None if origin is None else origin.format(port=here.port)
    with pytest.raises(InvalidStatus, match="403"):
        Visitor(here, origin=named)
    assert not here.hub.pages


def test_a_websocket_to_another_host_is_refused(station: Make) -> None:
    here = station()
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec_WebSocket_Version": "13",
        "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ==",
    }
    evil = f"evil.example:{here.port}"
    answer = get(here, "/socket", Host=evil, Origin=f"http://{evil}", **upgrade)
    assert answer.status == 403
    assert not here.hub.pages


def test_a_page_of_another_site_can_neither_read_nor_drive(
    station: Make, visit: Callable[..., Page]
) -> None:
    here, elsewhere = station(), station(enable_drive=False)
    page = visit(
        elsewhere.url.replace("127.0.0.1", "localhost"),
        forgive="asked|Failed to load|CORS|WebSocket",
    )
    ready(page)
    # Without the other site's own policy, which would keep it from asking at all.
    page.context.new_cdp_session(page).send("Page.setBypassCSP", {"enabled": True})
    page.reload()
    ready(page)
    heard = page.evaluate(
        """async (url) => {
            const said = new Promise((resolve) => {
                const socket = new WebSocket(url.replace("http", "ws") + "socket");
                socket.onmessage = () => resolve("message");
                socket.onerror = () => resolve("error");
            });
            const read = fetch(url).then((answer) => answer.text(), () => "refused");
            return [await said, await read];
        }""",
        here.url,
    )
    assert heard == ["error", "refused"]
    assert not here.hub.pages


@pytest.mark.parametrize(
    ("served", "secure", "host", "fine"),
    [
        (("::1", 8400), False, "[::1]:8400", True),
        (("::1", 8400), False, "localhost:8400", True),
        (("::1", 8400), False, "[::2]:8400", False),
        (("::ffff:127.0.0.1", 8400), False, "127.0.0.1:8400", True),
        (("192.168.0.10", 8400), False, "192.168.0.10:8400", True),
        (("192.168.0.10", 8400), False, "localhost:8400", False),
        (("192.168.0.10", 8400), False, "LAB-PC:8400", True),
        (("192.168.0.10", 8400), False, "proxy.example:99", True),
        (("192.168.0.10", 8400), False, "proxy.example:8400", False),
        (("127.0.0.1", 80), False, "127.0.0.1", True),
        (("127.0.0.1", 80), True, "127.0.0.1", False),
        (("127.0.0.1", 443), True, "127.0.0.1", True),
    ],
)
def test_it_goes_by_its_own_names_only(
    served: tuple[str, int], secure: bool, host: str, fine: bool
) -> None:
    async def nothing(*_: object) -> None:
        pass

    guard = Guard(nothing, Rules(None, ("lab-pc", "proxy.example:99"), secure))
    scheme = "https" if secure else "http"
    for name in (host, host.upper()):
        headers = [(b"host", name.encode()), (b"origin", f"{scheme}://{name}".encode())]
        request = {"type": "http", "method": "GET", "path": "/", "server": served}
        assert (guard.complaint({**request, "headers": headers}) == "") is fine


def test_every_answer_has_the_security_headers(station: Make) -> None:
    here = station()
    for path, headers in (("/", {}), ("/static/main.js", {}), ("/x", {}), ("/", {"Host": "evil"})):
        answer = get(here, path, **headers)
        policy = answer.getheader("Content-Security-Policy", "")
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert "evil" not in policy
        assert answer.getheader("X-Content-Type-Options") == "nosniff"
        assert answer.getheader("X-Frame-Options") == "DENY"
        assert answer.getheader("Referrer-Policy") == "no-referrer"
        assert answer.getheader("Cross-Origin-Resource-Policy") == "same-origin"
        assert answer.getheader("Server") is None


# ---- token ----


@pytest.mark.parametrize("path", PATHS)
def test_nothing_is_given_without_the_token(path: str, station: Make) -> None:
    here = station(rules=Rules(TOKEN))
    for tried in (path, f"{path}?token=", f"{path}?token=wrong", f"{path}?token={TOKEN}x"):
        assert get(here, tried).status == 403
    assert get(here, path, Cookie=f"roburoc4-{here.port}={TOKEN}").status == 403


def test_a_websocket_without_the_token_is_refused(station: Make) -> None:
    here = station(rules=Rules(TOKEN))
    for cookie in ({}, {"Cookie": f"roburoc4-{here.port}=wrong"}):
        with pytest.raises(InvalidStatus, match="403"):
            Visitor(here, additional_headers=cookie)


@pytest.mark.parametrize("header", ["Sec-WebSocket-Protocol: \x01", "Cookie: \x7f"])
def test_a_bad_handshake_is_closed_and_leaves_no_traceback(
    header: str, station: Make, caplog: pytest.LogCaptureFixture
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
    station: Make, visit: Callable[..., Page]
) -> None:
    here = station(rules=Rules(TOKEN))
    page = visit(f"{here.url}?token={TOKEN}")
    ready(page)
    assert TOKEN not in page.url
    cookie = page.context.cookies()[0]
    assert cookie["httpOnly"]
    assert cookie["sameSite"] == "Strict"
    assert TOKEN not in cookie["value"]
    page.reload()
    ready(page)


def test_the_wrong_token_shows_what_to_do(station: Make, visit: Callable[..., Page]) -> None:
    here = station(rules=Rules(TOKEN))
    page = visit(here.url, forgive="403")
    expect(page.locator("body")).to_contain_text("open the link that the dashboard printed")


# ---- TLS ----


@pytest.fixture(scope="session")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """A certificate that nobody trusts, and its key."""
    folder: Path = tmp_path_factory.mktemp("tls")
    paths = (str(folder / "cert.pem"), str(folder / "key.pem"))
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"),
            *("-nodes", "-days", "2", "-subj", "/CN=127.0.0.1"),
            *("-addext", "subjectAltName=IP:127.0.0.1", "-out", paths[0], "-keyout", paths[1]),
        ],
        check=True,
        capture_output=True,
    )
    return paths


def test_it_serves_https_and_a_secure_websocket(
    certificate: tuple[str, str], station: Make, visit: Callable[..., Page]
) -> None:
    place = Place(certificate=certificate[0], key=certificate[1])
    here = station(place=place, rules=Rules(TOKEN, secure=True))
    page = visit(f"{here.url}?token={TOKEN}", ignore_https_errors=True)
    ready(page)
    assert page.context.cookies()[0]["secure"]
    context = ssl.create_default_context(cafile=certificate[0])
    connection = http.client.HTTPSConnection("127.0.0.1", here.port, context=context, timeout=10)
    connection.request("GET", "/")
    assert connection.getresponse().status == 403  # trusted, but without the token
    connection.close()
