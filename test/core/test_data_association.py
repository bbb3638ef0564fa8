# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msss_graphslam.config.groups import Association
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.graph.data_association import Candidate, associate, squared_mahalanobis
from msss_graphslam.core.matching.shape_matching import shape_descriptor, shape_distance
from msss_graphslam.core.types import Array

Store = tuple[Array, Array, list[Array]]


def store(seed: int, count: int) -> Store:
    """Poses on a patch of 4 m, covariances, and descriptors of three different shapes."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform([-2.0, -2.0, -3.1], [2.0, 2.0, 3.1], (count, 3))
    factors = rng.normal(0.0, 1.0, (count, 3, 3))
    covariances = factors @ np.swapaxes(factors, 1, 2) + 0.1 * np.eye(3)
    shapes = [rng.normal(0.0, scale, (30, 2)) for scale in ([5, 1], [1, 5], [5, 5])]
    descriptors = [
        shape_descriptor(shapes[rng.integers(3)] + rng.normal(0.0, 0.1, (30, 2)), 0.0)
        for _ in range(count)
    ]
    return poses, covariances, descriptors


def with_current(seed: int, count: int) -> tuple[Store, tuple[Array, Array, Array]]:
    poses, covariances, descriptors = store(seed, count + 1)
    current = poses[-1], covariances[-1], descriptors[-1]
    return (poses[:-1], covariances[:-1], descriptors[:-1]), current


def naive_mahalanobis(first: Array, p_first: Array, second: Array, p_second: Array) -> float:
    difference = first - second
    difference[2] = wrap(difference[2])
    return float(difference @ np.linalg.inv((p_first + p_second) / 2.0) @ difference)


def everything(earlier: Store, current: tuple[Array, Array, Array]) -> list[Candidate]:
    """Algorithm 3 to the letter: both distances for all keyframes, then both gates."""
    config, found = Association(), []
    for index in range(len(earlier[0]) - 1):
        mahalanobis = naive_mahalanobis(
            earlier[0][index], earlier[1][index], current[0], current[1]
        )
        shape = shape_distance(earlier[2][index], current[2])
        if mahalanobis < config.mahalanobis_threshold and shape < config.shape_threshold:
            found.append(Candidate(index, pytest.approx(mahalanobis), shape))
    return found


@given(st.integers(0, 10_000), st.integers(0, 12))
@settings(max_examples=50, deadline=None)
def test_same_answer_as_both_distances_for_all(seed: int, count: int) -> None:
    earlier, current = with_current(seed, count)
    accepted = [c for c in associate(*earlier, *current, Association()) if c.accepted]
    assert accepted == everything(earlier, current)


def test_both_answers_and_refusals_occur() -> None:
    outcomes = [
        candidate.refusal
        for seed in range(5)
        for earlier, current in [with_current(seed, 12)]
        for candidate in associate(*earlier, *current, Association())
    ]
    assert set(outcomes) == {"", "shape_differs"}


def test_shapes_are_compared_only_inside_the_gate(monkeypatch: pytest.MonkeyPatch) -> None:
    (poses, covariances, descriptors), current = with_current(1, 20)
    poses = poses + np.where(np.arange(20)[:, None] < 15, [1000.0, 0.0, 0.0], 0.0)
    compared = []

    def count(first: Array, second: Array) -> float:
        compared.append(first)
        return shape_distance(first, second)

    monkeypatch.setattr("msss_graphslam.core.graph.data_association.shape_distance", count)
    candidates = associate(poses, covariances, descriptors, *current, Association())
    assert len(compared) == len(candidates) <= 4
    assert all(candidate.index >= 15 for candidate in candidates)


def test_direct_predecessor_is_left_out() -> None:
    (poses, covariances, descriptors), _ = with_current(2, 3)
    current = poses[-1], covariances[-1], descriptors[-1]
    candidates = associate(poses, covariances, descriptors, *current, Association())
    assert all(candidate.index < 2 for candidate in candidates)
    assert associate(poses[-1:], covariances[-1:], descriptors[-1:], *current, Association()) == []


@pytest.mark.parametrize(("offset", "inside"), [(0.999, True), (1.001, False)])
def test_mahalanobis_threshold_from_both_sides(offset: float, inside: bool) -> None:
    config = replace(Association(), mahalanobis_threshold=4.0)
    poses = np.array([[2.0 * offset, 0.0, 0.0], [0.0, 0.0, 0.0]])
    covariances = np.broadcast_to(np.eye(3), (2, 3, 3))
    descriptor = shape_descriptor(np.random.default_rng(0).normal(size=(20, 2)), 0.0)
    candidates = associate(
        poses, covariances, [descriptor] * 2, np.zeros(3), np.eye(3), descriptor, config
    )
    assert [candidate.index for candidate in candidates] == ([0] if inside else [])


@pytest.mark.parametrize(("margin", "refusal"), [(1e-6, ""), (-1e-6, "shape_differs")])
def test_shape_threshold_from_both_sides(margin: float, refusal: str) -> None:
    rng = np.random.default_rng(0)
    first, second = (shape_descriptor(rng.normal(size=(20, 2)), 0.0) for _ in range(2))
    distance = shape_distance(first, second)
    config = replace(Association(), shape_threshold=distance + margin)
    (candidate,) = associate(
        np.zeros((2, 3)),
        np.broadcast_to(np.eye(3), (2, 3, 3)),
        [first, first],
        np.zeros(3),
        np.eye(3),
        second,
        config,
    )
    assert candidate == Candidate(0, 0.0, distance, refusal)


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_mahalanobis_equals_the_equation(seed: int) -> None:
    (poses, covariances, _), (pose, covariance, _) = with_current(seed, 8)
    expected = [
        naive_mahalanobis(p, c, pose, covariance) for p, c in zip(poses, covariances, strict=True)
    ]
    np.testing.assert_allclose(squared_mahalanobis(poses, covariances, pose, covariance), expected)


def test_mahalanobis_is_the_squared_form_on_the_mean_covariance() -> None:
    poses, covariances = np.array([[3.0, 0.0, 0.0]]), np.eye(3)[None]
    distances = squared_mahalanobis(poses, covariances, np.zeros(3), 3.0 * np.eye(3))
    np.testing.assert_allclose(distances, [9.0 / 2.0])


def test_headings_are_compared_across_the_turn() -> None:
    poses, covariances = np.array([[0.0, 0.0, 3.1]]), np.eye(3)[None]
    distances = squared_mahalanobis(poses, covariances, np.array([0.0, 0.0, -3.1]), np.eye(3))
    np.testing.assert_allclose(distances, [(2.0 * np.pi - 6.2) ** 2])


@pytest.mark.parametrize(
    "covariance",
    [
        np.zeros((3, 3)),
        np.diag([1.0, 1.0, 0.0]),
        np.ones((3, 3)),
        np.diag([1.0, -1.0, 1.0]),
        np.full((3, 3), np.nan),
        np.diag([np.inf, 1.0, 1.0]),
    ],
)
def test_unusable_covariances_are_infinitely_far(covariance: Array) -> None:
    covariances = np.stack([covariance, np.eye(3)])
    distances = squared_mahalanobis(np.zeros((2, 3)), covariances, np.zeros(3), 0.0 * np.eye(3))
    np.testing.assert_array_equal(distances, [np.inf, 0.0])


def test_a_pose_that_is_not_finite_is_infinitely_far() -> None:
    poses = np.array([[np.nan, 0.0, 0.0], [0.0, np.inf, 0.0]])
    covariances = np.broadcast_to(np.eye(3), (2, 3, 3))
    distances = squared_mahalanobis(poses, covariances, np.zeros(3), np.eye(3))
    assert np.isinf(distances).all()


@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_mahalanobis_does_not_depend_on_the_unit_of_length(length: float) -> None:
    (poses, covariances, _), (pose, covariance, _) = with_current(3, 6)
    unit = np.array([length, length, 1.0])
    scaled = np.outer(unit, unit)
    np.testing.assert_allclose(
        squared_mahalanobis(poses * unit, covariances * scaled, pose * unit, covariance * scaled),
        squared_mahalanobis(poses, covariances, pose, covariance),
    )
