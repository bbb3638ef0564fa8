# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2
from synthetic_scans import basin, scan

from msss_graphslam.core.compounding import compose, rotation, transform_points
from msss_graphslam.core.matching.correspondence import Pairs, Points, correspondences
from msss_graphslam.core.types import Array

GATE = float(chi2.ppf(0.95, 2))


def cloud(rng: np.random.Generator, count: int) -> Points:
    factors = rng.normal(0.0, 0.3, (count, 2, 2))
    covariances = factors @ np.swapaxes(factors, 1, 2) + 0.01 * np.eye(2)
    return Points(rng.uniform(-4.0, 4.0, (count, 2)), covariances)


def naive(reference: Points, current: Points, pose: Array, covariance: Array) -> dict[int, int]:
    """The compatible nearest reference point of every current point, by loops over all pairs."""
    turn, pairs = rotation(pose[2]), {}
    for i, (place, spread) in enumerate(zip(current.places, current.covariances, strict=True)):
        x, y = turn @ place
        jacobian = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
        own = turn @ spread @ turn.T + jacobian @ covariance @ jacobian.T
        distances = []
        for other, other_spread in zip(reference.places, reference.covariances, strict=True):
            error = other - (pose[:2] + turn @ place)
            distances.append(error @ np.linalg.inv(own + other_spread) @ error)
        if min(distances) <= GATE:
            pairs[i] = int(np.argmin(distances))
    return pairs


@given(st.integers(0, 10_000), st.integers(1, 30), st.integers(1, 30))
@settings(max_examples=60, deadline=None)
def test_pairs_are_those_of_all_pairs_tried(seed: int, n: int, m: int) -> None:
    rng = np.random.default_rng(seed)
    reference, current = cloud(rng, n), cloud(rng, m)
    pose = rng.uniform([-1.0, -1.0, -3.0], [1.0, 1.0, 3.0])
    covariance = np.diag(rng.uniform(0.0, 0.2, 3) ** 2)
    expected = naive(reference, current, pose, covariance)
    pairs = correspondences(reference, current, pose, covariance, GATE)
    assert pairs.reference.tolist() == list(expected.values())
    places = transform_points(pose, current.places[list(expected)])
    np.testing.assert_allclose(pairs.errors, reference.places[pairs.reference] - places)


def test_jacobians_equal_numerical_ones() -> None:
    rng = np.random.default_rng(2)
    points = cloud(rng, 20)
    pose = np.array([0.3, -0.2, 0.7])
    moved = Points(transform_points(pose, points.places), points.covariances)
    pairs = correspondences(moved, points, pose, np.zeros((3, 3)), GATE)
    np.testing.assert_array_equal(pairs.reference, np.arange(20))
    step = 1e-6
    for axis in range(3):
        change = step * np.eye(3)[axis]
        ahead = transform_points(pose + change, points.places)
        behind = transform_points(pose - change, points.places)
        np.testing.assert_allclose(
            pairs.jacobians[:, :, axis], (ahead - behind) / (2.0 * step), atol=1e-8
        )


def test_uncertainty_of_the_displacement_opens_the_gate_but_not_the_weights() -> None:
    rng = np.random.default_rng(3)
    walls, place = basin(rng), np.array([7.8, 0.0, 1.6])
    reference, current = (Points(*scan(walls, place, rng)) for _ in range(2))
    off = compose(np.zeros(3), np.array([0.5, 0.5, 0.0]))
    narrow, wide = (
        correspondences(reference, current, off, deviation**2 * np.eye(3), GATE)
        for deviation in (0.001, 0.5)
    )
    assert len(narrow.errors) < 0.6 * len(wide.errors)
    assert smallest_weight(narrow) > 0.0
    largest_variance = max(np.linalg.eigvalsh(s.covariances).max() for s in (reference, current))
    assert smallest_weight(wide) >= 0.5 / largest_variance


def smallest_weight(pairs: Pairs) -> float:
    return float(np.linalg.eigvalsh(pairs.weights).min())


def test_nothing_compatible_gives_no_pairs() -> None:
    rng = np.random.default_rng(4)
    pairs = correspondences(
        cloud(rng, 5), cloud(rng, 6), np.array([100.0, 0.0, 0.0]), 0.01 * np.eye(3), GATE
    )
    assert pairs.errors.shape == (0, 2)
