# SPDX-License-Identifier: MIT
"""A dashboard in a thread, a simulator behind it, and a real browser before it."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright
from station import CHROMIUM, FAKE_PAD, PATIENCE_S, REPEATS, Station

expect.set_options(timeout=1000 * PATIENCE_S)


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
def browser() -> Iterator[Browser]:
    """Debian's Chromium."""
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield running
        running.close()


@pytest.fixture
def visit(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Open pages; a complaint of any page's script, or a request to another host, is a failure."""
    contexts: list[BrowserContext] = []
    complaints: list[str] = []
    # A page whose dashboard went away says so; that is what some tests are about.
    forgiven = ["WebSocket connection to", "net::ERR_CONNECTION", "net::ERR_EMPTY"]

    def open_page(url: str, *, forgive: str | None = None, **settings: Any) -> Page:
        if forgive is not None:
            forgiven.append(forgive)
        context = browser.new_context(**settings)
        contexts.append(context)
        context.add_init_script(FAKE_PAD + REPEATS)
        page = context.new_page()
        page.set_default_timeout(1000 * PATIENCE_S)
        host = url.split("/")[2]
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: said.type == "error" and complaints.append(said.text))
        page.on(
            "request",
            lambda asked: (
                asked.url.split("/")[2] == host or complaints.append(f"asked {asked.url}")
            ),
        )
        page.goto(url)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert [text for text in complaints if not re.search("|".join(forgiven), text)] == []
