# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scan matchers of several makers behind one interface."""

from typing import Any, Protocol

import numpy as np
import small_gicp
from scipy.spatial import cKDTree

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import rotation, transform_points
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.types import Array, Scan

__all__ = ["Aligner", "Gicp", "Ours", "PlainIcp"]

NARROW = 0.5
"""How far apart a rival's pairs may lie at the end [m]: what ours has as pairing distance."""

ITERATIONS = 40
"""Most iterations of a rival, each time."""


class Aligner(Protocol):
    """Prepares a scan once, then aligns it with others."""

    def prepare(self, scan: Scan) -> Any:
        """Return what ``align`` needs of a scan."""

    def align(self, reference: Any, current: Any, initial: Array, spread: Array) -> Array:
        """Return the displacement (3,) from a first guess and the guess's covariance (3, 3)."""


class Ours:
    """A matcher of this package; a refused match still says where it ended."""

    def __init__(self, matcher: ScanMatcher) -> None:
        self._matcher = matcher

    def prepare(self, scan: Scan) -> Any:
        """Prepare the scan for the matcher."""
        return self._matcher.prepare(scan)

    def align(self, reference: Any, current: Any, initial: Array, spread: Array) -> Array:
        """Match the prepared scans."""
        return self._matcher.match(reference, current, initial, spread).relative_pose


class PlainIcp:
    """Point-to-point ICP as a textbook has it: nearest neighbours, then a rigid fit."""

    def prepare(self, scan: Scan) -> tuple[Array, cKDTree]:
        """Return the points and their tree."""
        return scan.points, cKDTree(scan.points)

    def align(
        self,
        reference: tuple[Array, cKDTree],
        current: tuple[Array, cKDTree],
        initial: Array,
        spread: Array,
    ) -> Array:
        """Align with wide, then with narrow pairs."""
        pose = initial
        for gate in _gates(spread):
            for _ in range(ITERATIONS):
                before = pose
                pose = self._iterate(reference, current[0], pose, gate)
                if np.abs(pose - before).max() < Matching().smallest_turn:
                    break
        return pose

    @staticmethod
    def _iterate(
        reference: tuple[Array, cKDTree], points: Array, pose: Array, gate: float
    ) -> Array:
        places, tree = reference
        distances, nearest = tree.query(transform_points(pose, points))
        paired = np.asarray(distances) < gate
        if paired.sum() < 3:
            return pose
        return _rigid_fit(points[paired], places[np.asarray(nearest)[paired]])


class Gicp:
    """The library small_gicp: ``kind`` is GICP, PLANE_ICP or ICP.

    Its points have three dimensions, and a surface patch is fitted to neighbours: a flat scan is
    stacked in layers as far apart as its points are, so that the patches stand upright.
    """

    def __init__(self, kind: str) -> None:
        self._kind = kind

    def prepare(self, scan: Scan) -> tuple[Any, Any]:
        """Return the library's points and tree, not thinned."""
        distances, _ = cKDTree(scan.points).query(scan.points, k=[2])
        layer = float(np.median(np.asarray(distances)))
        heights = np.repeat([-layer, 0.0, layer], len(scan.points))
        solid = np.column_stack([np.tile(scan.points, (3, 1)), heights])
        cloud = small_gicp.PointCloud(solid)
        tree = small_gicp.KdTree(cloud)
        small_gicp.estimate_normals_covariances(cloud, tree, num_neighbors=20)
        return cloud, tree

    def align(
        self, reference: tuple[Any, Any], current: tuple[Any, Any], initial: Array, spread: Array
    ) -> Array:
        """Align with wide, then with narrow pairs."""
        transform = np.eye(4)
        transform[:2, :2] = rotation(initial[2])
        transform[:2, 3] = initial[:2]
        for gate in _gates(spread):
            transform = small_gicp.align(
                reference[0],
                current[0],
                reference[1],
                init_T_target_source=transform,
                registration_type=self._kind,
                max_correspondence_distance=gate,
                max_iterations=ITERATIONS,
            ).T_target_source
        return np.array([*transform[:2, 3], np.arctan2(transform[1, 0], transform[0, 0])])


def _gates(spread: Array) -> tuple[float, float]:
    """Return how far apart pairs may lie at first and at last [m]."""
    return max(NARROW, 3.0 * float(np.sqrt(spread[0, 0]))), NARROW


def _rigid_fit(points: Array, places: Array) -> Array:
    """Return the pose (3,) that brings ``points`` nearest to ``places`` (n, 2)."""
    first, second = points - points.mean(axis=0), places - places.mean(axis=0)
    sine = np.sum(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    yaw = float(np.arctan2(sine, np.sum(first * second)))
    return np.array([*(places.mean(axis=0) - rotation(yaw) @ points.mean(axis=0)), yaw])
