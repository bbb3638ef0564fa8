# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numerical_derivatives import jacobian

from msss_graphslam.core.compounding import (
    between,
    between_covariance,
    carried_over,
    compose,
    compose_covariance,
    compose_jacobians,
    inverse,
    inverse_jacobian,
    rotation,
    transform_points,
    wrap,
)
from msss_graphslam.core.types import Array

ORIGIN = np.zeros(3)
coordinates = st.floats(-100.0, 100.0)
any_angle = st.floats(-20.0, 20.0)
poses = st.tuples(coordinates, coordinates, any_angle).map(np.array)
inner_poses = st.tuples(coordinates, coordinates, st.floats(-1.5, 1.5)).map(np.array)


def homogeneous(pose: Array) -> Array:
    """An oracle: the pose as a matrix, compounding as its product."""
    x, y, yaw = pose
    return np.array(
        [[np.cos(yaw), -np.sin(yaw), x], [np.sin(yaw), np.cos(yaw), y], [0.0, 0.0, 1.0]]
    )


def assert_same_pose(first: Array, second: Array, tolerance: float = 1e-9) -> None:
    np.testing.assert_allclose(first[..., :2], second[..., :2], atol=tolerance)
    np.testing.assert_allclose(wrap(first[..., 2] - second[..., 2]), 0.0, atol=tolerance)


@given(any_angle)
def test_wrap_keeps_the_direction_and_the_interval(angle: float) -> None:
    wrapped = float(wrap(angle))
    assert -np.pi < wrapped <= np.pi
    assert np.exp(1j * wrapped) == pytest.approx(np.exp(1j * angle), abs=1e-12)


def test_half_a_turn_is_plus_pi_from_both_sides() -> None:
    np.testing.assert_array_equal(wrap(np.array([np.pi, -np.pi])), [np.pi, np.pi])


@given(poses, poses)
def test_compose_is_the_product_of_matrices(first: Array, second: Array) -> None:
    product = homogeneous(first) @ homogeneous(second)
    np.testing.assert_allclose(homogeneous(compose(first, second)), product, atol=1e-9)


@given(poses)
def test_inverse_undoes_from_both_sides(pose: Array) -> None:
    assert_same_pose(compose(pose, inverse(pose)), ORIGIN)
    assert_same_pose(compose(inverse(pose), pose), ORIGIN)


@given(poses, poses, poses)
def test_compose_is_associative(first: Array, second: Array, third: Array) -> None:
    left = compose(compose(first, second), third)
    assert_same_pose(left, compose(first, compose(second, third)), 1e-8)


@given(poses, poses)
def test_between_leads_from_the_first_to_the_second(first: Array, second: Array) -> None:
    assert_same_pose(compose(first, between(first, second)), second, 1e-8)


@given(inner_poses, inner_poses)
def test_compose_jacobians(first: Array, second: Array) -> None:
    by_first, by_second = compose_jacobians(first, second)
    np.testing.assert_allclose(by_first, jacobian(lambda p: compose(p, second), first), atol=1e-6)
    np.testing.assert_allclose(by_second, jacobian(lambda p: compose(first, p), second), atol=1e-6)


@given(inner_poses)
def test_inverse_jacobian(pose: Array) -> None:
    np.testing.assert_allclose(inverse_jacobian(pose), jacobian(inverse, pose), atol=1e-6)


def test_every_function_broadcasts_over_leading_axes() -> None:
    rng = np.random.default_rng(0)
    one, many = rng.normal(size=3), rng.normal(size=(2, 4, 3))
    for index in np.ndindex(2, 4):
        np.testing.assert_array_equal(compose(one, many)[index], compose(one, many[index]))
        np.testing.assert_array_equal(compose(many, one)[index], compose(many[index], one))
        np.testing.assert_array_equal(inverse(many)[index], inverse(many[index]))
        np.testing.assert_array_equal(rotation(many[..., 2])[index], rotation(many[index][2]))
        stacked, single = compose_jacobians(one, many), compose_jacobians(one, many[index])
        np.testing.assert_array_equal(stacked[0][index], single[0])
        np.testing.assert_array_equal(stacked[1][index], single[1])


@pytest.mark.parametrize(
    ("compounded", "covariance"), [(between, between_covariance), (compose, compose_covariance)]
)
def test_a_compounded_covariance_equals_a_monte_carlo(
    compounded: Callable[..., Array], covariance: Callable[..., Array]
) -> None:
    rng = np.random.default_rng(1)
    first, second = np.array([1.0, -2.0, 0.7]), np.array([4.0, 3.0, -1.1])
    covariances = [np.diag([0.02, 0.05, 0.01]) ** 2, np.diag([0.04, 0.01, 0.02]) ** 2]
    samples = compounded(
        rng.multivariate_normal(first, covariances[0], 1_000_000),
        rng.multivariate_normal(second, covariances[1], 1_000_000),
    )
    expected = covariance(first, covariances[0], second, covariances[1])
    np.testing.assert_allclose(np.cov(samples.T), expected, rtol=0.02, atol=1e-5)


def test_points_are_transformed_by_one_pose_or_by_one_each() -> None:
    rng = np.random.default_rng(2)
    frames, points = rng.normal(size=(5, 3)), rng.normal(size=(5, 2))
    each = transform_points(frames, points)
    for frame, point, placed in zip(frames, points, each, strict=True):
        expected = homogeneous(frame) @ np.append(point, 1.0)
        np.testing.assert_allclose(placed, expected[:2], atol=1e-12)
        np.testing.assert_allclose(transform_points(frame, point[None])[0], placed, atol=1e-15)


@given(poses, poses)
def test_what_is_carried_over_is_the_corrected_pose(corrected: Array, reckoned: Array) -> None:
    def spatial(planar: Array, z: float) -> Array:
        return np.array([planar[0], planar[1], z, 0.1, -0.2, wrap(planar[2])])

    placed = carried_over(spatial(corrected, -3.0), spatial(reckoned, -2.0))
    assert_same_pose(compose(placed[[0, 1, 5]], reckoned), corrected, 1e-6)
    np.testing.assert_allclose(placed[[2, 3, 4]], [-1.0, 0.0, 0.0])
