# SPDX-License-Identifier: MIT
"""A live robot for Foxglove, by its own WebSocket protocol: without ROS, a bridge or a file."""

from foxglove import Capability, Channel, Context, Schema, start_server
from foxglove.websocket import WebSocketServer

from roburoc4.robot import Robot

from .messages import definition, ros_name
from .published import PUBLISHED
from .stream import Stream
from .topics import TOPICS, Item


class Live:
    """Serves one robot's messages to everybody who connects; nobody can send it commands."""

    def __init__(self, robot: Robot, host: str, port: int, offset_s: float) -> None:
        """Listen; ``offset_s`` is added to the robot object's time to get Unix time."""
        self.sent = 0
        self._stream = Stream(robot, robot.address, offset_s)
        self._context = Context()
        # All at once, before anybody can connect: the SDK advertises a later channel a moment
        # before it accepts subscriptions to it, and refuses those of a client that is quicker.
        self._channels = {topic: self._channel(topic) for topic in TOPICS if topic in PUBLISHED}
        self._latched: dict[str, bytes] = {}
        self._server: WebSocketServer = start_server(
            name=f"RobuROC4 at {robot.address}",
            host=host,
            port=port,
            capabilities=[Capability.Time],
            context=self._context,
        )

    @property
    def port(self) -> int:
        """Where it listens."""
        return self._server.port

    def add(self, item: Item) -> None:
        """Send a status or an event."""
        time_ns = self._stream.messages.seen_us(item) * 1000
        for topic, message in self._stream.of(item):
            self._send(topic, message, time_ns)
            if PUBLISHED[topic].profile.latched:
                self._latched[topic] = message
            if topic == "diagnostics":  # once a second: for those who have only just connected
                for latched, last in self._latched.items():
                    self._send(latched, last, time_ns)
        self._server.broadcast_time(time_ns)

    def _channel(self, topic: str) -> Channel:
        kind = TOPICS[topic]
        schema = Schema(name=ros_name(kind), encoding="ros2msg", data=definition(kind).encode())
        return Channel(f"/{topic}", schema=schema, message_encoding="cdr", context=self._context)

    def _send(self, topic: str, message: bytes, time_ns: int) -> None:
        self._channels[topic].log(message, log_time=time_ns)
        self.sent += 1

    def close(self) -> None:
        """Disconnect everybody."""
        self._server.stop()
