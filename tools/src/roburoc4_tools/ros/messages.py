# SPDX-License-Identifier: MIT
"""The ROS 2 messages that a robot's statuses become: definitions, and what is derived from them.

They are those of ROS 2 Iron and later. On the wire Humble's are the same, but for the size of
``rmw_dds_common/Gid``, and for Range, which ends before ``variance`` there: its readers ignore what
follows.
"""

import functools
import hashlib
import json
import re
from typing import Any, NamedTuple

# In IDL, and so on the wire, a message has at least one member.
_EMPTY = "uint8 structure_needs_at_least_one_member"
_DEFINITIONS = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "std_msgs/Bool": "bool data",
    "std_msgs/String": "string data",
    "std_msgs/Empty": "",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Pose": ("geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation"),
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance",
    "geometry_msgs/Transform": (
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation"
    ),
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform"
    ),
    "geometry_msgs/TwistStamped": "std_msgs/Header header\ngeometry_msgs/Twist twist",
    "nav_msgs/Odometry": (
        "std_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist"
    ),
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "sensor_msgs/BatteryState": (
        "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\n"
        "float32 charge\nfloat32 capacity\nfloat32 design_capacity\nfloat32 percentage\n"
        "uint8 power_supply_status\nuint8 power_supply_health\nuint8 power_supply_technology\n"
        "bool present\nfloat32[] cell_voltage\nfloat32[] cell_temperature\nstring location\n"
        "string serial_number"
    ),
    "sensor_msgs/Range": (
        "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n"
        "float32 max_range\nfloat32 range\nfloat32 variance"
    ),
    "sensor_msgs/Joy": "std_msgs/Header header\nfloat32[] axes\nint32[] buttons",
    "diagnostic_msgs/KeyValue": "string key\nstring value",
    "diagnostic_msgs/DiagnosticStatus": (
        "byte level\nstring name\nstring message\nstring hardware_id\n"
        "diagnostic_msgs/KeyValue[] values"
    ),
    "diagnostic_msgs/DiagnosticArray": (
        "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status"
    ),
    "rcl_interfaces/Log": (
        "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
        "string function\nuint32 line"
    ),
    "rcl_interfaces/ParameterValue": (
        "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\n"
        "string string_value\nbyte[] byte_array_value\nbool[] bool_array_value\n"
        "int64[] integer_array_value\nfloat64[] double_array_value\nstring[] string_array_value"
    ),
    "rcl_interfaces/Parameter": "string name\nrcl_interfaces/ParameterValue value",
    "rcl_interfaces/FloatingPointRange": "float64 from_value\nfloat64 to_value\nfloat64 step",
    "rcl_interfaces/IntegerRange": "int64 from_value\nint64 to_value\nuint64 step",
    "rcl_interfaces/ParameterDescriptor": (
        "string name\nuint8 type\nstring description\nstring additional_constraints\n"
        "bool read_only\nbool dynamic_typing\n"
        "rcl_interfaces/FloatingPointRange[] floating_point_range\n"
        "rcl_interfaces/IntegerRange[] integer_range"
    ),
    "rcl_interfaces/SetParametersResult": "bool successful\nstring reason",
    "rcl_interfaces/ListParametersResult": "string[] names\nstring[] prefixes",
    "rmw_dds_common/Gid": "uint8[16] data",
    "rmw_dds_common/NodeEntitiesInfo": (
        "string<=256 node_namespace\nstring<=256 node_name\n"
        "rmw_dds_common/Gid[] reader_gid_seq\nrmw_dds_common/Gid[] writer_gid_seq"
    ),
    "rmw_dds_common/ParticipantEntitiesInfo": (
        "rmw_dds_common/Gid gid\nrmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq"
    ),
}
# Services: what is asked, and what is answered.
_SERVICES = {
    "std_srvs/Trigger": ("", "bool success\nstring message"),
    "rcl_interfaces/DescribeParameters": (
        "string[] names",
        "rcl_interfaces/ParameterDescriptor[] descriptors",
    ),
    "rcl_interfaces/GetParameters": ("string[] names", "rcl_interfaces/ParameterValue[] values"),
    "rcl_interfaces/GetParameterTypes": ("string[] names", "uint8[] types"),
    "rcl_interfaces/ListParameters": (
        "string[] prefixes\nuint64 depth",
        "rcl_interfaces/ListParametersResult result",
    ),
    "rcl_interfaces/SetParameters": (
        "rcl_interfaces/Parameter[] parameters",
        "rcl_interfaces/SetParametersResult[] results",
    ),
    "rcl_interfaces/SetParametersAtomically": (
        "rcl_interfaces/Parameter[] parameters",
        "rcl_interfaces/SetParametersResult result",
    ),
}
# rmw_cyclonedds_cpp puts this before both, to tell clients and their calls apart.
_CALL = "uint64 client\nint64 number"
_DEFINITIONS.update(
    (f"{kind.replace('/', '/srv/')}_{part}", f"{_CALL}\n{text or _EMPTY}")
    for kind, texts in _SERVICES.items()
    for part, text in zip(("Request", "Response"), texts, strict=True)
)
_LINE = "=" * 80
_FIELD = re.compile(r"([\w/]+)(?:<=(\d+))?(?:\[(\d*)\])? (\w+)")


class Field(NamedTuple):
    """A member of a message."""

    name: str
    kind: str
    """A number's type, "string", or another message."""
    length: int | None
    """The length of an array; 0 if it varies, None for a single value."""
    text_length: int
    """The greatest length of a string; 0 for any."""


def definition(kind: str) -> str:
    """Return the definitions of a message and of all messages in it, as in ROS 2 files."""
    parts, seen = [_DEFINITIONS[kind]], {kind}
    for part in parts:
        for name in re.findall(r"^(\w+/\w+)(?:\[\d*\])? ", part, re.MULTILINE):
            if name not in seen:
                seen.add(name)
                parts.append(f"{_LINE}\nMSG: {name}\n{_DEFINITIONS[name]}")
    return "\n".join(parts) + "\n"


def is_message(kind: str) -> bool:
    """Whether a member of this type is a message itself."""
    return "/" in kind


@functools.cache
def fields(kind: str) -> tuple[Field, ...]:
    """Return the members of a message, in their order."""
    return tuple(
        Field(name, type_, int(length or 0) if "[" in match[0] else None, int(text_length or 0))
        for match in _FIELD.finditer(_DEFINITIONS[kind] or _EMPTY)
        for type_, text_length, length, name in [match.groups()]
    )


# ----------------------------------------------------------------------------------- type hash

# Of type_description_interfaces/FieldType; arrays and sequences have these offsets.
_TYPE_IDS = {
    "int8": 2,
    "uint8": 3,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "byte": 16,
    "string": 17,
}
_MESSAGE_ID, _BOUNDED_STRING_ID = 1, 21
_ARRAY_OFFSET, _SEQUENCE_OFFSET = 48, 144


def ros_name(kind: str) -> str:
    """Return ``nav_msgs/msg/Odometry`` for ``nav_msgs/Odometry``."""
    return kind.replace("/", "/msg/")


def dds_name(kind: str) -> str:
    """Return the name of the type on the wire: ``nav_msgs::msg::dds_::Odometry_``."""
    package, *group, name = kind.split("/")
    return f"{package}::{group[0] if group else 'msg'}::dds_::{name}_"


@functools.cache
def type_hash(kind: str) -> str:
    """Return the hash of REP 2011 by which ROS 2 distinguishes types."""
    needed, waiting = set[str](), [kind]
    while waiting:
        for field in fields(waiting.pop()):
            if is_message(field.kind) and field.kind not in needed:
                needed.add(field.kind)
                waiting.append(field.kind)
    description = {
        "type_description": _described(kind),
        "referenced_type_descriptions": [_described(name) for name in sorted(needed, key=ros_name)],
    }
    return "RIHS01_" + hashlib.sha256(json.dumps(description).encode()).hexdigest()


def _described(kind: str) -> dict[str, Any]:
    return {"type_name": ros_name(kind), "fields": [_described_field(f) for f in fields(kind)]}


def _described_field(field: Field) -> dict[str, Any]:
    nested = is_message(field.kind)
    number = _MESSAGE_ID if nested else _TYPE_IDS[field.kind]
    if field.text_length:
        number = _BOUNDED_STRING_ID
    if field.length is not None:
        number += _ARRAY_OFFSET if field.length else _SEQUENCE_OFFSET
    return {
        "name": field.name,
        "type": {
            "type_id": number,
            "capacity": field.length or 0,
            "string_capacity": field.text_length,
            "nested_type_name": ros_name(field.kind) if nested else "",
        },
    }
