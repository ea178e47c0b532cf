# SPDX-License-Identifier: MIT
"""A dashboard in a thread, between a simulator and a real browser."""

import re
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import (
    Browser,
    BrowserContext,
    ConsoleMessage,
    Error,
    Page,
    Playwright,
    expect,
    sync_playwright,
)
from station import (
    CHROMIUM,
    FAKE_PAD,
    FIREFOX,
    PATIENCE_S,
    REPEATS,
    Station,
    press_arm,
    ready,
    take_control,
)

expect.set_options(timeout=1000 * PATIENCE_S)


def pytest_configure(config: pytest.Config) -> None:
    """Register the mark."""
    config.addinivalue_line("markers", "both: runs in Firefox, too, as it may differ there")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run tests that are marked "both" in both browsers, all others in Chromium."""
    if "engine" in metafunc.fixturenames:
        both = metafunc.definition.get_closest_marker("both") is not None
        metafunc.parametrize(
            "engine", ["chromium", "firefox"] if both else ["chromium"], scope="session"
        )


@pytest.fixture
def station() -> Iterator[Callable[..., Station]]:
    """Make dashboards; they end with the test."""
    running: list[Station] = []

    def make(**settings: Any) -> Station:
        running.append(Station(**settings))
        return running[-1]

    yield make
    for one in running:
        one.close()


@pytest.fixture(scope="session")
def playwright() -> Iterator[Playwright]:
    """Playwright, which drives the browsers."""
    with sync_playwright() as running:
        yield running


@pytest.fixture(scope="session")
def browser(playwright: Playwright, engine: str) -> Iterator[Browser]:
    """Debian's Chromium or Firefox."""
    if engine == "firefox":
        running = playwright.firefox.launch(
            executable_path=FIREFOX,
            channel="moz-firefox",
            firefox_user_prefs={"dom.disable_open_during_load": False},
        )
    else:
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
    yield running
    running.close()


@pytest.fixture
def hideable(
    playwright: Playwright, engine: str, visit: Callable[..., Page], tmp_path: Path
) -> Iterator[Callable[[str], tuple[Page, Callable[[], Page]]]]:
    """Open a page, and a tab over it that really hides it.

    Playwright keeps all pages of a Chromium that it launches visible, so this one is launched here.
    """
    running: list[subprocess.Popen[str]] = []

    def in_firefox(url: str) -> tuple[Page, Callable[[], Page]]:
        page = visit(url)

        def cover() -> Page:
            with page.expect_popup() as opened:
                page.evaluate("window.open('about:blank'), 0")
            return opened.value

        return page, cover

    def in_chromium(url: str) -> tuple[Page, Callable[[], Page]]:
        chromium = subprocess.Popen(
            [
                CHROMIUM,
                *("--headless=new", "--no-sandbox", "--remote-debugging-port=0"),
                f"--user-data-dir={tmp_path}",
            ],
            stderr=subprocess.PIPE,
            text=True,
        )
        running.append(chromium)
        assert chromium.stderr is not None
        lines = (re.search(r"DevTools listening on (ws://\S+)", line) for line in chromium.stderr)
        link = next(found[1] for found in lines if found)
        context = playwright.chromium.connect_over_cdp(link, no_defaults=True).contexts[0]
        context.add_init_script(FAKE_PAD + REPEATS)
        page = context.pages[0]
        page.goto(url)

        def cover() -> Page:
            other = context.new_page()
            other.bring_to_front()
            return other

        return page, cover

    yield in_firefox if engine == "firefox" else in_chromium
    for chromium in running:
        chromium.terminate()
        chromium.wait(PATIENCE_S)


def go_to(page: Page, url: str) -> None:
    """Open a page; again, where Firefox fails to connect, as it does now and then."""
    for _ in range(4):
        try:
            page.goto(url)
        except Error as error:
            if "NS_ERROR_CONNECTION_REFUSED" not in str(error):
                raise
            page.wait_for_timeout(500)
        else:
            return
    page.goto(url)


# What browsers log of a lost connection to a page's own server, which is what some tests are about.
LOST = r"""
Firefox can.t establish a connection to the server at SOCKET\.
The connection to SOCKET was interrupted while the page was loading\.
WebSocket connection to 'SOCKET' failed: (?!.*Unexpected response code).*
Failed to load resource: net::ERR_(CONNECTION|EMPTY|SOCKET_NOT_CONNECTED)\w* at PAGE
""".strip().replace("\n", "|")


@pytest.fixture
def visit(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Open pages; an error of a page's script, or a request to another host, fails the test."""
    contexts: list[BrowserContext] = []
    complaints: list[str] = []

    def open_page(url: str, *, forgive: str | None = None, init: str = "", **settings: Any) -> Page:
        context = browser.new_context(**settings)
        contexts.append(context)
        context.add_init_script(FAKE_PAD + REPEATS + init)
        page = context.new_page()
        page.set_default_timeout(1000 * PATIENCE_S)
        host = url.split("/")[2]
        lost = LOST.replace("SOCKET", rf"wss?://{re.escape(host)}/socket\?robot=\w*")
        lost = lost.replace("PAGE", rf"https?://{re.escape(host)}/")

        def complain(text: str) -> None:
            if not re.fullmatch(lost, text) and not (forgive and re.search(forgive, text)):
                complaints.append(text)

        def hear(said: ConsoleMessage) -> None:
            if said.type == "error":
                failed = said.text.startswith("Failed to load resource")
                complain(f"{said.text} at {said.location['url']}" if failed else said.text)

        page.on("pageerror", lambda error: complain(str(error)))
        page.on("console", hear)
        page.on(
            "request",
            lambda asked: asked.url.split("/")[2] == host or complain(f"asked {asked.url}"),
        )
        go_to(page, url)
        return page

    yield open_page
    for context in contexts:
        context.close()
    if complaints:
        pytest.fail("\n".join(complaints), pytrace=False)


@pytest.fixture
def watched(
    station: Callable[..., Station], visit: Callable[..., Page]
) -> Callable[..., tuple[Station, Page]]:
    """Make a dashboard with these settings, and open its page, which shows a ready robot."""

    def open_it(page: dict[str, Any] | None = None, **settings: Any) -> tuple[Station, Page]:
        here = station(**settings)
        opened = visit(here.url, **page or {})
        ready(opened)
        return here, opened

    return open_it


@pytest.fixture
def armed(watched: Callable[..., tuple[Station, Page]]) -> Callable[..., tuple[Station, Page]]:
    """The same, and the page has taken control and armed the robot."""

    def arm_it(**settings: Any) -> tuple[Station, Page]:
        here, page = watched(**settings)
        take_control(page)
        press_arm(page)
        return here, page

    return arm_it
