# SPDX-License-Identifier: MIT
"""The services of one robot's node: stop, arm, and those of its parameters.

They answer clients that use rmw_cyclonedds_cpp: each rmw layer tells calls apart in its own way,
so that they do not serve one another's clients either.
"""

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from cyclonedds.core import (
    DDSException,
    InstanceState,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.qos import Policy
from cyclonedds.sub import DataReader

from roburoc4_tools.ros.cdr import Cdr, CdrReader

from .commands import Commands, Sender
from .config import RobotConfig
from .listener import Listener
from .parameters import Parameters
from .participant import Node, Participant, Publisher, Raw
from .senders import Senders

_WAIT_S = 0.2
_MANY = 100
# A client that waits for an answer has a reader; it may be found later than its request comes.
_MATCH_S = 1.0
_MATCH_EVERY_S = 0.005
_DEPTH, _PARAMETER_DEPTH = 10, 1000
# By this, rmw_cyclonedds_cpp marks the two ends of a client.
_CLIENT = b"clientid="
_NEWS = ViewState.Any | InstanceState.Any | SampleState.NotRead

Serve = Callable[[CdrReader, Cdr, Sender], None]


class _Service(NamedTuple):
    reader: DataReader[Any]
    answers: Publisher
    serve: Serve


class Services:
    """Reads requests and answers them, in a thread of its own: a call may take its time."""

    def __init__(
        self,
        participant: Participant,
        node: Node,
        config: RobotConfig,
        listener: Listener,
        report: Callable[[str], None],
    ) -> None:
        """Offer the services; those that command take turns with the listener."""
        self._senders = Senders(participant)
        self._report = report
        self._services: list[_Service] = []
        self._seen: set[int] = set()

        def offer(name: str, kind: str, serve: Serve, depth: int = _DEPTH) -> None:
            self._services.append(_Service(*node.service(name, kind, depth), serve))

        def trigger(act: Callable[[Commands, Sender], tuple[bool, str]]) -> Serve:
            def serve(_request: CdrReader, response: Cdr, sender: Sender) -> None:
                success, text = listener.call(lambda commands: act(commands, sender))
                response.numbers("B", success).text(text)

            return serve

        offer(config.remap.get("stop", "stop"), "std_srvs/Trigger", trigger(_stop))
        offer("arm", "std_srvs/Trigger", trigger(lambda commands, _: commands.arm()))
        parameters = Parameters(
            config,
            lambda: listener.commands.config,
            lambda **limits: listener.commands.limit(**limits),
        )
        for name, kind, serve in (
            ("list_parameters", "ListParameters", parameters.list),
            ("get_parameters", "GetParameters", parameters.get),
            ("get_parameter_types", "GetParameterTypes", parameters.types),
            ("describe_parameters", "DescribeParameters", parameters.describe),
            ("set_parameters", "SetParameters", parameters.set_each),
            ("set_parameters_atomically", "SetParametersAtomically", parameters.set_atomically),
        ):
            kind = f"rcl_interfaces/{kind}"
            offer(f"{config.node_name}/{name}", kind, _of_anybody(serve), _PARAMETER_DEPTH)
        self._waitset = WaitSet(participant.dds)
        self._conditions = [ReadCondition(service.reader, _NEWS) for service in self._services]
        for condition in self._conditions:
            self._waitset.attach(condition)

    def run(self, ended: threading.Event) -> None:
        """Serve until the end."""
        while not ended.is_set():
            try:
                has_news = self._waitset.wait(round(_WAIT_S * 1e9)) > 0
                self._look_at_clients()
                for service in self._services if has_news else ():
                    for request in service.reader.take(_MANY):
                        if isinstance(request, Raw):  # else a client has left
                            self._answer(service, request)
            except Exception as error:  # an unforeseen one, too: `stop` must be served again
                why = error.msg if isinstance(error, DDSException) else repr(error)
                self._report(f"services cannot be read ({why}): trying again")
                ended.wait(_WAIT_S)

    def _look_at_clients(self) -> None:
        """Name clients that will probably get no answer."""
        for service in self._services:
            for handle in set(service.reader.get_matched_publications()) - self._seen:
                self._seen.add(handle)
                client = service.reader.get_matched_publication_data(handle)
                data = client.qos[Policy.Userdata] if client else None
                if client and not (data and _CLIENT in data.data):
                    sender = self._senders.of(service.reader, handle)
                    self._report(
                        f"the client {sender.text} of a service gets no answer unless it tells "
                        "calls apart as rmw_cyclonedds_cpp does: start it with "
                        "RMW_IMPLEMENTATION=rmw_cyclonedds_cpp"
                    )

    def _answer(self, service: _Service, request: Any) -> None:
        sender = self._senders.of(service.reader, request.sample_info.publication_handle)
        try:
            reader = CdrReader(request)
            call = reader.numbers("Q", 1), reader.numbers("q", 1)
            answer = Cdr().numbers("Q", *call[0]).numbers("q", *call[1])
            service.serve(reader, answer, sender)
        except (ValueError, UnicodeDecodeError):
            self._report(f"a request of {sender.text} cannot be read: is its type of this ROS 2?")
            return
        self._wait_for_client(service, request)
        service.answers.publish(bytes(answer.data))

    def _wait_for_client(self, service: _Service, request: Any) -> None:
        with contextlib.suppress(DDSException):
            handle = request.sample_info.publication_handle
            client = service.reader.get_matched_publication_data(handle)
            until_s = time.monotonic() + _MATCH_S
            while client is not None and time.monotonic() < until_s:
                if service.answers.is_heard_by(client.participant_key):
                    return
                time.sleep(_MATCH_EVERY_S)


def _of_anybody(serve: Callable[[CdrReader, Cdr], None]) -> Serve:
    return lambda request, response, _: serve(request, response)


def _stop(commands: Commands, sender: Sender) -> tuple[bool, str]:
    commands.stop(sender)
    return True, "stopping; commands are rejected until all publishers have paused for 500 ms"
