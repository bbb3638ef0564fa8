# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_scans import basin, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.matching.alignment import Alignment
from msss_graphslam.core.matching.both_ways import StackedLines, StackedPoints
from msss_graphslam.core.matching.line_features import LineFeatures, line_features, vectors
from msss_graphslam.core.matching.paired_lines import PairedLines
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


def test_the_nearest_point_of_the_right_scan(scans: tuple[LineFeatures, LineFeatures]) -> None:
    lines = StackedLines.of(*scans)
    places = vectors(np.vstack([scans[0].points[[7]], scans[1].points[[3, 9]]]))
    found = lines.nearest(places, 1, (0.01, 0.01))
    assert found.tolist() == [7, lines.second + 3, lines.second + 9]
    np.testing.assert_allclose(lines.centres[found[1:]], vectors(scans[1].centres[[3, 9]]))


@pytest.mark.parametrize(("distance", "near"), [(0.49, True), (0.51, False)])
def test_the_gate_from_both_sides(
    scans: tuple[LineFeatures, LineFeatures], distance: float, near: bool
) -> None:
    """Beyond the gate, or at a point without a line, there is no normal that is like any other."""
    lines = StackedLines.of(*scans)
    for number, lonely in enumerate(scans):
        farthest = lonely.points[np.argmax(lonely.points[:, 0])]
        places = vectors(farthest[None] + [distance, 0.0])
        found = lines.nearest(places, 1 - number, (0.5, 0.5))
        ends = [lines.second - 1, len(lines.centres) - 1]
        assert (int(found[0]) != ends[number]) is near
        if not near:
            assert lines.across[found[0]] == 0.0


def test_a_point_without_a_line_has_no_normal(scans: tuple[LineFeatures, LineFeatures]) -> None:
    none = replace(scans[0], flat=np.zeros_like(scans[0].flat))
    lines, points = StackedLines.of(none, scans[1]), StackedPoints.of(scans[1], none)
    assert not lines.across[: lines.second].any()
    assert lines.across[lines.second : -1].any()
    assert points.counts.tolist() == [np.count_nonzero(scans[1].flat), 0]


def test_variances_along_normals(scans: tuple[LineFeatures, LineFeatures]) -> None:
    first = scans[0]
    rng = np.random.default_rng(1)
    root = rng.normal(size=(len(first.points), 2, 2))
    skewed = replace(first, covariances=root @ np.swapaxes(root, 1, 2))
    points = StackedPoints.of(skewed, scans[1])
    chosen = np.arange(0, points.second, 3)
    angles = rng.uniform(-np.pi, np.pi, len(chosen))
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    found = points.variances(chosen, np.conj(vectors(normals)))
    covariances = skewed.covariances[skewed.flat][chosen]
    wanted = np.einsum("ni,nij,nj->n", normals, covariances, normals)
    np.testing.assert_allclose(found, wanted)


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


def test_neither_way_knows_of_the_other_at_first(
    scans: tuple[LineFeatures, LineFeatures],
) -> None:
    """Lines of no use to one way do not change where the other one ends."""
    start = np.add(DISPLACEMENT, [0.1, 0.1, 0.03])
    lines, points = StackedLines.of(*scans), StackedPoints.of(scans[1], scans[0])
    x, y, yaw = start.tolist()
    here, lost = (x, y, yaw), (x + 40.0, y, yaw)
    both, forward = (
        PairedLines(lines, points, (here, other), (0.5, 0.5)) for other in (here, lost)
    )
    assert forward.counts == (both.counts[0], 0)
    np.testing.assert_array_equal(forward.rows, both.rows[:, : both.middle])


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
    """Of both ways' residuals, each by its own displacement."""
    lines, points = StackedLines.of(*scans), StackedPoints.of(scans[1], scans[0])
    pose = [0.62, -0.31, 0.16]

    def paired(moved: list[float]) -> PairedLines:
        there = (moved[0], moved[1], moved[2])
        return PairedLines(lines, points, (there, there), (0.3, 0.3))

    middle = paired(pose)
    chosen = slice(0, middle.middle) if way == 0 else slice(middle.middle, None)
    for number in range(3):
        step = np.eye(3)[number] * 1e-7
        before, after = (paired((pose + sign * step).tolist()) for sign in (-1.0, 1.0))
        assert before.counts == after.counts == middle.counts
        slope = (after.rows[3] - before.rows[3]) / 2e-7
        # Deviations turn along with the points, a little.
        np.testing.assert_allclose(slope[chosen], middle.rows[number, chosen], rtol=0.05, atol=2.0)
