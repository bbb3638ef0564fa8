# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from math import cos, sin, tan

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numerical_derivatives import jacobian
from scipy.spatial.transform import Rotation

from msss_graphslam.core.reckoning.attitude import (
    level,
    rate_derivatives,
    rate_matrix,
    rotation_derivatives,
    rotation_matrix,
    times,
)
from msss_graphslam.core.types import Array

attitudes = st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-3.1, 3.1)).map(
    np.array
)
vectors = st.tuples(*[st.floats(-2.0, 2.0)] * 3).map(np.array)


def equation_6(phi: float, theta: float, psi: float) -> Array:
    """J(X) (6, 6) as it is printed."""
    upper = [
        [
            cos(psi) * cos(theta),
            cos(psi) * sin(theta) * sin(phi) - sin(psi) * cos(phi),
            cos(psi) * sin(theta) * cos(phi) + sin(psi) * sin(phi),
        ],
        [
            sin(psi) * cos(theta),
            sin(phi) * sin(psi) * sin(theta) + cos(psi) * cos(phi),
            sin(psi) * sin(theta) * cos(phi) - sin(phi) * cos(psi),
        ],
        [-sin(theta), cos(theta) * sin(phi), cos(theta) * cos(phi)],
    ]
    lower = [
        [1.0, sin(phi) * tan(theta), cos(phi) * tan(theta)],
        [0.0, cos(phi), -sin(phi)],
        [0.0, sin(phi) / cos(theta), cos(phi) / cos(theta)],
    ]
    return np.block([[np.array(upper), np.zeros((3, 3))], [np.zeros((3, 3)), np.array(lower)]])


@given(attitudes)
def test_both_blocks_are_those_of_equation_6(angles: Array) -> None:
    whole = equation_6(*angles)
    np.testing.assert_allclose(rotation_matrix(angles), whole[:3, :3], atol=1e-14)
    np.testing.assert_allclose(rate_matrix(angles), whole[3:, 3:], atol=1e-13)


@given(st.tuples(vectors, vectors, vectors), vectors)
def test_times_is_the_matrix_product(rows: tuple[Array, Array, Array], vector: Array) -> None:
    matrix = np.array(rows)
    a, b, c = (tuple(row) for row in matrix.tolist())
    np.testing.assert_allclose(times((a, b, c), vector), matrix @ vector, atol=1e-12)


@given(attitudes)
def test_rotation_turns_about_z_then_y_then_x(angles: Array) -> None:
    expected = Rotation.from_euler("ZYX", angles[::-1]).as_matrix()
    np.testing.assert_allclose(rotation_matrix(angles), expected, atol=1e-14)


@given(attitudes, vectors)
def test_rate_matrix_belongs_to_the_rotation(angles: Array, rates: Array) -> None:
    """The rotation's change is the rotation times the cross product with the body's rates."""
    step = 1e-6
    change = step * np.array(times(rate_matrix(angles), rates))
    later, earlier = (np.array(rotation_matrix(angles + sign * change)) for sign in (1.0, -1.0))
    turning = np.array(rotation_matrix(angles)).T @ (later - earlier) / (2.0 * step)
    cross = [turning[2, 1], turning[0, 2], turning[1, 0]]
    np.testing.assert_allclose(cross, rates, atol=1e-6)


@given(attitudes, vectors)
def test_rotation_derivatives(angles: Array, vector: Array) -> None:
    expected = jacobian(lambda a: np.array(times(rotation_matrix(a), vector)), angles)
    derivatives = rotation_derivatives(rotation_matrix(angles), float(angles[2]), tuple(vector))
    np.testing.assert_allclose(derivatives, expected, atol=1e-7)


@given(attitudes, vectors)
def test_rate_derivatives(angles: Array, rates: Array) -> None:
    expected = jacobian(lambda a: np.array(times(rate_matrix(a), rates)), angles)
    np.testing.assert_allclose(rate_derivatives(angles, rates), expected, rtol=1e-6, atol=1e-6)


def test_levelled_points_keep_the_yaw_and_lose_the_tilt() -> None:
    rng = np.random.default_rng(0)
    angles, points = rng.uniform(-1.0, 1.0, (20, 3)), rng.normal(size=(20, 3))
    levelled = level(angles[:, 0], angles[:, 1], points)
    for attitude, point, result in zip(angles, points, levelled, strict=True):
        yaw_alone = rotation_matrix((0.0, 0.0, attitude[2]))
        expected = times(rotation_matrix(attitude), point)
        np.testing.assert_allclose(times(yaw_alone, result), expected)


def test_a_level_vehicle_leaves_points_as_they_are() -> None:
    points = np.random.default_rng(1).normal(size=(5, 3))
    np.testing.assert_array_equal(level(np.zeros(5), np.zeros(5), points), points)
