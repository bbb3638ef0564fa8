# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Corresponding points of two scans: compatible, and nearest in Mahalanobis distance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import rotation, transform_points
from msss_graphslam.core.types import Array

__all__ = ["Pairs", "Points", "correspondences"]


@dataclass(frozen=True, slots=True)
class Points:
    """Points (n, 2) [m] and their covariances (n, 2, 2) [m^2]."""

    places: Array
    covariances: Array


@dataclass(frozen=True, slots=True)
class Pairs:
    """Corresponding points at one displacement.

    ``reference`` (k,) indices, ``errors`` (k, 2) reference less current point, ``jacobians``
    (k, 2, 3) of the current points by the displacement, ``weights`` (k, 2, 2) inverse covariances
    of the errors at a known displacement.
    """

    reference: NDArray[np.intp]
    errors: Array
    jacobians: Array
    weights: Array


def correspondences(
    reference: Points, current: Points, pose: Array, pose_covariance: Array, gate: float
) -> Pairs:
    """Pair each current point with the compatible reference point nearest in Mahalanobis distance.

    The distance counts both points' covariances and, through the Jacobian, the displacement's.
    """
    # Deviation: pIC pairs a point with the expectation over all compatible points. Points lie
    # densest where the wall is nearest, a place that moves with the vehicle, so that the
    # expectation drags every scan towards no motion; the nearest point does not.
    turn = rotation(pose[2])
    places = transform_points(pose, current.places)
    covariances = turn @ current.covariances @ turn.T
    jacobians = _jacobians(places - pose[:2])
    uncertain = covariances + jacobians @ pose_covariance @ np.swapaxes(jacobians, 1, 2)
    nearest, distances = _nearest(reference, Points(places, uncertain), gate)
    paired = distances <= gate
    nearest = nearest[paired]
    return Pairs(
        reference=nearest,
        errors=reference.places[nearest] - places[paired],
        jacobians=jacobians[paired],
        weights=np.asarray(np.linalg.inv(reference.covariances[nearest] + covariances[paired])),
    )


def _nearest(reference: Points, current: Points, gate: float) -> tuple[NDArray[np.intp], Array]:
    """Return for each current point the nearest reference point and its squared distance, (n,).

    It is infinite where no reference point can be inside the gate.
    """
    candidates = np.flatnonzero(_may_be_compatible(reference, current, gate))
    row, column = np.divmod(candidates, len(reference.places))
    x, y = (reference.places[column] - current.places[row]).T
    a, b, c = (
        first[row] + second[column]
        for first, second in zip(_entries(current), _entries(reference), strict=True)
    )
    distances = np.full((len(current.places), len(reference.places)), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances[row, column] = (c * x**2 - 2.0 * b * x * y + a * y**2) / (a * c - b**2)
    nearest = distances.argmin(axis=1)
    return nearest, distances[np.arange(len(nearest)), nearest]


def _may_be_compatible(reference: Points, current: Points, gate: float) -> NDArray[np.bool_]:
    """Rule out (current, reference) pairs that lie apart by more than their longest axes.

    That is |r - c|^2 > gate (largest variance of r + of c), which as -2 c.r + f(r) + f(c) > 0 is a
    single matrix product.
    """
    by_current = np.column_stack(
        [-2.0 * current.places, np.ones(len(current.places)), _margins(current, gate)]
    )
    by_reference = np.column_stack(
        [reference.places, _margins(reference, gate), np.ones(len(reference.places))]
    )
    return np.asarray(by_current @ by_reference.T <= 0.0)


def _margins(points: Points, gate: float) -> Array:
    """Return the squared distance from the origin less the gate's longest axis squared, (n,)."""
    xx, xy, yy = _entries(points)
    largest_variance = 0.5 * (xx + yy + np.hypot(xx - yy, 2.0 * xy))
    return np.asarray(np.sum(points.places**2, axis=1) - gate * largest_variance)


def _jacobians(levers: Array) -> Array:
    """Return the derivatives (n, 2, 3) of points by the displacement, from levers (n, 2) [m]."""
    jacobians = np.zeros((len(levers), 2, 3))
    jacobians[:, 0, 0] = jacobians[:, 1, 1] = 1.0
    jacobians[:, 0, 2], jacobians[:, 1, 2] = -levers[:, 1], levers[:, 0]
    return jacobians


def _entries(points: Points) -> tuple[Array, Array, Array]:
    """Return the entries xx, xy and yy (n,) of the covariances."""
    xx, xy, _, yy = np.ascontiguousarray(points.covariances.reshape(-1, 4).T)
    return xx, xy, yy
