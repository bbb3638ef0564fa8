# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_scans import basin, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.matching.alignment import Alignment
from msss_graphslam.core.matching.line_features import LineFeatures, line_features
from msss_graphslam.core.matching.paired_lines import PairedLines, Pose, Way
from msss_graphslam.core.types import Array

STANDPOINT = np.array([4.0, 4.0, 0.3])
DISPLACEMENT = np.array([0.6, -0.3, 0.15])
GUESS = np.diag([0.3, 0.3, 0.05]) ** 2
CONFIG = Matching()


@pytest.fixture(name="scans")
def two_scans() -> tuple[LineFeatures, LineFeatures]:
    rng = np.random.default_rng(5)
    walls = basin(rng)
    seen = [
        line_features(*scan(walls, pose, rng))
        for pose in (STANDPOINT, compose(STANDPOINT, DISPLACEMENT))
    ]
    assert seen[0] is not None
    assert seen[1] is not None
    return seen[0], seen[1]


def aligned(
    scans: tuple[LineFeatures, LineFeatures], start: Array, config: Matching = CONFIG
) -> Alignment:
    """Align from a start (3,) that is the first guess as well."""
    return Alignment(*scans, start, GUESS, config, start)


def ways(first: LineFeatures, second: LineFeatures) -> tuple[Way, Way]:
    return Way(second, first, backwards=False), Way(first, second, backwards=True)


def test_a_scan_lies_on_its_own_lines(scans: tuple[LineFeatures, LineFeatures]) -> None:
    """Of each point the nearest is itself, and the line about it passes within a deviation."""
    first = scans[0]
    for way in ways(first, first):
        pairs = way.paired((0.0, 0.0, 0.0), 0.01)
        assert len(pairs) == np.count_nonzero(first.flat)
        assert pairs.overlap == 1.0
        np.testing.assert_allclose(
            np.abs(pairs.rows[3]),
            np.abs(np.sum(first.normals * (first.points - first.centres), axis=1))[first.flat]
            / np.sqrt(first.variances + measured(first))[first.flat],
        )


def measured(scan: LineFeatures) -> Array:
    """Return the variances (n,) of the points along their own normals."""
    return np.asarray(np.einsum("ni,nij,nj->n", scan.normals, scan.covariances, scan.normals))


@pytest.mark.parametrize(("distance", "near"), [(0.49, True), (0.51, False)])
def test_the_gate_from_both_sides(distance: float, near: bool) -> None:
    """Of a wall ahead and the same wall farther off; a step moves either way's points."""
    along = 0.1 * (np.arange(41) - 20)
    wall = np.column_stack([np.full(41, 4.0), along])
    scan_of = line_features(wall, np.tile(1e-4 * np.eye(2), (41, 1, 1)))
    assert scan_of is not None
    for way in ways(scan_of, scan_of):
        assert (len(way.paired((distance, 0.0, 0.0), 0.5)) == 41) is near
        assert len(way.paired((distance, 0.0, 0.0), 0.5)) in (0, 41)


@pytest.mark.parametrize("turned", [np.pi, 0.8, 0.7])
def test_a_pair_has_its_normals_on_the_same_side(turned: float) -> None:
    """The cosine of 0.8 rad is just below the bound, that of 0.7 rad above it."""
    along = 0.1 * (np.arange(41) - 20)
    wall = np.column_stack([np.full(41, 4.0), along])
    scan_of = line_features(wall, np.tile(1e-4 * np.eye(2), (41, 1, 1)))
    assert scan_of is not None
    normals = np.tile([-np.cos(turned), -np.sin(turned)], (41, 1))
    pairs = Way(replace(scan_of, normals=normals), scan_of, backwards=False)
    assert (len(pairs.paired((0.0, 0.0, 0.0), 0.5)) > 0) is (turned == 0.7)


def test_a_point_without_a_line_has_no_normal(scans: tuple[LineFeatures, LineFeatures]) -> None:
    none = replace(scans[0], flat=np.zeros_like(scans[0].flat))
    forward, backward = ways(none, scans[1])
    assert not forward.lines.across.any()
    assert backward.lines.across.any()
    assert len(forward.points.places) == np.count_nonzero(scans[1].flat)
    assert len(backward.points.places) == 0
    assert len(forward.paired((0.0, 0.0, 0.0), 10.0)) == 0
    assert len(backward.paired((0.0, 0.0, 0.0), 10.0)) == 0


def test_variances_along_normals(scans: tuple[LineFeatures, LineFeatures]) -> None:
    """What a residual is normalised by is what the point has along the line's normal."""
    first = scans[0]
    rng = np.random.default_rng(1)
    root = 0.1 * rng.normal(size=(len(first.points), 2, 2))
    skewed = replace(first, covariances=root @ np.swapaxes(root, 1, 2))
    pairs = Way(skewed, first, backwards=False).paired((0.0, 0.0, 0.0), 0.01)
    off = np.sum(first.normals * (first.points - first.centres), axis=1)
    wanted = off / np.sqrt(measured(skewed) + first.variances)
    np.testing.assert_allclose(pairs.rows[3], wanted[first.flat], atol=1e-9)


def test_without_pairs_the_start_is_kept(
    scans: tuple[LineFeatures, LineFeatures],
) -> None:
    """Without a pair each stays where it starts, and so does what they would do together."""
    start = np.add(DISPLACEMENT, [0.1, 0.1, 0.03])
    together = aligned(scans, start)
    none = replace(scans[0], flat=np.zeros_like(scans[0].flat))
    other_side = replace(scans[0], normals=-scans[0].normals)
    for other in (none, other_side):
        alone = aligned((other, scans[1]), start)
        assert alone.overlaps.tolist() == [0.0, 0.0]
        np.testing.assert_allclose(alone.apart, [start, start], atol=1e-12)
        np.testing.assert_allclose(alone.pose, start, atol=1e-12)
        assert alone.pairs() is None
    assert together.pairs() is not None


@pytest.mark.parametrize("seed", range(6))
def test_both_ways_end_at_one_displacement_between_them(
    scans: tuple[LineFeatures, LineFeatures], seed: int
) -> None:
    """Where what the pairs of both ways pull at is in balance, and near to what each found."""
    start = DISPLACEMENT + np.random.default_rng(seed).normal(0.0, [0.1, 0.1, 0.03])
    found = aligned(scans, start)
    np.testing.assert_allclose(found.pose, DISPLACEMENT, atol=0.05)
    np.testing.assert_allclose(found.apart, [DISPLACEMENT, DISPLACEMENT], atol=0.08)
    pairs = found.pairs()
    assert pairs is not None
    pull = sum((one.jacobian.T * one.weights) @ one.residuals for one in pairs)
    each = sum(np.abs((one.jacobian.T * one.weights) @ one.residuals) for one in pairs)
    prior = 2.0 * np.linalg.solve(GUESS, found.pose - start)
    stiffness = sum((one.jacobian.T * one.weights) @ one.jacobian for one in pairs)
    left = np.linalg.solve(stiffness, pull + prior)
    assert np.hypot(*left[:2]) < 4e-3
    assert abs(left[2]) < 6e-4
    assert (each > 0.0).all()


def test_the_end_does_not_depend_on_how_wide_the_search_begins(
    scans: tuple[LineFeatures, LineFeatures],
) -> None:
    start = np.add(DISPLACEMENT, [0.1, -0.1, 0.02])
    narrow = aligned(scans, start)
    wide = Alignment(*scans, start, 25.0 * GUESS, CONFIG, start)
    np.testing.assert_allclose(wide.pose, narrow.pose, atol=5e-3)
    np.testing.assert_allclose(wide.overlaps, narrow.overlaps, atol=0.02)


@pytest.mark.parametrize("iterations", [1, 2])
def test_the_fewest_iterations_say_something(
    scans: tuple[LineFeatures, LineFeatures], iterations: int
) -> None:
    found = Alignment(
        *scans, DISPLACEMENT, 25.0 * GUESS, replace(CONFIG, iterations=iterations), DISPLACEMENT
    )
    for one in (found, aligned(scans, DISPLACEMENT)):
        pairs = one.pairs()
        assert pairs is not None
        assert min(len(way.residuals) for way in pairs) > 100


@pytest.mark.parametrize("way", [0, 1])
def test_derivatives_by_the_displacement(
    scans: tuple[LineFeatures, LineFeatures], way: int
) -> None:
    """Of both ways' residuals."""
    pose = [0.62, -0.31, 0.16]

    def paired(moved: list[float]) -> PairedLines:
        there: Pose = (moved[0], moved[1], moved[2])
        return ways(*scans)[way].paired(there, 0.3)

    middle = paired(pose)
    for number in range(3):
        step = np.eye(3)[number] * 1e-7
        before, after = (paired((pose + sign * step).tolist()) for sign in (-1.0, 1.0))
        assert len(before) == len(after) == len(middle)
        slope = (after.rows[3] - before.rows[3]) / 2e-7
        # Deviations turn along with the points, a little.
        np.testing.assert_allclose(slope, middle.rows[number], rtol=0.05, atol=2.0)


@pytest.mark.parametrize("way", [0, 1])
def test_the_twin_is_the_derivative_where_the_normals_are_the_same(
    scans: tuple[LineFeatures, LineFeatures], way: int
) -> None:
    """Of a scan on itself a point's own normal is its line's."""
    pairs = ways(scans[0], scans[0])[way].paired((0.0, 0.0, 0.0), 0.01).matched(np.eye(3))
    np.testing.assert_allclose(pairs.twin, pairs.jacobian, atol=1e-9)
