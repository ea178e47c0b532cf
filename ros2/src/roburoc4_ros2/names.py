# SPDX-License-Identifier: MIT
"""Names of topics, nodes and namespaces, by the rules of ROS 2."""

import re

_TOKEN = r"[A-Za-z_][A-Za-z0-9_]*"
_TOPIC = re.compile(rf"/?{_TOKEN}(/{_TOKEN})*")
_NAMESPACE = re.compile(rf"/|(/{_TOKEN})+")
_NODE = re.compile(_TOKEN)


def is_topic(name: str) -> bool:
    """Whether this is a topic, relative or absolute."""
    return _TOPIC.fullmatch(name) is not None and "__" not in name


def is_namespace(name: str) -> bool:
    """Whether this is a namespace: absolute, without a slash at its end."""
    return _NAMESPACE.fullmatch(name) is not None and "__" not in name


def is_node(name: str) -> bool:
    """Whether a node may have this name."""
    return _NODE.fullmatch(name) is not None


def resolve(topic: str, namespace: str) -> str:
    """Return the full name of a topic: relative ones are in the namespace."""
    return topic if topic.startswith("/") else f"{namespace.rstrip('/')}/{topic}"
