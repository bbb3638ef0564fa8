# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.evaluation.map_consistency import wall_thickness


def wall(thickness, offset=0.0, count=3000):
    generator = np.random.default_rng(4)
    return np.column_stack(
        [generator.uniform(0.0, 30.0, count), generator.normal(offset, thickness, count)]
    )


@pytest.mark.parametrize("thickness", [0.02, 0.05, 0.1])
def test_a_straight_wall_has_the_spread_of_its_points(thickness):
    assert wall_thickness(wall(thickness)) == pytest.approx(thickness, rel=0.1)


def test_thickness_does_not_depend_on_the_walls_direction():
    points = wall(0.05)
    turned = points @ np.array([[0.6, 0.8], [-0.8, 0.6]]) + [100.0, -40.0]
    assert wall_thickness(turned) == pytest.approx(wall_thickness(points), rel=1e-6)


def test_a_wall_seen_twice_is_thick():
    double = np.vstack([wall(0.03), wall(0.03, offset=0.2)])
    assert wall_thickness(double) == pytest.approx(np.hypot(0.03, 0.1), rel=0.1)


def test_height_does_not_count():
    points = wall(0.05)
    tall = np.column_stack([points, np.linspace(-50.0, 0.0, len(points))])
    assert wall_thickness(tall) == wall_thickness(points)


def test_specks_are_no_wall():
    lonely = np.column_stack([np.arange(50.0), np.zeros(50)])
    assert wall_thickness(lonely) is None
    assert wall_thickness(np.zeros((0, 2))) is None


@pytest.mark.parametrize(("count", "is_wall"), [(8, False), (9, True)])
def test_a_wall_needs_eight_neighbours(count, is_wall):
    points = np.column_stack([np.linspace(0.0, 0.4, count), np.zeros(count)])
    assert (wall_thickness(points) is not None) == is_wall
