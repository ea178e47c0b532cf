# SPDX-License-Identifier: MIT
"""Pictures of the operator's own camera servers (MJPEG), passed on to the pages.

A browser does not tell a page when a picture of a stream has arrived, so an old one would look
like a new one. Here each has its time. A camera is asked while a page shows it, once for all.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time
from typing import IO, NamedTuple
from urllib.request import urlopen

from starlette.responses import Response

_SILENT_S = 5.0
_UNSEEN_S = 3.0
_AGAIN_S = 1.0
_LONGEST = 8_000_000
_LOOK_S = 0.02


class Camera(NamedTuple):
    """A server of moving pictures run by the operator."""

    name: str
    url: str


class Feed:
    """The newest picture of a camera."""

    def __init__(self, camera: Camera) -> None:
        self._url = camera.url
        self._number = 0
        self._picture = b""
        self._type = ""
        self._wanted_s = -_UNSEEN_S
        self._thread: threading.Thread | None = None

    async def next(self, after: int) -> Response:
        """Return the picture that follows this one; an empty answer if none comes for a while."""
        begun_s = time.monotonic()
        while True:
            self._wanted_s = time.monotonic()
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._read, daemon=True)
                self._thread.start()
            if self._picture and self._number != after:
                headers = {"X-Picture": str(self._number), "Cache-Control": "no-store"}
                return Response(self._picture, media_type=self._type, headers=headers)
            if self._wanted_s - begun_s > _AGAIN_S:
                return Response(status_code=204)
            await asyncio.sleep(_LOOK_S)

    @property
    def _seen(self) -> bool:
        return time.monotonic() - self._wanted_s < _UNSEEN_S

    def _read(self) -> None:
        while self._seen:
            with (
                contextlib.suppress(OSError, ValueError),
                urlopen(self._url, timeout=_SILENT_S) as answer,
            ):
                kind = answer.headers.get_content_type()
                if kind.startswith("multipart/"):
                    self._read_parts(answer)
                elif kind.startswith("image/"):
                    self._take(kind, answer.read(_LONGEST))
            time.sleep(_AGAIN_S)
        self._picture = b""  # it would be old when a page asks again

    def _read_parts(self, answer: IO[bytes]) -> None:
        """Read parts that name their length, as camera servers send them."""
        kind, length = "image/jpeg", 0
        while self._seen and (line := answer.readline(1000)):
            name, _, value = line.strip().partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
            elif name.lower() == b"content-type":
                kind = value.decode("latin-1").strip()
            elif not line.strip() and length:
                if length > _LONGEST:
                    raise ValueError(length)
                self._take(kind, answer.read(length))
                length = 0

    def _take(self, kind: str, picture: bytes) -> None:
        if picture and kind.startswith("image/"):
            self._type, self._picture = kind, picture
            self._number += 1
