# SPDX-License-Identifier: MIT
"""`roburoc4 foxglove`, seen by a client that reads the protocol and the messages on its own."""

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cli_support import run, start
from rosbags.typesys import Stores, get_typestore
from websockets.sync.client import ClientConnection, connect

import roburoc4
from roburoc4_tools.ros.live import Live
from roburoc4_tools.ros.topics import TOPICS

STORE = get_typestore(Stores.ROS2_JAZZY)
LONG_S = 60.0
MESSAGE_DATA = 1


@pytest.fixture
def sim() -> Iterator[roburoc4.Simulator]:
    with roburoc4.Simulator(port=0) as simulator:
        yield simulator


@pytest.fixture
def url(sim: roburoc4.Simulator) -> Iterator[str]:
    program = start("foxglove", "--port", "0", "--json", robot=sim.address)
    assert program.stdout is not None
    try:
        yield json.loads(program.stdout.readline())["url"]
    finally:
        program.terminate()
        assert program.wait(LONG_S) == 143


class Viewer:
    """Subscribes to every channel that is advertised."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._topics: dict[int, str] = {}
        self.channels: dict[str, dict[str, Any]] = {}

    def read(self) -> tuple[str, Any] | None:
        """Take in one message of the server; the topic and the message, if it is one of those."""
        said = self._socket.recv(LONG_S)
        if isinstance(said, str):
            document = json.loads(said)
            if document["op"] == "advertise":
                for channel in document["channels"]:
                    self.channels[channel["topic"]] = channel
                    self._topics[channel["id"]] = channel["topic"]
                wanted = [
                    {"id": channel["id"], "channelId": channel["id"]}
                    for channel in document["channels"]
                ]
                self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
            return None
        if said[0] != MESSAGE_DATA:
            return None
        number, _ = struct.unpack_from("<IQ", said, 1)
        topic = self._topics[number]
        return topic, STORE.deserialize_cdr(said[13:], self.channels[topic]["schemaName"])

    def hear(self, *topics: str) -> dict[str, Any]:
        """The first message of each topic."""
        heard: dict[str, Any] = {}
        while not heard.keys() >= set(topics):
            if (one := self.read()) is not None:
                heard.setdefault(*one)
        return heard


def test_foxglove_shows_the_live_robot(url: str, sim: roburoc4.Simulator) -> None:
    with connect(url, subprotocols=["foxglove.sdk.v1"]) as socket:  # type: ignore[list-item]
        heard = Viewer(socket).hear("/odom", "/tf", "/battery_state", "/range/front", "/pad/joy")
    assert heard["/odom"].header.frame_id == "odom"
    assert heard["/battery_state"].percentage == pytest.approx(1.0)
    assert heard["/tf"].transforms[0].child_frame_id == "base_link"
    assert len(heard["/pad/joy"].axes) == 6


def test_all_topics_are_there_before_anybody_can_connect() -> None:
    """The SDK may refuse a subscription to a channel that it has only just advertised."""
    with roburoc4.connect("127.0.0.1:9", wait=False) as robot:
        live = Live(robot, "127.0.0.1", 0, 0.0)
        try:
            with connect(f"ws://127.0.0.1:{live.port}", subprotocols=["foxglove.sdk.v1"]) as socket:  # type: ignore[list-item]
                viewer = Viewer(socket)
                while not viewer.channels:
                    viewer.read()
        finally:
            live.close()
    assert viewer.channels.keys() == {f"/{topic}" for topic in TOPICS if topic != "cmd_vel_sent"}


def test_who_connects_later_gets_what_was_sent_once(url: str) -> None:
    once = ("/robot_description", "/tf_static", "/inhibited")
    for _ in range(2):
        with connect(url, subprotocols=["foxglove.sdk.v1"]) as socket:  # type: ignore[list-item]
            viewer = Viewer(socket)
            heard = viewer.hear(*once)
        assert heard["/robot_description"].data.startswith("<")
        assert {channel["encoding"] for channel in viewer.channels.values()} == {"cdr"}


def test_the_layout_shows_topics_that_there_are(tmp_path: Path) -> None:
    path = tmp_path / "layout.json"
    assert run("foxglove", "--layout", str(path)).returncode == 0
    assert run("foxglove", "--layout", str(path)).returncode == 2  # it is there already
    layout = json.loads(path.read_text("utf-8"))

    def panels(part: Any) -> set[str]:
        return {part} if isinstance(part, str) else panels(part["first"]) | panels(part["second"])

    def texts(part: Any) -> Iterator[str]:
        if isinstance(part, dict):
            for name, value in part.items():
                yield name
                yield from texts(value)
        elif isinstance(part, list):
            for value in part:
                yield from texts(value)
        elif isinstance(part, str):
            yield part

    assert panels(layout["layout"]) == layout["configById"].keys()
    shown = {text.partition(".")[0] for text in texts(layout) if text.startswith("/")}
    assert shown <= {f"/{topic}" for topic in TOPICS}
    assert len(shown) >= 6
