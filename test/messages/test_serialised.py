# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages made as bytes: those of the same messages made of objects."""

import struct

import numpy as np
import pytest
from message_makers import make_rclpy

from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Trajectory
from msss_graphslam.messages import encoding
from msss_graphslam.messages.encoding import serialised
from msss_graphslam.messages.encoding.cdr import CdrWriter
from msss_graphslam.recordings.typestore import TYPES, make

rclpy_serialization = pytest.importorskip("rclpy.serialization", reason="needs rclpy")

STAMP = 1_700_000_000_123_456_789
PATH = "nav_msgs/msg/Path"
MARKERS = "visualization_msgs/msg/MarkerArray"
COUNTS = [0, 1, 2, 3, 20]
# Names of every length modulo 8: what follows them is padded differently.
FRAMES = ["", "m", "ma", "map", "maps", "a/map", "ab/map", "abc/map", "abcd/map", "öl/map"]


def track(count: int, *, tilted: bool = False) -> Trajectory:
    poses = np.random.default_rng(count).uniform(-3.0, 3.0, (count, 6))
    if not tilted:
        poses[:, 3:] = 0.0
    return Trajectory(STAMP + np.arange(count) * 999_999_999, poses)


def edges(count: int) -> list[Constraint]:
    """Return one of each kind, refused ones, and one that leads beyond the keyframes."""
    kinds = list(ConstraintKind)
    ends = [(first, first + 1) for first in range(count)]
    return [
        Constraint(kinds[row % len(kinds)], *pair, np.zeros(3), np.eye(3), "far" * (row % 4 == 3))
        for row, pair in enumerate(ends)
    ]


def nodes(count: int) -> Array:
    return np.random.default_rng(count).uniform(-50.0, 50.0, (count, 3))


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("count", COUNTS)
def test_a_path_has_the_bytes_of_its_objects(count: int, frame: str) -> None:
    expected = TYPES.serialize_cdr(encoding.path(make, track(count), frame), PATH)
    assert serialised.path(track(count), frame) == bytes(expected)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("count", COUNTS)
def test_markers_have_the_bytes_of_their_objects(count: int, frame: str) -> None:
    task = STAMP, nodes(count), edges(count), frame
    expected = TYPES.serialize_cdr(encoding.graph_markers(make, *task), MARKERS)
    assert serialised.graph_markers(*task) == bytes(expected)


def test_tilted_poses_are_the_same_to_the_last_digits() -> None:
    message = TYPES.deserialize_cdr(serialised.path(track(20, tilted=True)), PATH)
    expected = encoding.path(make, track(20, tilted=True))
    for found, pose in zip(message.poses, expected.poses, strict=True):
        assert found.header == pose.header
        assert found.pose.position == pose.pose.position
        for axis in "xyzw":
            component = getattr(pose.pose.orientation, axis)
            assert getattr(found.pose.orientation, axis) == pytest.approx(component, abs=1e-15)


def passed_on(data: bytes, kind: type) -> bytes:
    """Return a message as rclpy reads it and writes it again."""
    read = rclpy_serialization.deserialize_message(data, kind)
    return bytes(rclpy_serialization.serialize_message(read))


@pytest.mark.parametrize("count", COUNTS)
def test_rclpy_reads_them(count: int) -> None:
    of_path = type(encoding.path(make_rclpy, track(0)))
    of_markers = type(encoding.graph_markers(make_rclpy, 0, nodes(0), []))
    path = serialised.path(track(count))
    markers = serialised.graph_markers(STAMP, nodes(count), edges(count))
    for data, kind, name in ((path, of_path, PATH), (markers, of_markers, MARKERS)):
        again = TYPES.deserialize_cdr(passed_on(data, kind), name)
        assert bytes(TYPES.serialize_cdr(again, name)) == data


def test_a_path_read_backwards_keeps_its_order() -> None:
    forward = track(7)
    strided = Trajectory(forward.stamps_ns[::-2][::-1], forward.poses[::-2][::-1])
    expected = TYPES.serialize_cdr(encoding.path(make, strided), PATH)
    assert serialised.path(strided) == bytes(expected)


@pytest.mark.parametrize("bytes_before", range(9))
def test_numbers_stand_at_multiples_of_their_size(bytes_before: int) -> None:
    writer = CdrWriter()
    for _ in range(bytes_before):
        writer.numbers("B", 255)
    writer.numbers("d", 1.5)
    body = writer.data[4:]
    assert len(body) == -(-bytes_before // 8) * 8 + 8
    assert np.frombuffer(body[-8:], "<f8") == [1.5]
    assert body[bytes_before:-8] == bytes(len(body) - 8 - bytes_before)


def test_no_rows_leave_no_gap() -> None:
    writer = CdrWriter()
    writer.numbers("I", 0)
    writer.rows(np.zeros((0, 3)))
    assert writer.data == b"\x00\x01\x00\x00" + bytes(4)


@pytest.mark.parametrize("value", [2**32, -1])
def test_a_number_that_does_not_fit_is_an_error(value: int) -> None:
    with pytest.raises(struct.error):
        CdrWriter().numbers("I", value)
