# SPDX-License-Identifier: MIT
"""Services of the node, called by Fast DDS as a client with rmw_cyclonedds_cpp would.

Requests and answers are of ROS 2's own .srv files, behind the header by which that layer tells
calls apart; rosbags reads and writes them.
"""

import contextlib
import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from processes import Program, Robot, drives, until
from ros import STORE, Listener, Node, dds_program
from rosbags.typesys import get_types_from_msg

StartNode = Callable[..., Node]
Drive = Callable[..., Program]
StartClient = Callable[..., "Client"]

CLIENT = 0x1122334455667788
CALL = "uint64 client\nint64 number\n"
SERVICES = {
    "std_srvs/srv/Trigger": (
        "uint8 structure_needs_at_least_one_member",
        "bool success\nstring message",
    ),
    "rcl_interfaces/srv/ListParameters": (
        "string[] prefixes\nuint64 depth",
        "string[] names\nstring[] prefixes",  # a ListParametersResult
    ),
    "rcl_interfaces/srv/GetParameters": (
        "string[] names",
        "rcl_interfaces/ParameterValue[] values",
    ),
    "rcl_interfaces/srv/GetParameterTypes": ("string[] names", "uint8[] types"),
    "rcl_interfaces/srv/DescribeParameters": (
        "string[] names",
        "rcl_interfaces/ParameterDescriptor[] descriptors",
    ),
    "rcl_interfaces/srv/SetParameters": (
        "rcl_interfaces/Parameter[] parameters",
        "rcl_interfaces/SetParametersResult[] results",
    ),
}
BOOL, INTEGER, DOUBLE, STRING = 1, 2, 3, 4


@pytest.fixture(scope="module", autouse=True)
def _types() -> None:
    found: dict[str, Any] = {}
    for name, parts in SERVICES.items():
        for part, text in zip(("Request", "Response"), parts, strict=True):
            found |= get_types_from_msg(CALL + text, f"{name.replace('/srv/', '/msg/')}_{part}")
    STORE.register({name: kind for name, kind in found.items() if name not in STORE.types})


class Client(Program):
    """programs/call.cpp for one service."""

    def __init__(self, log: Path, domain: int, service: str, kind: str, *options: str) -> None:
        package, _, name = kind.split("/")
        super().__init__(
            log,
            dds_program("call"),
            service,
            f"{package}::srv::dds_::{name}",
            *options,
            environment={"ROS_DOMAIN_ID": str(domain)},
        )
        self._kind = f"{package}/msg/{name}"
        self._numbers = itertools.count(1)
        self.says("ready")

    def send(self, cdr: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(cdr.hex().encode() + b"\n")
        self.process.stdin.flush()

    def call(self, *members: Any) -> Any:
        """Call it; the answer is the one with this call's number.

        A request may be sent before the node knows this client, and is lost then, as in ROS.
        """
        number = next(self._numbers)
        request = STORE.types[f"{self._kind}_Request"](CLIENT, number, *members)
        sent = bytes(STORE.serialize_cdr(request, f"{self._kind}_Request"))

        def answers() -> list[Any]:
            found = re.findall(r"answer ([0-9a-f]+)\n", self.output)
            kind = f"{self._kind}_Response"
            read: list[Any] = [STORE.deserialize_cdr(bytes.fromhex(each), kind) for each in found]
            return [each for each in read if (each.client, each.number) == (CLIENT, number)]

        for _ in range(1 if number > 1 else 5):
            self.send(sent)
            with contextlib.suppress(AssertionError):
                until(answers, f"an answer of {self._kind}", 5)
                break
        assert answers(), f"no answer of {self._kind}"
        return answers()[0]


@pytest.fixture
def client(folder_for: Callable[[str], Path], ends: Any, domain: int) -> StartClient:
    def start(service: str, kind: str, *options: str) -> Client:
        made = Client(folder_for("call") / "log", domain, service, kind, *options)
        ends.callback(made.end)
        return made

    return start


def value(kind: int, **given: Any) -> Any:
    members = {
        "type": kind,
        "bool_value": False,
        "integer_value": 0,
        "double_value": 0.0,
        "string_value": "",
        "byte_array_value": np.array([], np.uint8),
        "bool_array_value": np.array([], np.bool_),
        "integer_array_value": np.array([], np.int64),
        "double_array_value": np.array([], np.float64),
        "string_array_value": [],
    }
    return STORE.types["rcl_interfaces/msg/ParameterValue"](**{**members, **given})


def parameter(name: str, of: Any) -> Any:
    return STORE.types["rcl_interfaces/msg/Parameter"](name, of)


def test_stop_and_arm_answer_what_happened(
    robot: Robot, driven: Node, drive: Drive, client: StartClient
) -> None:
    stop, arm = (client(name, "std_srvs/srv/Trigger") for name in ("/stop", "/arm"))
    armed = arm.call(0)
    assert armed.success, armed.message
    drive("speed", 0.5, 0)
    drives(robot)
    assert stop.call(0).success
    until(robot.stands, "the robot stands")
    refused = arm.call(0)  # the publisher goes on
    assert not refused.success
    assert "pause" in refused.message


def test_parameters_are_listed_described_and_read(
    start_node: StartNode, robot: Robot, client: StartClient
) -> None:
    start_node("--max-linear-m-s", "0.75", "--lease-ms", "300")
    services = "rcl_interfaces/srv/"
    listed = client("/roburoc4/list_parameters", services + "ListParameters").call([], 0)
    assert {"address", "enable_drive", "lease_ms", "max_linear_m_s", "use_sim_time"} <= set(
        listed.names
    )
    names = ["address", "enable_drive", "lease_ms", "max_linear_m_s", "none"]
    values = client("/roburoc4/get_parameters", services + "GetParameters").call(names).values
    assert [each.type for each in values] == [STRING, BOOL, INTEGER, DOUBLE, 0]
    assert values[0].string_value == robot.address
    assert values[1].bool_value is False
    assert values[2].integer_value == 300
    assert values[3].double_value == 0.75
    types = client("/roburoc4/get_parameter_types", services + "GetParameterTypes").call(names)
    assert list(types.types) == [STRING, BOOL, INTEGER, DOUBLE, 0]
    described = client("/roburoc4/describe_parameters", services + "DescribeParameters")
    found = described.call(["address", "max_linear_m_s"]).descriptors
    assert [(each.name, each.read_only) for each in found] == [
        ("address", True),
        ("max_linear_m_s", False),
    ]
    assert found[1].floating_point_range[0].to_value == 0.75


def test_services_appear_as_those_of_rmw_cyclonedds_cpp(
    start_node: StartNode, listener: Listener
) -> None:
    start_node()
    until(lambda: len(listener.services()) == 16, "eight services", 15)
    ends = {each.topic: each for each in listener.services()}
    request, reply = ends["rq/stopRequest"], ends["rr/stopReply"]
    assert (request.kind, reply.kind) == ("reader", "writer")
    assert request.type == "std_srvs::srv::dds_::Trigger_Request_"
    assert reply.type == "std_srvs::srv::dds_::Trigger_Response_"
    assert request.user_data == reply.user_data  # by this, a client knows that they are one
    assert re.fullmatch("serviceid=[0-9a-f]+;", request.user_data)
    assert all(each.reliable and not each.latched for each in ends.values())


def test_a_ceiling_is_lowered_while_driving_and_never_raised(
    robot: Robot, driven: Node, drive: Drive, client: StartClient
) -> None:
    set_parameters = client("/roburoc4/set_parameters", "rcl_interfaces/srv/SetParameters")
    drive("speed", 0.5, 0)
    drives(robot)
    lower = parameter("max_linear_m_s", value(DOUBLE, double_value=0.125))
    assert set_parameters.call([lower]).results[0].successful
    until(lambda: robot.speeds()[2] == pytest.approx(0.125), "the new ceiling")
    for name, wanted, why in (
        ("max_linear_m_s", value(DOUBLE, double_value=3.0), "started with"),
        ("max_linear_m_s", value(STRING, string_value="fast"), "number"),
        ("address", value(STRING, string_value="10.0.0.1"), "start"),
        ("nothing", value(BOOL, bool_value=True), "no parameter"),
    ):
        result = set_parameters.call([parameter(name, wanted)]).results[0]
        assert not result.successful
        assert why in result.reason


def test_a_client_of_another_rmw_layer_is_told_and_ends_nothing(
    driven: Node, client: StartClient
) -> None:
    other = client("/stop", "std_srvs/srv/Trigger", "other")
    for request in (b"\0\1\0\0\0", b"", b"\0\1\0\0" + bytes(12)):  # the first: rmw_fastrtps_cpp
        other.send(request)
    driven.says("RMW_IMPLEMENTATION=rmw_cyclonedds_cpp")
    assert client("/stop", "std_srvs/srv/Trigger").call(0).success
