# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from synthetic_scans import corridor, scan

from msss_graphslam.config.groups import Mapping
from msss_graphslam.core.compounding import compose, transform_points, wrap
from msss_graphslam.core.maps import mapping
from msss_graphslam.core.maps.mapping import OccupancyGrid, map_points, occupancy_grid
from msss_graphslam.core.types import Array, Keyframe, Scan

CONFIG = replace(Mapping(), resolution=0.5, free_width=0.0)


def keyframe(
    pose: Array,
    beam_index: list[int],
    body_points: Array,
    motion: Array | None = None,
    heights: Array | None = None,
) -> Keyframe:
    body_points = np.reshape(np.asarray(body_points, dtype=float), (-1, 2))
    motion = np.zeros((max(beam_index, default=0) + 1, 3)) if motion is None else motion
    index = np.array(beam_index, dtype=np.intp)
    beams, points = len(motion), len(index)
    reckoned = np.zeros((beams + 1, 6))
    reckoned[:-1, 2] = 0.0 if heights is None else heights
    content = Scan(
        end_stamp_ns=beams,
        beam_stamps_ns=np.arange(beams),
        motion=motion,
        motion_covariances=np.zeros((beams, 3, 3)),
        reckoned=reckoned,
        beam_index=index,
        body_points=body_points,
        body_covariances=np.tile(0.01 * np.eye(2), (points, 1, 1)),
        points=transform_points(motion[index], body_points),
        covariances=np.tile(0.01 * np.eye(2), (points, 1, 1)),
        twist_covariance=np.zeros((3, 3)),
    )
    return Keyframe(content, np.asarray(pose, dtype=float), np.eye(3))


def value(grid: OccupancyGrid, x: float, y: float) -> int:
    column, row = np.floor((np.array([x, y]) - grid.origin) / grid.resolution).astype(int)
    return int(grid.occupancy[row, column])


def one_beam(*ranges: float) -> OccupancyGrid:
    points = np.column_stack([ranges, np.zeros(len(ranges))])
    return occupancy_grid([keyframe([0.25, 0.25, 0.0], [0] * len(ranges), points)], CONFIG)


def test_map_points_follow_equation_5() -> None:
    rng = np.random.default_rng(0)
    motion, heights = rng.normal(size=(4, 3)), rng.normal(size=4)
    body_points, beams = rng.normal(size=(6, 2)), [0, 0, 1, 3, 3, 2]
    pose = np.array([3.0, -2.0, 0.7])
    cloud = map_points([keyframe(pose, beams, body_points, motion, heights)] * 2)
    assert cloud.shape == (12, 3)
    for row, beam, point in zip(cloud, beams * 2, [*body_points] * 2, strict=True):
        expected = compose(compose(pose, motion[beam]), np.array([*point, 0.0]))[:2]
        np.testing.assert_allclose(row, [*expected, heights[beam]])


def test_no_keyframes_make_an_empty_map() -> None:
    assert map_points([]).shape == (0, 3)
    for nothing in ([], [keyframe(np.zeros(3), [], np.zeros((0, 2)))]):
        grid = occupancy_grid(nothing, CONFIG)
        assert grid.occupancy.size == 0
        assert grid.occupancy.dtype == np.int8


def test_a_beam_is_free_up_to_its_return_and_unknown_behind() -> None:
    grid = one_beam(5.0, 9.0)
    assert [value(grid, x + 0.25, 0.25) for x in (0.0, 1.0, 4.0)] == [40, 40, 40]
    assert value(grid, 5.25, 0.25) == 70
    assert [value(grid, x + 0.25, 0.25) for x in (6.0, 7.0, 8.0)] == [-1, -1, -1]
    assert value(grid, 9.25, 0.25) == 70


def test_order_of_the_returns_does_not_matter() -> None:
    np.testing.assert_array_equal(one_beam(9.0, 5.0).occupancy, one_beam(5.0, 9.0).occupancy)


def test_a_beam_without_return_says_nothing() -> None:
    motion = np.array([[0.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
    grid = occupancy_grid([keyframe(np.zeros(3), [1], [[5.0, 0.0]], motion)], CONFIG)
    assert grid.origin[1] == 3.0
    assert (grid.occupancy.shape[0], value(grid, 1.1, 3.1)) == (1, 40)


def three_beams(left: float, ahead: float, right: float, apart: float) -> Keyframe:
    bearings = np.array([apart, 0.0, -apart])
    ranges = np.array([left, ahead, right])[:, None]
    points = ranges * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return keyframe(np.zeros(3), [0, 1, 2], points)


def test_the_sector_before_a_return_is_free() -> None:
    beams = [three_beams(10.0, 10.0, 10.0, 0.8)]
    narrow, wide = (
        occupancy_grid(beams, replace(CONFIG, free_width=width)) for width in (0.0, 0.4)
    )
    assert (value(narrow, 8.0, 1.3), value(wide, 8.0, 1.3)) == (-1, 40)
    assert value(wide, 7.8, 2.1) == -1


def test_a_shorter_neighbour_bounds_the_sector_on_its_side() -> None:
    grid = occupancy_grid([three_beams(5.0, 10.0, 10.0, 0.5)], replace(CONFIG, free_width=0.4))
    assert [value(grid, 8.0, y) for y in (0.1, -1.3, 1.3)] == [40, 40, -1]
    assert value(grid, 4.0, 0.6) == 40


@pytest.mark.parametrize("width", [0.3, 0.11, 0.05])
@pytest.mark.parametrize("heading", [0.0, 0.4, 0.8])
def test_every_cell_inside_a_sector_is_free(width: float, heading: float) -> None:
    beams = replace(three_beams(10.0, 10.0, 10.0, 0.5), pose=np.array([0.0, 0.0, heading]))
    grid = occupancy_grid([beams], replace(CONFIG, resolution=0.1, free_width=width))
    rows, columns = np.indices(np.add(grid.occupancy.shape, 1))
    x, y = grid.origin[0] + 0.1 * columns, grid.origin[1] + 0.1 * rows
    angles = wrap(np.arctan2(y, x) - heading)
    corner = (np.abs(angles) < 0.5 * width) & (np.hypot(x, y) < 9.8)
    assert everywhere(corner).sum() > 40.0 * 10.0 * width
    assert (grid.occupancy[everywhere(corner)] == 40).all()
    at_the_wall = everywhere(np.hypot(x, y) > 9.91)
    assert at_the_wall.any()
    assert (grid.occupancy[at_the_wall] != 40).all()


def everywhere(corner: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether all four corners of a cell are."""
    return corner[1:, 1:] & corner[1:, :-1] & corner[:-1, 1:] & corner[:-1, :-1]


def test_what_lies_beside_the_grid_is_left_out() -> None:
    bearings = np.radians([-179.9, 0.0, 90.0])
    ranges = np.array([[10.0], [10.0], [0.8]])
    points = ranges * np.column_stack([np.cos(bearings), np.sin(bearings)])
    beams = keyframe([0.0, 0.05, 0.0], [0, 1, 2], points)
    grid = occupancy_grid([beams], replace(CONFIG, free_width=0.4))
    assert grid.occupancy.shape == (2, 41)
    assert (grid.occupancy[0] != -1).mean() > 0.9
    assert (grid.occupancy[1] != -1).mean() < 0.1


def test_evidence_adds_up_over_scans_but_not_inside_one() -> None:
    once = keyframe([0.25, 0.25, 0.0], [0], [[5.0, 0.0]])
    twice = keyframe([0.25, 0.25, 0.0], [0, 1], [[5.0, 0.0], [5.0, 0.0]])
    assert value(occupancy_grid([twice], CONFIG), 5.3, 0.3) == 70
    assert value(occupancy_grid([once, once], CONFIG), 5.3, 0.3) == 84
    assert value(occupancy_grid([once, once], CONFIG), 2.3, 0.3) == 31


def test_a_return_outweighs_what_passed_in_the_same_scan() -> None:
    beams = keyframe([0.25, 0.25, 0.0], [0, 1], [[5.0, 0.0], [8.0, 0.0]])
    assert value(occupancy_grid([beams], CONFIG), 5.3, 0.3) == 70


def test_beams_start_at_the_sonar() -> None:
    behind = keyframe(np.zeros(3), [0, 1], [[5.0, 0.1], [-5.0, 0.1]])
    position = np.array([2.0, 0.0])
    grid = occupancy_grid([behind], replace(CONFIG, resolution=0.25), position)
    assert value(grid, 1.9, 0.05) == 40
    ahead_only = occupancy_grid([keyframe(np.zeros(3), [0], [[5.0, 0.1]])], CONFIG, position)
    assert ahead_only.origin[0] == 2.0


def test_too_large_a_map_is_made_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    cross = [keyframe(np.zeros(3), [0, 1], [[9.9, 0.0], [0.0, 9.9]])]
    assert occupancy_grid(cross, CONFIG).occupancy.shape == (20, 20)
    monkeypatch.setattr(mapping, "LARGEST_CELL_COUNT", 400)
    assert occupancy_grid(cross, CONFIG).resolution == 0.5
    monkeypatch.setattr(mapping, "LARGEST_CELL_COUNT", 399)
    grid = occupancy_grid(cross, CONFIG)
    assert (grid.resolution, grid.occupancy.shape) == (1.0, (10, 10))


def test_a_point_very_far_away_does_not_exhaust_the_memory() -> None:
    grid = occupancy_grid([keyframe(np.zeros(3), [0, 1], [[1e7, 1e7], [1.0, 0.0]])], CONFIG)
    assert grid.occupancy.size <= mapping.LARGEST_CELL_COUNT


@given(st.integers(0, 1000), st.floats(0.05, 2.0))
@settings(max_examples=25, deadline=None)
def test_every_point_is_on_the_grid_and_seen(seed: int, resolution: float) -> None:
    rng = np.random.default_rng(seed)
    frames = [
        keyframe(
            rng.uniform(-20.0, 20.0, 3),
            rng.integers(0, 5, 12).tolist(),
            rng.uniform(-8.0, 8.0, (12, 2)),
            rng.normal(size=(5, 3)),
        )
        for _ in range(3)
    ]
    grid = occupancy_grid(frames, replace(CONFIG, resolution=resolution))
    assert all(value(grid, x, y) != -1 for x, y, _ in map_points(frames))


def test_a_corridor_is_free_inside_with_walls_and_nothing_known_outside() -> None:
    rng = np.random.default_rng(1)
    frames = []
    for x in np.arange(0.0, 6.0, 1.0):
        pose = np.array([x, 0.2, 0.1 * x])
        points, _ = scan(corridor(), pose, rng, outliers=0.0)
        frames.append(keyframe(pose, list(range(len(points))), points))
    grid = occupancy_grid(frames, replace(Mapping(), resolution=0.2))
    stations = np.arange(0.1, 5.0, 0.2)
    inside = [value(grid, x, y) for x in stations for y in (-2.0, 0.1, 2.0)]
    walls = [
        max(value(grid, x, y + shift) for shift in (-0.2, 0.0, 0.2))
        for x in stations
        for y in (-3.01, 3.01)
    ]
    rows = grid.origin[1] + (np.arange(len(grid.occupancy)) + 0.5) * grid.resolution
    assert min(inside) >= 0
    assert max(inside) < 40
    assert min(walls) >= 70
    assert (grid.occupancy[np.abs(rows) > 3.9] <= 70).all()
    assert (np.abs(rows) < 5.0).all()
