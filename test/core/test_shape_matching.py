# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic_scans import basin, scan

from msss_graphslam.config.groups import Association
from msss_graphslam.core.compounding import compose, rotation
from msss_graphslam.core.matching.shape_matching import shape_descriptor, shape_distance
from msss_graphslam.core.types import Array


def cloud(seed: int, count: int) -> Array:
    return np.random.default_rng(seed).normal(0.0, 5.0, (count, 2))


def naive_descriptor(points: Array, yaw: float) -> list[list[float]]:
    rows = []
    for i, (x, y) in enumerate(points):
        row = [0.0] * 36
        for j, (u, v) in enumerate(points):
            if i != j:
                degrees = math.degrees(math.atan2(v - y, u - x) + yaw) % 360.0
                row[int(degrees // 10.0)] += 1.0 / (len(points) - 1)
        rows.append(row)
    return rows


def naive_cost(first: list[float], second: list[float]) -> float:
    return 0.5 * sum((a - b) ** 2 / (a + b) for a, b in zip(first, second, strict=True) if a + b)


def naive_distance(first: list[list[float]], second: list[list[float]]) -> float:
    one = sum(min(naive_cost(a, b) for b in second) for a in first) / len(first)
    other = sum(min(naive_cost(a, b) for a in first) for b in second) / len(second)
    return one + other


@given(st.integers(0, 1000), st.integers(2, 25), st.integers(2, 25), st.floats(-7.0, 7.0))
@settings(max_examples=40, deadline=None)
def test_equals_the_equations_written_as_loops(seed: int, n: int, m: int, yaw: float) -> None:
    first, second = cloud(seed, n), cloud(seed + 1, m)
    descriptors = shape_descriptor(first, yaw), shape_descriptor(second, 0.3)
    np.testing.assert_allclose(descriptors[0], naive_descriptor(first, yaw), atol=1e-12)
    expected = naive_distance(naive_descriptor(first, yaw), naive_descriptor(second, 0.3))
    assert shape_distance(*descriptors) == pytest.approx(expected, abs=1e-6)


@given(st.integers(0, 1000), st.integers(1, 150), st.integers(1, 150))
@settings(max_examples=40, deadline=None)
def test_distance_is_symmetric_zero_at_itself_and_at_most_two(seed: int, n: int, m: int) -> None:
    first, second = (
        shape_descriptor(cloud(seed, n), 0.1),
        shape_descriptor(cloud(seed + 1, m), 2.0),
    )
    assert shape_distance(first, first) == 0.0
    distance = shape_distance(first, second)
    assert distance == pytest.approx(shape_distance(second, first), abs=1e-6)
    assert 0.0 <= distance <= 2.0


def test_order_of_the_points_does_not_matter() -> None:
    points = cloud(3, 40)
    shuffled = np.random.default_rng(4).permutation(points)
    first, second = shape_descriptor(points, 0.0), shape_descriptor(shuffled, 0.0)
    assert shape_distance(first, second) == 0.0


def test_disjoint_directions_are_two_apart() -> None:
    along_x = np.column_stack([np.arange(10.0), np.zeros(10)])
    first, second = shape_descriptor(along_x, 0.0), shape_descriptor(along_x, np.pi / 4)
    assert shape_distance(first, second) == pytest.approx(2.0)


@given(st.floats(-3.0, 3.0))
@settings(max_examples=20, deadline=None)
def test_a_known_heading_makes_it_rotation_invariant(yaw: float) -> None:
    points = cloud(7, 50)
    seen_turned = points @ rotation(yaw)
    reference = shape_descriptor(points, 0.05)
    turned = shape_descriptor(seen_turned, 0.05 + yaw)
    assert shape_distance(reference, turned) < 0.01


def test_descriptor_has_a_bounded_size_and_rows_of_shares() -> None:
    descriptor = shape_descriptor(cloud(1, 1000), 0.0)
    assert descriptor.shape == (60, 36)
    np.testing.assert_allclose(descriptor.sum(axis=1), 1.0)


@pytest.mark.parametrize("points", [np.zeros((0, 2)), np.zeros((1, 2)), np.zeros((5, 2))])
def test_scans_without_directions_are_never_alike(points: Array) -> None:
    empty = shape_descriptor(points, 0.0)
    assert np.isfinite(empty).all()
    assert shape_distance(empty, shape_descriptor(cloud(1, 30), 0.0)) >= 0.5


def test_a_scan_without_points_is_infinitely_far() -> None:
    assert shape_distance(np.zeros((0, 36)), shape_descriptor(cloud(1, 30), 0.0)) == math.inf


def test_tells_the_same_place_from_another() -> None:
    rng = np.random.default_rng(5)
    walls = basin(rng)
    place = np.array([7.8, 0.0, 1.6])
    near = compose(place, np.array([0.3, 0.2, 0.4]))
    far = np.array([-7.0, 2.0, 3.0])
    here, again, elsewhere = (
        shape_descriptor(scan(walls, pose, rng)[0], float(pose[2]) + 0.03)
        for pose in (place, near, far)
    )
    threshold = Association().shape_threshold
    assert shape_distance(here, again) < 0.6 * threshold
    assert shape_distance(here, elsewhere) > threshold
