# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.matching.line_features import NEIGHBOURS, LineFeatures, line_features
from msss_graphslam.core.types import Array

VARIANCE = 0.01
SPACING = 0.1


def features(points: Array) -> LineFeatures:
    found = line_features(points, np.tile(VARIANCE * np.eye(2), (len(points), 1, 1)))
    assert found is not None
    return found


def wall(normal_angle: float, distance: float = 4.0, count: int = 41) -> Array:
    """Points along a wall whose foot lies in the direction ``normal_angle``."""
    normal = np.array([np.cos(normal_angle), np.sin(normal_angle)])
    along = SPACING * (np.arange(count) - count // 2)
    return distance * normal + along[:, None] * np.array([-normal[1], normal[0]])


@pytest.mark.parametrize("angle", np.linspace(-3.0, 3.0, 7))
def test_a_wall_has_one_normal_towards_the_sensor(angle: float) -> None:
    found = features(wall(angle))
    np.testing.assert_allclose(
        found.normals, np.tile([-np.cos(angle), -np.sin(angle)], (41, 1)), atol=1e-9
    )
    np.testing.assert_allclose(np.sum(found.normals * found.centres, axis=1), -4.0)
    assert found.flat.all()


def test_a_line_is_the_least_squares_line_of_the_neighbours() -> None:
    rng = np.random.default_rng(0)
    points = wall(0.4) + rng.normal(0.0, 0.005, (41, 2))
    found = features(points)
    order = np.argsort(np.linalg.norm(points - points[20], axis=1))[:NEIGHBOURS]
    local = points[order]
    np.testing.assert_allclose(found.centres[20], local.mean(axis=0))
    _, _, axes = np.linalg.svd(local - local.mean(axis=0))
    assert abs(axes[1] @ found.normals[20]) == pytest.approx(1.0)
    assert found.reach[20] == pytest.approx(np.linalg.norm(local[-1] - points[20]))


def test_the_variance_is_that_of_the_points_or_of_the_wall_if_rougher() -> None:
    np.testing.assert_allclose(features(wall(0.0)).variances, VARIANCE)
    rough = wall(0.0)
    rough[::2, 0] += 0.3
    assert (features(rough).variances > 1.5 * VARIANCE).all()


def test_the_variance_is_taken_along_the_normal() -> None:
    points = wall(0.0)
    covariances = np.tile(np.diag([0.04, 9.0]), (len(points), 1, 1))
    found = line_features(points, covariances)
    assert found is not None
    np.testing.assert_allclose(found.variances, 0.04)


@pytest.mark.parametrize(("count", "known"), [(NEIGHBOURS - 1, False), (NEIGHBOURS, True)])
def test_the_fewest_points(count: int, known: bool) -> None:
    points = wall(0.0, count=count)
    assert (line_features(points, np.tile(np.eye(2), (count, 1, 1))) is not None) is known


def test_no_points_no_lines() -> None:
    assert line_features(np.empty((0, 2)), np.empty((0, 2, 2))) is None


def test_scattered_points_are_no_line() -> None:
    points = np.random.default_rng(1).uniform(-5.0, 5.0, (300, 2))
    assert features(points).flat.mean() < 0.1


def test_a_corner_is_no_line_and_its_walls_are() -> None:
    along = SPACING * np.arange(40)
    first = np.column_stack([3.0 - along, np.full(40, 3.0)])
    second = np.column_stack([np.full(39, 3.0), 3.0 - along[1:]])
    found = features(np.vstack([first, second]))
    from_corner = np.linalg.norm(found.points - 3.0, axis=1)
    assert not found.flat[from_corner < 1.5 * SPACING].any()
    assert found.flat[from_corner > 4.5 * SPACING].all()


@pytest.mark.parametrize(("distance", "flat"), [(4.9, True), (5.7, False)])
def test_a_lone_point_far_from_the_others_has_no_line(distance: float, flat: bool) -> None:
    points = wall(0.0)
    lone = points[-1] + [0.0, distance]
    assert bool(features(np.vstack([points, lone])).flat[-1]) is flat


def test_points_in_one_place_do_no_harm() -> None:
    found = features(np.ones((20, 2)))
    assert not found.flat.any()
    assert np.isfinite(found.normals).all()
    assert np.isfinite(found.variances).all()
