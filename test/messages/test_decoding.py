# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Decoding: every refusal by name, and what is admitted beside it."""

from collections.abc import Callable
from copy import deepcopy
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import Beam, BodyVelocity, Inertial
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.order import StampOrder
from msss_graphslam.recordings.typestore import make

Change = Callable[[Any], None]

BEAM = Beam(10**18, 0.5, np.array([0.1, 0.2, 0.3]), np.array([1.0, 2.0, 255.0]))
SCAN = encoding.laser_scan(make, BEAM, "sonar_link", 0.04)
IMU = encoding.imu(make, Inertial(1, np.array([0.1, 0.2, 0.3]), np.ones(3)), "imu_link")
PRESSURE = encoding.fluid_pressure(make, 1, 150_000.0, "base_link")
TWIST = encoding.twist(make, BodyVelocity(1, np.ones(3), np.eye(3)), "base_link")
TRUTH = encoding.ground_truth(make, 1, np.arange(6.0) * 0.1)


def setting(path: str, value: Any) -> Change:
    """Return a change that sets the field, for instance header.stamp.sec."""

    def change(message: Any) -> None:
        *parents, last = path.split(".")
        for name in parents:
            message = getattr(message, name)
        setattr(message, last, value)

    return change


def cell(path: str, index: int, value: float) -> Change:
    """Return a change that sets one element of an array."""

    def change(message: Any) -> None:
        for name in path.split("."):
            message = getattr(message, name)
        message[index] = value

    return change


def both(*changes: Change) -> Change:
    def change(message: Any) -> None:
        for one in changes:
            one(message)

    return change


def profile(ranges: list[float], intensities: list[float]) -> Change:
    return both(
        setting("ranges", np.array(ranges, np.float32)),
        setting("intensities", np.array(intensities, np.float32)),
    )


REFUSED = [
    (decoding.beam, SCAN, setting("header.stamp.sec", -1), "beam_stamp_invalid"),
    (decoding.beam, SCAN, setting("header.stamp.nanosec", 10**9), "beam_stamp_invalid"),
    (decoding.beam, SCAN, profile([], []), "beam_without_bins"),
    (decoding.beam, SCAN, profile([0.1, 0.2], [1.0]), "beam_lengths_differ"),
    (decoding.beam, SCAN, profile([0.1], []), "beam_lengths_differ"),
    (decoding.beam, SCAN, cell("ranges", 1, nan), "beam_not_finite"),
    (decoding.beam, SCAN, cell("ranges", 2, inf), "beam_not_finite"),
    (decoding.beam, SCAN, cell("intensities", 0, nan), "beam_not_finite"),
    (decoding.beam, SCAN, cell("ranges", 1, 0.1), "beam_ranges_not_increasing"),
    (decoding.beam, SCAN, cell("ranges", 0, -0.1), "beam_ranges_not_increasing"),
    (decoding.beam, SCAN, cell("intensities", 2, 256.0), "beam_intensity_out_of_range"),
    (decoding.beam, SCAN, cell("intensities", 2, -1.0), "beam_intensity_out_of_range"),
    (decoding.beam, SCAN, setting("angle_min", nan), "beam_bearing_not_finite"),
    (decoding.beam, SCAN, setting("angle_max", 0.6), "beam_with_several_bearings"),
    (decoding.beam, SCAN, setting("angle_max", nan), "beam_with_several_bearings"),
    (decoding.inertial, IMU, setting("header.stamp.sec", -5), "imu_stamp_invalid"),
    (decoding.inertial, IMU, setting("orientation.x", nan), "imu_not_finite"),
    (
        decoding.inertial,
        IMU,
        setting("orientation", make("geometry_msgs/msg/Quaternion")),
        "imu_quaternion_zero",
    ),
    (decoding.inertial, IMU, setting("angular_velocity.z", inf), "imu_not_finite"),
    (decoding.inertial, IMU, setting("orientation_covariance", []), "imu_covariance_size"),
    (
        decoding.inertial,
        IMU,
        both(
            cell("orientation_covariance", 0, -1.0), cell("angular_velocity_covariance", 0, -1.0)
        ),
        "imu_without_data",
    ),
    (decoding.body_velocity, TWIST, setting("header.stamp.sec", -1), "dvl_stamp_invalid"),
    (decoding.body_velocity, TWIST, setting("twist.twist.linear.x", nan), "dvl_not_finite"),
    (decoding.body_velocity, TWIST, cell("twist.covariance", 7, inf), "dvl_not_finite"),
    (
        decoding.body_velocity,
        TWIST,
        setting("twist.covariance", np.zeros(9)),
        "dvl_covariance_size",
    ),
    (
        decoding.body_velocity,
        TWIST,
        setting("twist.covariance", np.zeros(36)),
        "dvl_covariance_not_positive",
    ),
    (
        decoding.body_velocity,
        TWIST,
        cell("twist.covariance", 0, -1.0),
        "dvl_covariance_not_positive",
    ),
    (
        decoding.body_velocity,
        TWIST,
        cell("twist.covariance", 1, 0.5),
        "dvl_covariance_not_positive",
    ),
    (decoding.true_pose, TRUTH, setting("header.stamp.sec", -1), "ground_truth_stamp_invalid"),
    (decoding.true_pose, TRUTH, setting("pose.pose.position.y", nan), "ground_truth_not_finite"),
    (
        decoding.true_pose,
        TRUTH,
        setting("pose.pose.orientation", make("geometry_msgs/msg/Quaternion")),
        "ground_truth_quaternion_zero",
    ),
]


@pytest.mark.parametrize(("decode", "message", "change", "reason"), REFUSED)
def test_refusals(decode: Any, message: Any, change: Change, reason: str) -> None:
    decode(message)
    broken = deepcopy(message)
    change(broken)
    with pytest.raises(Refusal) as caught:
        decode(broken)
    assert caught.value.reason == reason


@pytest.mark.parametrize(
    ("gauge", "pressure", "reason"),
    [
        (False, nan, "pressure_not_finite"),
        (False, inf, "pressure_not_finite"),
        (False, 49_999.0, "pressure_out_of_range"),
        (False, 50_001.0, None),
        (False, 1.19e8, None),
        (False, 1.21e8, "pressure_out_of_range"),
        (True, -49_999.0, None),
        (True, -50_001.0, "pressure_out_of_range"),
        (True, 1.21e8, "pressure_out_of_range"),
    ],
)
def test_pressures(gauge: bool, pressure: float, reason: str | None) -> None:
    message = encoding.fluid_pressure(make, 1, pressure, "base_link")
    sensors = Sensors(gauge_pressure=gauge)
    if reason is None:
        assert np.isfinite(decoding.depth(message, sensors).z)
        return
    with pytest.raises(Refusal) as caught:
        decoding.depth(message, sensors)
    assert caught.value.reason == reason


def test_a_pressure_with_a_bad_stamp_is_refused() -> None:
    broken = deepcopy(PRESSURE)
    broken.header.stamp.sec = -1
    with pytest.raises(Refusal, match="pressure_stamp_invalid"):
        decoding.depth(broken, Sensors())


def test_what_is_marked_absent_is_not_looked_at() -> None:
    message = deepcopy(IMU)
    both(cell("orientation_covariance", 0, -1.0), setting("orientation.x", nan))(message)
    sample = decoding.inertial(message)
    assert sample.orientation is None
    np.testing.assert_array_equal(sample.angular_velocity, np.ones(3))


def test_a_beam_of_one_bin_is_admitted() -> None:
    message = deepcopy(SCAN)
    profile([0.0], [0.0])(message)
    assert decoding.beam(message).ranges.shape == (1,)


@given(st.lists(st.floats(width=32), max_size=6), st.lists(st.floats(width=32), max_size=6))
def test_no_beam_ever_holds_a_number_that_is_not_finite(
    ranges: list[float], intensities: list[float]
) -> None:
    message = deepcopy(SCAN)
    profile(ranges, intensities)(message)
    try:
        beam = decoding.beam(message)
    except Refusal:
        return
    assert np.isfinite(beam.ranges).all() and np.isfinite(beam.intensities).all()
    assert (np.diff(beam.ranges) > 0.0).all()


@given(
    st.lists(st.floats(), min_size=4, max_size=4), st.lists(st.floats(), min_size=3, max_size=3)
)
def test_no_sample_ever_holds_a_number_that_is_not_finite(
    quaternion: list[float], rates: list[float]
) -> None:
    message = deepcopy(IMU)
    for name, value in zip("xyzw", quaternion, strict=True):
        setattr(message.orientation, name, value)
    for name, value in zip("xyz", rates, strict=True):
        setattr(message.angular_velocity, name, value)
    try:
        sample = decoding.inertial(message)
    except Refusal:
        return
    assert np.isfinite(sample.orientation).all() and np.isfinite(sample.angular_velocity).all()


@given(st.lists(st.floats(), min_size=9, max_size=9))
def test_no_velocity_covariance_is_ever_indefinite(values: list[float]) -> None:
    message = deepcopy(TWIST)
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = np.reshape(values, (3, 3))
    message.twist.covariance = covariance.reshape(36)
    try:
        found = decoding.body_velocity(message).covariance
    except Refusal:
        return
    assert np.linalg.eigvalsh(found / np.abs(found).max())[0] > 0.0


def test_stamps_must_increase() -> None:
    order = StampOrder()
    order.check(5)
    for stamp_ns in (5, 4):
        with pytest.raises(Refusal, match="stamp_not_increasing"):
            order.check(stamp_ns)
    order.check(6)


SECOND = 1_000_000_000


def refused(stamps: list[int]) -> list[str]:
    order, reasons = StampOrder(), []
    for stamp_ns in stamps:
        try:
            order.check(stamp_ns)
        except Refusal as refusal:
            reasons.append(refusal.reason)
    return reasons


def test_one_stamp_far_ahead_costs_no_other() -> None:
    assert refused([0, 10**18, SECOND, 2 * SECOND]) == ["stamp_jumps_ahead"]


def test_a_clock_that_was_set_costs_one_message() -> None:
    assert refused([0, 10**18, 10**18 + SECOND, 10**18 + 2]) == [
        "stamp_jumps_ahead",
        "stamp_not_increasing",
    ]


@pytest.mark.parametrize(("silence", "reasons"), [(60, []), (61, ["stamp_jumps_ahead"])])
def test_the_longest_silence(silence: int, reasons: list[str]) -> None:
    assert refused([0, silence * SECOND, (silence + 1) * SECOND]) == reasons
