# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages through rclpy are the same bytes as those that go into bags."""

from array import array
from typing import Any

import numpy as np
import pytest

from msss_graphslam.core.types import (
    Beam,
    BodyVelocity,
    Constraint,
    ConstraintKind,
    GraphPoses,
    Inertial,
    KeyframeReport,
    MapCorrection,
    Odometry,
    Scan,
    Trajectory,
    TwistError,
)
from msss_graphslam.messages import encoding
from msss_graphslam.recordings import typestore
from msss_graphslam.ros import messages

pytest.importorskip("rclpy")

from rclpy.serialization import serialize_message

STAMP = 1_700_000_000_123_456_789
POSE = np.array([1.0, -2.0, 3.0, 0.1, -0.2, 2.5])
COVARIANCE = np.diag(np.arange(1.0, 7.0)) + 0.01
EDGE = Constraint(ConstraintKind.LOOP, 3, 7, np.array([1.0, 2.0, 0.3]), np.eye(3) * 0.1)


def scan() -> Scan:
    count = 3
    return Scan(
        beam_stamps_ns=STAMP + np.arange(3) * 10**8,
        end_stamp_ns=STAMP + 10**9,
        reckoned=np.arange(24.0).reshape(4, 6),
        twist_covariance=np.eye(3),
        beam_index=np.array([0, 1, 2]),
        body_points=np.zeros((count, 2)),
        body_covariances=np.zeros((count, 2, 2)),
        motion=np.zeros((count, 3)),
        motion_covariances=np.zeros((count, 3, 3)),
        points=np.arange(6.0).reshape(count, 2),
        covariances=np.arange(12.0).reshape(count, 2, 2),
    )


def _encoded() -> dict[str, tuple[Any, ...]]:
    beam = Beam(STAMP, -2.5, np.linspace(0.1, 9.0, 50), np.arange(50.0))
    inertial = Inertial(STAMP, np.array([0.1, 0.2, 0.3]), np.array([0.01, 0.0, -0.2]))
    velocity = BodyVelocity(STAMP, np.array([0.5, 0.1, 0.0]), np.eye(3) * 0.01)
    odometry = Odometry(STAMP, POSE, COVARIANCE, np.arange(6.0), COVARIANCE.T / 2)
    track = Trajectory(STAMP + np.arange(4) * 10**9, np.tile(POSE, (4, 1)))
    grid = np.array([[0, 100, -1], [50, -1, 0]], dtype=np.int8)
    nodes = np.arange(24.0).reshape(8, 3)
    shown = TwistError(np.array([0.01, 0.02, 0.001]), np.eye(3) * 0.1)
    report = KeyframeReport(7, STAMP, np.array([1.0, 2.0, 0.3]), np.zeros(3), shown, (EDGE,))
    answer = GraphPoses(STAMP + np.arange(8), nodes, nodes / 3, np.ones((8, 3, 3)))
    return {
        "laser_scan": (beam, "sonar_link", 0.04),
        "raw_bytes": (b"@\n", STAMP),
        "imu": (inertial, "imu_link", 0.1, 0.2),
        "fluid_pressure": (STAMP, np.float64(123456.0), "base_link"),
        "twist": (velocity, "base_link"),
        "odometry": (odometry,),
        "ground_truth": (STAMP, POSE),
        "constraint": (STAMP, EDGE),
        "scan_cloud": (scan(), "scan"),
        "map_cloud": (STAMP, np.arange(9.0).reshape(3, 3)),
        "path": (track,),
        "pose": (STAMP, POSE, COVARIANCE),
        "occupancy_grid": (STAMP, grid, np.float32(0.1), np.array([-1.0, -2.0])),
        "graph_markers": (STAMP, nodes, [EDGE]),
        "moment": (STAMP,),
        "settled_odometry": (STAMP, [odometry, odometry]),
        "scan_beams": (scan(),),
        "graph_poses": (answer,),
        "tried": (report,),
        "correction": (MapCorrection(STAMP, np.array([1.0, 2.0, 0.3]), np.eye(3), shown),),
        "transform": (STAMP, POSE, "odom", "base_link"),
    }


ENCODED = _encoded()
PARTS = {"Make", "quaternion", "tf_message"}


def _type_name(message: Any) -> str:
    (
        package,
        kind,
        *_,
    ) = type(message).__module__.split(".")
    return f"{package}/{kind}/{type(message).__name__}"


def _same_bytes(ours: Any, theirs: Any) -> None:
    """Compare with zeros where rclpy leaves the memory between fields as it finds it."""
    name = _type_name(ours)
    store = typestore.TYPES
    expected = bytes(store.serialize_cdr(theirs, name))
    found = serialize_message(ours)
    again = bytes(store.serialize_cdr(store.deserialize_cdr(found, name), name))
    assert again == expected
    assert 0 <= len(found) - len(expected) < 4


def test_every_encoding_is_compared() -> None:
    assert set(encoding.__all__) - PARTS == set(ENCODED)


@pytest.mark.parametrize("name", ENCODED)
def test_rclpy_and_bag_messages_have_the_same_bytes(name: str) -> None:
    encode = getattr(encoding, name)
    ours = encode(messages.make, *ENCODED[name])
    _same_bytes(ours, encode(typestore.make, *ENCODED[name]))


def test_transforms_have_the_same_bytes() -> None:
    if not messages.available("tf2_msgs/msg/TFMessage"):
        pytest.skip("tf2_msgs is not installed")
    ours, theirs = (
        encoding.tf_message(make, [encoding.transform(make, STAMP, POSE, "odom", "base_link")])
        for make in (messages.make, typestore.make)
    )
    _same_bytes(ours, theirs)


@pytest.mark.parametrize("value", [np.float32(1.5), np.float64(1.5), 1.5, np.int64(1), 1])
def test_no_scalar_is_lost(value: Any) -> None:
    message = messages.make("sensor_msgs/msg/LaserScan", range_min=value)
    assert type(message.range_min) is float
    assert message.range_min == value


@pytest.mark.parametrize(
    "values",
    [b"\x01\x02", bytearray([1, 2]), np.array([1, 2], np.uint8), [1, 2], array("B", [1, 2])],
)
def test_bytes_are_taken_in_any_form(values: Any) -> None:
    assert messages.make("std_msgs/msg/UInt8MultiArray", data=values).data == array("B", [1, 2])


def test_arrays_in_any_layout_keep_their_order() -> None:
    matrix = np.arange(36.0).reshape(6, 6)
    made = messages.make("geometry_msgs/msg/PoseWithCovariance", covariance=matrix.T)
    np.testing.assert_array_equal(made.covariance, matrix.T.reshape(-1))
    strided = np.arange(10, dtype=np.float32)[::2]
    assert list(messages.make("sensor_msgs/msg/LaserScan", ranges=strided).ranges) == [
        0,
        2,
        4,
        6,
        8,
    ]


def test_a_message_does_not_change_with_the_array_it_was_made_of() -> None:
    covariance = np.ones(36)
    made = messages.make("geometry_msgs/msg/PoseWithCovariance", covariance=covariance)
    covariance[:] = 7.0
    assert made.covariance[0] == 1.0


def test_an_unknown_field_is_an_error() -> None:
    with pytest.raises(TypeError, match="has no field 'speed'"):
        messages.make("sensor_msgs/msg/Imu", speed=1.0)


def test_what_is_installed_is_known() -> None:
    assert messages.available("sensor_msgs/msg/Imu")
    assert not messages.available("sensor_msgs/msg/NoSuchMessage")
    assert not messages.available("no_such_msgs/msg/Imu")
