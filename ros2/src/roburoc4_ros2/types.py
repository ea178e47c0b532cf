# SPDX-License-Identifier: MIT
"""The types of cyclonedds for ROS 2 messages, made from the table of definitions."""

import functools
from typing import Any

from cyclonedds.idl import IdlStruct, annotations, make_idl_struct, types

from roburoc4_tools.ros.messages import Field, dds_name, fields, is_message

# rmw_cyclonedds_cpp describes a byte as uint8 (dyntype.cpp), and types are compared.
_SCALARS: dict[str, Any] = {"string": str, "bool": bool, "byte": types.uint8}


@functools.cache
def struct_of(kind: str) -> type[IdlStruct]:
    """Make the type of a message: final, in plain CDR."""
    name = dds_name(kind)
    members = {field.name: _type_of(field) for field in fields(kind)}
    made: type[IdlStruct] = make_idl_struct(
        name.rpartition(":")[2], name.replace("::", "."), members
    )
    annotations.final(made)
    annotations.cdrv0(made)
    return made


def _type_of(field: Field) -> Any:
    single: Any = _SCALARS.get(field.kind)
    if is_message(field.kind):
        single = struct_of(field.kind)
    elif field.text_length:
        single = types.bounded_str[field.text_length]
    elif single is None:
        single = getattr(types, field.kind)
    if field.length is None:
        return single
    if not field.length:
        return types.sequence[single]
    return types.array[single, field.length]
