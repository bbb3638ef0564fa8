# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Points of one bent scan on the lines of another, linearised by the keyframes of both."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.bent_scan import BentScan
from msss_graphslam.core.compounding import between
from msss_graphslam.core.point_to_line import CAUCHY, SAME_SIDE
from msss_graphslam.core.types import Array

__all__ = ["Pairing", "pairing"]

FEWEST = 3
"""Pairs of points and lines that say something of a displacement."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """What the points say of the four keyframes: first the points' two, then the lines' two.

    ``information`` (12, 12), ``gradient`` (12,) of half the sum of squares.
    """

    information: Array
    gradient: Array


def pairing(moving: BentScan, lines: BentScan, reach: float) -> Pairing | None:
    """Pair the points of ``moving`` with lines at most ``reach`` [m] away; None without enough."""
    if moving.lines is None or lines.lines is None:
        return None
    flat = np.flatnonzero(moving.lines.flat)
    points = moving.points[flat]
    seen = between(lines.start, np.column_stack([points, np.zeros(len(points))]))[:, :2]
    found = lines.lines.tree.query(seen)
    distances, nearest = np.asarray(found[0]), np.asarray(found[1])
    normals = lines.normals[nearest]
    offsets = points - lines.centres[nearest]
    residuals = _dot(normals, offsets)
    along = _dot(offsets, offsets) - residuals**2
    paired = np.flatnonzero(
        (distances < reach)
        & lines.lines.flat[nearest]
        & (_dot(normals, moving.normals[flat]) > SAME_SIDE)
        & (along < (2.0 * lines.lines.reach[nearest]) ** 2)
    )
    if len(paired) < FEWEST:
        return None
    at, on = flat[paired], nearest[paired]
    normals, points = normals[paired], points[paired]
    spread = np.einsum("ni,nij,nj->n", normals, moving.covariances[at], normals)
    deviations = np.sqrt(spread + lines.lines.variances[on])
    jacobian = np.empty((len(points), 12))
    jacobian[:, :6] = _by_keyframes(moving, moving.beam_index[at], normals, points)
    # A line that turns about its beam moves under the point as the point would, the other way.
    jacobian[:, 6:] = -_by_keyframes(lines, lines.beam_index[on], normals, points)
    return _weighed(residuals[paired] / deviations, jacobian / deviations[:, None])


def _by_keyframes(scan: BentScan, beams: NDArray[np.intp], normals: Array, points: Array) -> Array:
    """Return how far (n, 6) points that hang on beams move along normals with the keyframes."""
    levers = points - scan.beams[beams]
    across = normals[:, 1] * levers[:, 0] - normals[:, 0] * levers[:, 1]
    by_pose = np.column_stack([normals, across])
    return np.asarray(np.einsum("ni,nij->nj", by_pose, scan.by_keyframes[beams]))


def _weighed(normalised: Array, jacobian: Array) -> Pairing:
    """Robust weights; residuals larger than their deviations say widen all of them."""
    scale = 1.4826 * float(np.median(np.abs(normalised)))
    weights = 1.0 / (1.0 + (normalised / (CAUCHY * max(scale, 0.1))) ** 2)
    weighted = jacobian.T * (weights / max(scale, 1.0) ** 2)
    return Pairing(weighted @ jacobian, weighted @ normalised)


def _dot(first: Array, second: Array) -> Array:
    return np.asarray(np.einsum("ni,ni->n", first, second))
