# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The Girona caves data set: bags written here by its definitions, from known motion."""

from collections import Counter
from math import isclose, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from girona_bags import (
    AXES,
    PACKAGE,
    PORT_AFT_UP,
    START_NS,
    TYPES,
    Entry,
    converted,
    depth,
    dvl,
    good_scan,
    header,
    imu,
    make,
    scan,
    write,
)

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Beam, BodyVelocity, Depth, Inertial
from msss_graphslam.evaluation.errors import position_errors
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.conversion import convert
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import decode
from msss_graphslam.simulation.recording import SimulatedBag


@pytest.mark.parametrize("topic", AXES)
@pytest.mark.parametrize("angles", [(0, 0, 0), (0.1, -0.2, 0.3), (-0.3, 0.2, 3.0), (0, 0.5, -2.0)])
def test_attitude_and_rates_come_back(tmp_path: Path, topic: str, angles: Any) -> None:
    rates = np.array([0.1, -0.2, 0.3])
    sample = imu(START_NS, angles, rates, AXES[topic])
    report, found = converted(tmp_path, [good_scan(), (topic, sample, START_NS)])
    assert report.messages == {"/sonar/ping": 1, "/imu/data": 1} and not report.refused
    [inertial] = [entry for entry in found if isinstance(entry, Inertial)]
    np.testing.assert_allclose(inertial.orientation, angles, atol=1e-12)
    np.testing.assert_allclose(inertial.angular_velocity, rates, atol=1e-12)
    assert inertial.stamp_ns == START_NS


def test_heading_north_is_a_yaw_of_ninety_degrees(tmp_path: Path) -> None:
    """With x to starboard and north, west, up for axes, an IMU heading north has yaw -90 deg."""
    half = -radians(90) / 2
    fields = {"qz": np.sin(half), "qw": np.cos(half)}
    sample = make(f"{PACKAGE}/Imu", header=header(START_NS), **fields)
    _, found = converted(tmp_path, [good_scan(), ("/imu_adis", sample, START_NS)])
    [inertial] = [entry for entry in found if isinstance(entry, Inertial)]
    np.testing.assert_allclose(inertial.orientation, [0, 0, radians(90)], atol=1e-12)


def test_only_the_better_imu_is_taken_and_odometry_is_no_truth(tmp_path: Path) -> None:
    zeros = np.zeros(3)
    point = TYPES.types["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    turn = TYPES.types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    placed = TYPES.types["geometry_msgs/msg/Transform"](translation=point, rotation=turn)
    pose = TYPES.types["geometry_msgs/msg/TransformStamped"](
        header=header(START_NS), child_frame_id="sparus", transform=placed
    )
    entries = [
        good_scan(),
        ("/imu_xsens_mti", imu(START_NS, zeros, zeros, PORT_AFT_UP), START_NS),
        ("/imu_adis", imu(START_NS, zeros, zeros), START_NS),
        ("/odometry", pose, START_NS),
    ]
    report, _ = converted(tmp_path, entries)
    assert report.messages == {"/sonar/ping": 1, "/imu/data": 1}


def test_depth_and_velocity_come_back(tmp_path: Path) -> None:
    entries = [
        good_scan(),
        ("/depth_sensor", depth(START_NS, 13.9), START_NS),
        ("/dvl_linkquest", dvl(START_NS, [0.3, 0.1, -0.05]), START_NS),
    ]
    _, found = converted(tmp_path, entries)
    [height] = [entry for entry in found if isinstance(entry, Depth)]
    assert isclose(height.z, -13.9, rel_tol=1e-12)
    [speed] = [entry for entry in found if isinstance(entry, BodyVelocity)]
    np.testing.assert_allclose(speed.velocity, [0.3, -0.1, 0.05])


def test_what_is_not_known_is_marked_so(tmp_path: Path) -> None:
    entries = [good_scan(), ("/imu_adis", imu(START_NS, [0, 0, 0], [0, 0, 0]), START_NS)]
    converted(tmp_path, entries)
    messages = {
        raw.channel.topic: decode(raw.data, raw.schema.name)
        for raw in open_recording(tmp_path / "out").messages()
        if raw.schema is not None
    }
    sample = messages["/imu/data"]
    assert sample.header.frame_id == "base_link"
    np.testing.assert_allclose(np.diag(sample.orientation_covariance.reshape(3, 3)), 7.6e-5, 1e-2)
    assert not sample.angular_velocity_covariance.any()
    assert sample.linear_acceleration_covariance[0] == -1.0


@pytest.mark.parametrize(
    ("angle", "bearing"),
    [(pi, 0.0), (pi / 2, pi / 2), (3 * pi / 2, -pi / 2), (0.0, pi), (2 * pi - 0.1, -pi + 0.1)],
)
def test_angles_are_clockwise_from_astern(tmp_path: Path, angle: float, bearing: float) -> None:
    _, [beam] = converted(tmp_path, [good_scan(angle=angle)])
    assert np.exp(1j * beam.bearing) == pytest.approx(np.exp(1j * bearing), abs=1e-6)


@pytest.mark.parametrize(
    "ranges", [[0.0, 0.5, 1.0], [0.25, 0.75, 1.25], [0.5, 1.0, 1.5], []], ids=str
)
def test_bins_begin_at_the_head_whatever_the_ranges_mean(tmp_path: Path, ranges: Any) -> None:
    message = scan(START_NS, 1.0, ranges, [1, 2, 3], maximum=1.5)
    _, [beam] = converted(tmp_path, [("/sonar_micron_ros", message, START_NS)])
    np.testing.assert_allclose(beam.ranges, [0.25, 0.75, 1.25], rtol=1e-6)


def test_the_mounting_of_the_data_set_gives_way_to_a_given_one(tmp_path: Path) -> None:
    source = write(tmp_path / "caves.bag", [good_scan()])
    convert(source, tmp_path / "own")
    convert(source, tmp_path / "given", Mounting(mount_x=-1.0))
    for name, expected in (("own", 0.1), ("given", -1.0)):
        mounting = open_recording(tmp_path / name).mounting()
        assert mounting is not None and mounting.mount_x == pytest.approx(expected)


def as_girona(bag: Path) -> list[Entry]:
    """The measurements of a bag as the data set would hold them; an oracle of its own."""
    entries: list[Entry] = []
    for entry in open_recording(bag).measurements(Counter(), Configuration()):
        stamp_ns = entry.stamp_ns
        if isinstance(entry, Beam):
            message = scan(stamp_ns, pi - entry.bearing, entry.ranges, entry.intensities)
            entries.append(("/sonar_micron_ros", message, stamp_ns))
        elif isinstance(entry, Inertial):
            sample = imu(stamp_ns, entry.orientation, entry.angular_velocity)
            entries.append(("/imu_adis", sample, stamp_ns))
        elif isinstance(entry, Depth):
            entries.append(("/depth_sensor", depth(stamp_ns, -entry.z), stamp_ns))
    return entries


@pytest.mark.slow
def test_a_converted_mission_is_estimated_as_well_as_the_recorded(
    tmp_path: Path, tank: SimulatedBag
) -> None:
    source = write(tmp_path / "caves.bag", as_girona(tank.bag))
    report = convert(source, tmp_path / "out", Mounting())
    assert not report.refused
    record = estimate(
        open_recording(tmp_path / "out"),
        ESTIMATORS["full"],
        Configuration(),
        lambda _share, _what: None,
    )
    truth = open_recording(tank.bag).ground_truth()
    assert truth is not None
    assert position_errors(record.estimate.trajectory, truth).anchored.max() < 0.3
