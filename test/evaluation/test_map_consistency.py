# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.evaluation.map_consistency import seen_again, wall_thickness


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


def test_a_wall_seen_by_two_scans_is_seen_again():
    first, second = wall(0.02, count=500), wall(0.02, offset=0.05, count=500)
    assert seen_again([first, second]) > 0.95


def test_a_wall_drawn_twice_side_by_side_is_thin_and_yet_not_seen_again():
    clouds = [wall(0.03), wall(0.03, offset=2.0)]
    assert wall_thickness(np.vstack(clouds)) < 0.04
    assert seen_again(clouds) == 0.0


@pytest.mark.parametrize(("distance", "share"), [(0.249, 1.0), (0.251, 0.0)])
def test_the_same_place_ends_at_a_quarter_of_a_metre(distance, share):
    assert seen_again([np.zeros((1, 2)), np.array([[distance, 0.0]])]) == share


def test_a_scan_does_not_see_itself_again():
    assert seen_again([wall(0.02), np.array([[100.0, 100.0]])]) == 0.0


@pytest.mark.parametrize("clouds", [[], [np.zeros((3, 2))], [np.zeros((3, 2)), np.zeros((0, 2))]])
def test_one_scan_alone_is_not_seen_again(clouds):
    assert seen_again(clouds) is None
