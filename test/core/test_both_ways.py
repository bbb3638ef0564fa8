# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_scans import basin, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import compose, inverse, inverse_jacobian
from msss_graphslam.core.matching.alignment import Alignment
from msss_graphslam.core.matching.both_ways import StackedLines, StackedPoints, vectors
from msss_graphslam.core.matching.line_features import LineFeatures, line_features
from msss_graphslam.core.types import Array

STANDPOINT = np.array([4.0, 4.0, 0.3])
DISPLACEMENT = np.array([0.6, -0.3, 0.15])
GUESS = np.diag([0.3, 0.3, 0.05]) ** 2


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


def aligned(scans: tuple[LineFeatures, LineFeatures], start: Array) -> Alignment:
    """Align from the start of each way (2, 3), which is its first guess as well."""
    turned = inverse_jacobian(start[0])
    covariances = np.array([GUESS, turned @ GUESS @ turned.T])
    return Alignment(*scans, start, covariances, Matching(), start)


def both(start: Array) -> Array:
    return np.array([start, inverse(start)])


def test_the_nearest_point_of_the_right_scan(scans: tuple[LineFeatures, LineFeatures]) -> None:
    lines = StackedLines.of(*scans)
    places = vectors(np.vstack([scans[0].points[[7]], scans[1].points[[3, 9]]]))
    found = lines.nearest(places, 1, np.full(2, 0.01))
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
        gates = np.array([0.5, 0.5])
        found = lines.nearest(places, 1 - number, gates)
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


def test_neither_way_knows_of_the_other(scans: tuple[LineFeatures, LineFeatures]) -> None:
    start = both(np.add(DISPLACEMENT, [0.1, 0.1, 0.03]))
    together = aligned(scans, start)
    lost = np.array([start[0], start[1] + [40.0, 0.0, 0.0]])
    forward = aligned(scans, lost)
    np.testing.assert_allclose(forward.poses[0], together.poses[0], atol=1e-3)
    assert forward.overlaps[0] == pytest.approx(together.overlaps[0], abs=0.01)
    assert forward.overlaps[1] == 0.0
    np.testing.assert_array_equal(forward.poses[1], lost[1])
    assert forward.pairs() is None
    assert together.pairs() is not None


def test_both_ways_find_the_displacement(scans: tuple[LineFeatures, LineFeatures]) -> None:
    found = aligned(scans, both(np.add(DISPLACEMENT, [-0.1, 0.15, -0.03])))
    np.testing.assert_allclose(found.poses[0], DISPLACEMENT, atol=0.05)
    np.testing.assert_allclose(inverse(found.poses[1]), DISPLACEMENT, atol=0.05)
