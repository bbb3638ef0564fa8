# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Encoding: both makers give the same bytes, and decoding gives the records back."""

import os

os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"

from math import pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_makers import make_rclpy
from scipy.spatial.transform import Rotation

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import (
    Beam,
    BodyVelocity,
    Constraint,
    ConstraintKind,
    Inertial,
    Odometry,
    Scan,
    Trajectory,
)
from msss_graphslam.messages import decoding, encoding
from msss_graphslam.messages.hydrostatics import height_of, pressure_at
from msss_graphslam.recordings.typestore import TYPES, make

rclpy_serialization = pytest.importorskip("rclpy.serialization", reason="needs rclpy")

STAMP = 1_700_000_000_123_456_789
POSE = np.array([1.5, -2.5, -3.0, 0.1, -0.2, 2.9])
COVARIANCE = np.diag([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]) + 0.01
BEAM = Beam(STAMP, -2.5, (np.arange(5) + 0.5) * 0.05, np.array([0.0, 7.0, 255.0, 3.0, 1.0]))
IMU = Inertial(STAMP, np.array([0.1, -0.2, 2.9]), np.array([0.01, -0.02, 0.03]))
VELOCITY = BodyVelocity(STAMP, np.array([0.3, -0.1, 0.02]), np.diag([0.01, 0.02, 0.03]))
EDGE = Constraint(ConstraintKind.LOOP, 3, 17, np.array([1.0, 2.0, 3.0]), np.eye(3))
REFUSED = Constraint(ConstraintKind.LOOP, 0, 1, np.zeros(3), np.eye(3), refusal="too_far")


def scan() -> Scan:
    count = 4
    stamps = STAMP + np.arange(3) * 40_000_000
    return Scan(
        end_stamp_ns=int(stamps[-1]),
        beam_stamps_ns=stamps,
        motion=np.zeros((3, 3)),
        motion_covariances=np.zeros((3, 3, 3)),
        reckoned=np.zeros((4, 6)),
        beam_index=np.array([0, 1, 1, 2]),
        body_points=np.zeros((count, 2)),
        body_covariances=np.zeros((count, 2, 2)),
        points=np.arange(8.0).reshape(count, 2),
        covariances=np.arange(16.0).reshape(count, 2, 2),
        twist_covariance=np.eye(3),
    )


def messages(maker: Any) -> dict[str, tuple[str, Any]]:
    track = Trajectory(STAMP + np.arange(2) * 10**9, np.stack([POSE, POSE + 0.1]))
    odometry = Odometry(STAMP, POSE, COVARIANCE, np.arange(6.0), COVARIANCE / 2)
    grid = np.array([[0, 100, -1], [50, -1, 0]], dtype=np.int8)
    nodes = np.arange(60.0).reshape(20, 3)
    return {
        "beam": ("sensor_msgs/msg/LaserScan", encoding.laser_scan(maker, BEAM, "s", 0.04)),
        "raw": ("std_msgs/msg/UInt8MultiArray", encoding.raw_bytes(maker, b"@\n\x00", STAMP)),
        "imu": ("sensor_msgs/msg/Imu", encoding.imu(maker, IMU, "imu_link", 0.1, 0.2)),
        "imu without orientation": (
            "sensor_msgs/msg/Imu",
            encoding.imu(maker, Inertial(STAMP, None, IMU.angular_velocity), "imu_link"),
        ),
        "pressure": (
            "sensor_msgs/msg/FluidPressure",
            encoding.fluid_pressure(maker, STAMP, np.float64(123456.0), "base_link"),
        ),
        "velocity": (
            "geometry_msgs/msg/TwistWithCovarianceStamped",
            encoding.twist(maker, VELOCITY, "base_link"),
        ),
        "odometry": ("nav_msgs/msg/Odometry", encoding.odometry(maker, odometry)),
        "truth": ("nav_msgs/msg/Odometry", encoding.ground_truth(maker, STAMP, POSE)),
        "edge": ("nav_msgs/msg/Odometry", encoding.constraint(maker, STAMP, EDGE)),
        "scan": ("sensor_msgs/msg/PointCloud2", encoding.scan_cloud(maker, scan(), "scan")),
        "map": (
            "sensor_msgs/msg/PointCloud2",
            encoding.map_cloud(maker, STAMP, np.arange(6.0).reshape(3, 2)),
        ),
        "path": ("nav_msgs/msg/Path", encoding.path(maker, track)),
        "pose": (
            "geometry_msgs/msg/PoseWithCovarianceStamped",
            encoding.pose(maker, STAMP, POSE, COVARIANCE),
        ),
        "grid": (
            "nav_msgs/msg/OccupancyGrid",
            encoding.occupancy_grid(maker, STAMP, grid, 0.1, np.array([-1.0, -2.0])),
        ),
        "markers": (
            "visualization_msgs/msg/MarkerArray",
            encoding.graph_markers(maker, STAMP, nodes, [EDGE, REFUSED]),
        ),
        "transform": (
            "geometry_msgs/msg/TransformStamped",
            encoding.transform(maker, STAMP, POSE, "odom", "base_link"),
        ),
    }


NAMES = list(messages(make))


def without_padding(data: bytes, type_name: str) -> bytes:
    """Return the message with zeros where rclpy leaves memory as it finds it."""
    return bytes(TYPES.serialize_cdr(TYPES.deserialize_cdr(data, type_name), type_name))


@pytest.mark.parametrize("name", NAMES)
def test_bag_and_rclpy_messages_have_the_same_bytes(name: str) -> None:
    type_name, ours = messages(make)[name]
    _, theirs = messages(make_rclpy)[name]
    data = bytes(TYPES.serialize_cdr(ours, type_name))
    foreign = rclpy_serialization.serialize_message(theirs)
    assert without_padding(foreign, type_name) == data
    assert 0 <= len(foreign) - len(data) < 4
    read = rclpy_serialization.deserialize_message(data, type(theirs))
    again = rclpy_serialization.serialize_message(read)
    assert without_padding(again, type_name) == data


@pytest.mark.parametrize("maker", [make, make_rclpy], ids=["bag", "rclpy"])
def test_measurements_come_back(maker: Any) -> None:
    made = {name: message for name, (_, message) in messages(maker).items()}
    beam = decoding.beam(made["beam"])
    assert (beam.stamp_ns, beam.bearing) == (STAMP, -2.5)
    np.testing.assert_allclose(beam.ranges, BEAM.ranges, rtol=1e-6)
    np.testing.assert_array_equal(beam.intensities, BEAM.intensities)

    sample = decoding.inertial(made["imu"])
    assert sample.orientation is not None and sample.angular_velocity is not None
    np.testing.assert_allclose(sample.orientation, IMU.orientation, atol=1e-12)
    np.testing.assert_array_equal(sample.angular_velocity, IMU.angular_velocity)
    assert decoding.inertial(made["imu without orientation"]).orientation is None

    velocity = decoding.body_velocity(made["velocity"])
    np.testing.assert_array_equal(velocity.velocity, VELOCITY.velocity)
    np.testing.assert_array_equal(velocity.covariance, VELOCITY.covariance)
    np.testing.assert_allclose(decoding.true_pose(made["truth"]).pose, POSE, atol=1e-12)


@given(
    st.floats(-pi, pi),
    st.floats(-pi / 2, pi / 2),
    st.floats(-pi, pi),
    st.floats(0.01, 100.0),
)
def test_quaternions_of_any_length_give_the_same_rotation(
    roll: float, pitch: float, yaw: float, length: float
) -> None:
    """Within the width of the zone where pitch is taken for vertical."""
    expected = Rotation.from_euler("ZYX", [yaw, pitch, roll])
    x, y, z, w = (length * value for value in encoding.quaternion(roll, pitch, yaw))
    quaternion = make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)
    message = make("sensor_msgs/msg/Imu", orientation=quaternion)
    angles = decoding.inertial(message).orientation
    assert angles is not None
    found = Rotation.from_euler("ZYX", angles[::-1])
    assert (found.inv() * expected).magnitude() < 1e-4


@given(st.floats(-300.0, 0.0), st.booleans(), st.floats(950.0, 1050.0))
def test_depth_and_pressure_are_inverse(z: float, gauge: bool, density: float) -> None:
    sensors = Sensors(gauge_pressure=gauge, water_density=density)
    assert height_of(pressure_at(z, sensors), sensors) == pytest.approx(z, abs=1e-9)


def test_ten_metres_of_fresh_water_are_about_an_atmosphere() -> None:
    assert pressure_at(-10.0, Sensors()) == pytest.approx(101_325.0 + 98_066.5)
    assert height_of(98_066.5, Sensors(gauge_pressure=True)) == pytest.approx(-10.0)


def test_a_scan_cloud_holds_points_covariances_and_times() -> None:
    cloud = encoding.scan_cloud(make, scan(), "scan")
    names = [field.name for field in cloud.fields]
    rows = cloud.data.view("<f4").reshape(-1, len(names))
    columns = dict(zip(names, rows.T, strict=True))
    np.testing.assert_array_equal(columns["y"], [1, 3, 5, 7])
    np.testing.assert_array_equal(columns["covariance_xy"], [1, 5, 9, 13])
    np.testing.assert_allclose(columns["time_offset"], [0.0, 0.04, 0.04, 0.08], rtol=1e-6)
    assert cloud.row_step == len(cloud.data) == cloud.point_step * cloud.width


def test_a_planar_covariance_lands_on_x_y_and_yaw() -> None:
    planar = np.arange(9.0).reshape(3, 3)
    message = encoding.pose(make, STAMP, np.array([1.0, 2.0, 0.5]), planar)
    full = message.pose.covariance.reshape(6, 6)
    np.testing.assert_array_equal(full[np.ix_([0, 1, 5], [0, 1, 5])], planar)
    assert np.count_nonzero(full) == np.count_nonzero(planar)


def test_markers_tell_refused_from_accepted_edges() -> None:
    nodes = np.zeros((18, 3))
    odometry = Constraint(ConstraintKind.ODOMETRY, 0, 1, np.zeros(3), np.eye(3))
    beyond = Constraint(ConstraintKind.LOOP, 0, 18, np.zeros(3), np.eye(3))
    array = encoding.graph_markers(make, STAMP, nodes, [odometry, EDGE, REFUSED, beyond])
    ends = {marker.ns: len(marker.points) for marker in array.markers}
    assert ends == {"nodes": 18, "odometry": 2, "loops": 2, "refused": 2}


def test_an_edge_is_named_by_its_keyframes() -> None:
    message = encoding.constraint(make, STAMP, EDGE)
    assert message.header.frame_id == "keyframe_3"
    assert message.child_frame_id == "keyframe_17"
