# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The searches beside those of a tree."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from msss_graphslam.core.matching.loops import nearest, nearest_of_each, neighbours
from msss_graphslam.core.matching.plane_vectors import Vectors


def ascending(seed: int, count: int) -> Vectors:
    """Points of which many share their x with others, as those of a wall along y do."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(0.0, 5.0, (count, 2))
    rows[:, 0] = np.where(rng.random(count) < 0.5, np.round(rows[:, 0]), rows[:, 0])
    return np.sort_complex(rows[:, 0] + 1j * rows[:, 1])


def rows_of(points: Vectors) -> np.ndarray:
    return np.column_stack([points.real, points.imag])


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.floats(0.01, 20.0))
def test_the_nearest_is_the_tree_s(seed: int, count: int, gate: float) -> None:
    points = ascending(seed, count)
    places = np.concatenate([ascending(seed + 1, 40), points[:3]])
    distances, _ = cKDTree(rows_of(points)).query(rows_of(places), distance_upper_bound=gate)
    found = nearest_of_each(points, places, gate)
    np.testing.assert_array_equal(found >= 0, np.isfinite(distances))
    near = found >= 0
    np.testing.assert_allclose(np.abs(points[found[near]] - places[near]), distances[near])


def test_among_no_points_none_is_nearest() -> None:
    assert nearest(np.empty(0, dtype=np.complex128), 1j, 1.0) == -1


@pytest.mark.parametrize(("distance", "number"), [(0.5 - 1e-9, 0), (0.5, -1), (0.5 + 1e-9, -1)])
@pytest.mark.parametrize("direction", [1.0, -1.0, 1j, -1j])
def test_the_gate_from_both_sides(distance: float, number: int, direction: complex) -> None:
    assert nearest(np.zeros(1, dtype=np.complex128), distance * direction, 0.5) == number


@given(st.integers(0, 2**32 - 1), st.integers(7, 60))
def test_the_neighbours_are_the_tree_s(seed: int, count: int) -> None:
    points = ascending(seed, count)
    numbers, squares = np.empty(7, np.int64), np.empty(7)
    tree = cKDTree(rows_of(points))
    for own in range(count):
        neighbours(points, own, numbers, squares)
        wanted, _ = tree.query(rows_of(points[own : own + 1]), k=7)
        np.testing.assert_allclose(np.sqrt(squares), wanted[0], atol=1e-12)
        np.testing.assert_allclose(np.abs(points[numbers] - points[own]), wanted[0], atol=1e-12)
        assert len(set(numbers.tolist())) == 7
