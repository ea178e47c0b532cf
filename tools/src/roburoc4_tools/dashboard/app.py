# SPDX-License-Identifier: MIT
"""The page, its files and its WebSocket."""

from __future__ import annotations

import asyncio
import contextlib
import mimetypes
import time
from collections.abc import AsyncIterator
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect

from .camera import Feed
from .fleet import Fleet
from .guard import Guard, Rules
from .hub import MOST_PAGES, Hub, Page
from .messages import BadMessageError, Messages

STATIC = Path(__file__).parent / "static"
_TRY_LATER = 1013
_POLICY = 1008


def application(fleet: Fleet, rules: Rules) -> ASGIApp:
    """Make the whole web application, guarded."""
    # These types may be wrong in a Windows registry, and then no browser runs the page.
    mimetypes.add_type("text/javascript", ".js")
    mimetypes.add_type("text/css", ".css")
    mimetypes.add_type("image/svg+xml", ".svg")

    @contextlib.asynccontextmanager
    async def lifespan(_app: Starlette) -> AsyncIterator[None]:
        tasks = [_beat(fleet, hub) for hub in fleet.hubs]
        try:
            yield
        finally:
            fleet.close()
            for beating in tasks:
                beating.cancel()
            for hub in fleet.hubs:
                hub.recorder.close()

    async def page(_request: Request) -> Response:
        return FileResponse(STATIC / "index.html", headers={"Cache-Control": "no-store"})

    async def socket(websocket: WebSocket) -> None:
        hub = fleet.find(websocket.query_params.get("robot", ""))
        if hub is None:
            await websocket.accept()
            await websocket.close(_POLICY, "no robot has that name")
            return
        await _serve(fleet, hub, websocket)

    async def recording(request: Request) -> Response:
        hub = fleet.find(request.query_params.get("robot", ""))
        form = request.path_params["form"]
        path = None if hub is None else hub.path_of_recording(form)
        if hub is None or path is None:
            return PlainTextResponse("Nothing was recorded in this form.\n", 404)
        name = "-".join(filter(None, ("roburoc4", hub.name, time.strftime("%Y%m%d-%H%M%S"))))
        media_type = "text/csv" if form == "csv" else "application/octet-stream"
        return FileResponse(path, media_type=media_type, filename=f"{name}.{form}")

    feeds = [Feed(camera) for camera in fleet.hubs[0].cameras]

    async def camera(request: Request) -> Response:
        index, after = int(request.path_params["index"]), request.query_params.get("after", "")
        if index >= len(feeds) or not after.isdecimal():
            return PlainTextResponse("There is no such picture.\n", 404)
        return await feeds[index].next(int(after[:12]))

    routes = [
        Route("/", page),
        Route("/recording.{form}", recording),
        Route("/camera/{index:int}", camera),
        WebSocketRoute("/socket", socket),
        Mount("/static", StaticFiles(directory=STATIC)),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), rules)


def _beat(fleet: Fleet, hub: Hub) -> asyncio.Task[None]:
    beating = asyncio.create_task(hub.beat())
    beating.add_done_callback(lambda ended: _note_end(fleet, hub, ended))
    return beating


def _note_end(fleet: Fleet, hub: Hub, beating: asyncio.Task[None]) -> None:
    """When no frames are made any more, nothing is driven, and the server ends."""
    if not beating.cancelled() and (error := beating.exception()) is not None:
        hub.failure = error
        fleet.close()


async def _serve(fleet: Fleet, hub: Hub, websocket: WebSocket) -> None:
    """Exchange messages with a page until it is gone."""
    await websocket.accept()
    if len(hub.pages) >= MOST_PAGES:
        await websocket.close(_TRY_LATER, "too many pages are open")
        return
    page = hub.join()
    sending = asyncio.create_task(_send(websocket, page))
    try:
        await _hear(Messages(fleet, hub, page), websocket)
    finally:
        hub.part(page)
        sending.cancel()


async def _hear(messages: Messages, websocket: WebSocket) -> None:
    try:
        while True:
            try:
                text = await websocket.receive_text()
            except (WebSocketDisconnect, RuntimeError):  # found out here, or while sending
                return
            messages.receive(text)
    except BadMessageError as error:
        reason = str(error)
    except KeyError:  # bytes instead of text
        reason = "not a text"
    messages.end()
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # it may have closed, too
        await websocket.close(_POLICY, reason)


async def _send(websocket: WebSocket, page: Page) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await websocket.send_text(await page.outbox.get())
