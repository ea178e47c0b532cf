# SPDX-License-Identifier: MIT
"""Announcements of nodes, in the form of Humble and that of all later distributions."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from roburoc4_ros2.announcement import (
    GID_SIZE,
    HUMBLE_GID_SIZE,
    AnnouncedNode,
    Announcement,
    decode,
)

KIND = "rmw_dds_common/msg/ParticipantEntitiesInfo"
NODE = AnnouncedNode("/red", "roburoc4", (b"r" * 16,), (b"v" * 16, b"w" * 16))
gids = st.binary(min_size=16, max_size=16)
names = st.text("abcdefghijkl_/", max_size=12)
several = st.lists(gids, max_size=3).map(tuple)
announcements = st.builds(
    Announcement,
    gids,
    st.lists(st.builds(AnnouncedNode, names, names, several, several), max_size=3).map(tuple),
)


@pytest.mark.parametrize(
    ("size", "store"),
    [(GID_SIZE, Stores.ROS2_JAZZY), (HUMBLE_GID_SIZE, Stores.ROS2_HUMBLE)],
)
def test_each_form_is_what_its_distributions_read(size: int, store: Stores) -> None:
    data = Announcement(b"p" * 16, (NODE,)).encode(size)
    message = get_typestore(store).deserialize_cdr(data, KIND)
    assert bytes(message.gid.data) == (b"p" * 16).ljust(size, b"\0")
    (node,) = message.node_entities_info_seq
    assert (node.node_namespace, node.node_name) == ("/red", "roburoc4")
    assert [bytes(gid.data)[:16] for gid in node.reader_gid_seq] == list(NODE.readers)
    assert [bytes(gid.data)[:16] for gid in node.writer_gid_seq] == list(NODE.writers)


@given(announcements, st.sampled_from((GID_SIZE, HUMBLE_GID_SIZE)))
def test_the_form_of_an_announcement_is_recognized(announcement: Announcement, size: int) -> None:
    assert decode(announcement.encode(size)) == (announcement, size)


@given(st.binary(max_size=200))
def test_invalid_announcements_are_rejected(data: bytes) -> None:
    try:
        found, size = decode(b"\0\1\0\0" + data)
    except ValueError:
        return
    assert decode(found.encode(size)) == (found, size)
