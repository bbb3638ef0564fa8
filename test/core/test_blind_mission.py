# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Walls, then minutes without any, then walls again."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from moving_scans import BASIN, CORRIDOR, moving_scans

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.graph.graph_slam import GraphSlam
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, Scan

TWIST = np.array([0.03, -0.008, 0.0005])
"""A lasting error of dead reckoning of about one standard deviation."""
DOUBT = np.diag([0.03, 0.01, 0.0005]) ** 2
BEFORE, BLIND, AFTER = 8, 14, 6


@dataclass(frozen=True)
class Course:
    """What the graph said of each keyframe when it was new."""

    errors: Array
    covariances: Array
    final_errors: Array

    @property
    def deviations(self) -> Array:
        """The standard deviations of the position (n,), in its worst direction."""
        return np.sqrt(np.linalg.eigvalsh(self.covariances[:, :2, :2])[:, -1])

    @property
    def distances(self) -> Array:
        """The position errors (n,)."""
        return np.asarray(np.hypot(*self.errors[:, :2].T))


def emptied(scan: Scan) -> Scan:
    return replace(
        scan,
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
        points=np.zeros((0, 2)),
        covariances=np.zeros((0, 2, 2)),
    )


def course(scans: list[Scan], truth: Array) -> Course:
    slam = GraphSlam(Configuration(), ESTIMATORS["full"])
    errors, covariances = [], []
    for number, scan in enumerate(scans):
        slam.add_scan(scan)
        poses = slam.front_end.poses
        errors.append(between(poses[0], poses[-1]) - between(truth[0], truth[number]))
        covariances.append(slam.front_end.nodes[-1].covariance)
        assert np.isfinite(slam.front_end.correction().covariance).all()
    found = np.array([between(poses[0], pose) for pose in poses])
    final = found - between(truth[0], truth[: len(scans)])
    final[:, 2] = wrap(final[:, 2])
    rows = np.array(errors)
    rows[:, 2] = wrap(rows[:, 2])
    return Course(rows, np.array(covariances), final)


@cache
def blind() -> Course:
    scans, truth = moving_scans(BASIN, BEFORE + BLIND + AFTER, twist=TWIST, doubt=DOUBT)
    seen = [*range(BEFORE), *range(BEFORE + BLIND, len(scans))]
    return course(
        [scan if number in seen else emptied(scan) for number, scan in enumerate(scans)], truth
    )


def test_without_walls_the_covariance_grows_turn_by_turn() -> None:
    spreads = blind().deviations[BEFORE - 1 : BEFORE + BLIND]
    assert (np.diff(spreads) > 0.0).all()
    assert spreads[0] < 0.1
    assert spreads[-1] > 1.0


def test_it_grows_as_a_lasting_error_does() -> None:
    """Of turns that err independently 14 would be 3.7 times as far off as one."""
    spreads = blind().deviations[BEFORE : BEFORE + BLIND]
    assert spreads[-1] > 6.0 * spreads[0]


def test_the_errors_are_as_large_as_stated() -> None:
    found = blind()
    solved = np.linalg.solve(found.covariances[1:], found.errors[1:, :, None])[..., 0]
    squared = np.sum(found.errors[1:] * solved, axis=1)
    assert squared.max() < 14.2
    assert found.distances[BEFORE + BLIND - 1] > 0.5


def test_when_walls_come_back_the_place_is_known_again() -> None:
    """Not by the first scan alone, which may still be too far off to be matched."""
    found = blind()
    back = BEFORE + BLIND + 1
    assert found.distances[back:].max() < 0.15
    assert found.deviations[back:].max() < 0.5
    final = np.hypot(*found.final_errors[:, :2].T)
    assert final[:BEFORE].max() < 0.15
    assert final[back:].max() < 0.15


def test_in_a_corridor_the_way_along_it_is_not_known() -> None:
    scans, truth = moving_scans(CORRIDOR, 12, twist=TWIST, doubt=DOUBT)
    found = course(scans, truth)
    deviations = np.sqrt(np.diagonal(found.covariances, axis1=1, axis2=2))
    assert (np.diff(deviations[1:, 0]) > -0.05).all()
    assert deviations[-1, 0] > 1.0
    assert deviations[1:, 1].max() < 0.1
    assert (np.abs(found.errors[1:]) < 3.0 * deviations[1:]).all()


def test_hardly_a_match_of_bare_walls_tells_the_way_along_them() -> None:
    """One in a hundred may: each that does ends what the others have left open."""
    told = []
    for part in (1.0, -1.05, 1.1, -1.15, 1.2, -1.25):
        scans, _ = moving_scans(CORRIDOR, 14, twist=part * TWIST, doubt=DOUBT)
        slam = GraphSlam(Configuration(), ESTIMATORS["full"])
        matches = [edge for scan in scans for edge in slam.add_scan(scan)]
        told += [edge.covariance[0, 0] < 9.0 for edge in matches if "overlap" in edge.figures]
    assert len(told) > 200
    assert np.mean(told) < 0.02
