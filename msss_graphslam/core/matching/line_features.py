# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Local lines through a scan's points: what point-to-line matching aligns with."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = ["LineFeatures", "Vectors", "line_features", "vectors"]

Vectors = NDArray[np.complex128]
"""Plane vectors (n,) as x + i y: the real part of conj(a) b is the dot product."""

NEIGHBOURS = 7
"""Points of a local line, itself included: enough to average, few enough to follow a bend."""

FLATNESS = 0.15
"""Largest ratio of a local line's thickness to its length (standard deviations)."""


def vectors(rows: Array) -> Vectors:
    """Return the first two columns of ``rows`` (n, 2 or more)."""
    return np.asarray(rows[:, 0] + 1j * rows[:, 1])


@dataclass(frozen=True, slots=True)
class Lines:
    """The n lines of a scan, and behind them a place that stands for no line.

    ``across`` (n + 1,) are the conjugated normals, without length where there is no line;
    ``supported`` (n + 1,) [m] is how far along a line a point may lie.
    """

    centres: Vectors
    across: Vectors
    supported: Array
    variances: Array
    slips: Array


@dataclass(frozen=True, slots=True)
class FlatPoints:
    """The k points of a scan that lie on a line.

    A covariance is ``mean`` [m^2], half its trace, and a ``deviator`` that turns with twice the
    angle.
    """

    places: Vectors
    normals: Vectors
    mean: Array
    deviator: Vectors
    slips: Array


@dataclass(frozen=True)
class LineFeatures:
    """The local line at each point of a scan.

    ``points`` (n, 2) and their ``covariances`` (n, 2, 2); the lines' ``centres`` (n, 2), their
    ``normals`` (n, 2) towards the sensor, ``variances`` (n,) [m^2] of a point along the normal,
    ``reach`` (n,) [m] how far a line is supported, ``flat`` (n,) whether there is a line at all;
    ``tree`` finds the nearest point. ``slips`` (n, 2, 3) [m] is how the points move together for
    a unit of the error of the scan's motion, see ``point_slips``.
    """

    points: Array
    covariances: Array
    centres: Array
    normals: Array
    variances: Array
    reach: Array
    flat: np.ndarray
    tree: "cKDTree"
    slips: Array

    @cached_property
    def as_lines(self) -> Lines:
        """The lines, for a match."""
        return Lines(
            centres=np.append(vectors(self.centres), 0.0),
            # A normal of no length is like none other.
            across=np.append(np.where(self.flat, np.conj(vectors(self.normals)), 0.0), 0.0),
            supported=np.append(2.0 * self.reach, 0.0),
            variances=np.append(self.variances, 0.0),
            slips=np.concatenate([self.slips, np.zeros((1, 2, 3))]),
        )

    @cached_property
    def as_points(self) -> FlatPoints:
        """The points that lie on a line, for a match."""
        covariances = self.covariances[self.flat]
        xx, yy = covariances[:, 0, 0], covariances[:, 1, 1]
        return FlatPoints(
            places=vectors(self.points[self.flat]),
            normals=vectors(self.normals[self.flat]),
            mean=0.5 * (xx + yy),
            deviator=0.5 * (xx - yy) + 1j * covariances[:, 0, 1],
            slips=self.slips[self.flat],
        )


def line_features(
    points: Array, covariances: Array, slips: Array | None = None
) -> LineFeatures | None:
    """Fit a line through each point's neighbours; None with fewer than NEIGHBOURS points.

    ``points`` (n, 2) [m] and ``covariances`` (n, 2, 2) [m^2] are those of a scan. The number of
    neighbours, not a radius, sets the scale: far points lie farther apart. Without ``slips``
    (n, 2, 3) the motion has no error that points share.
    """
    if len(points) < NEIGHBOURS:
        return None
    # It holds 35 MiB, and a back end matches nothing until the end.
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    found = tree.query(points, k=NEIGHBOURS)
    distances, neighbours = np.asarray(found[0]), np.asarray(found[1])
    local = points[neighbours]
    centres = local.mean(axis=1)
    normals, thickness, length = _axes(local - centres[:, None])
    normals = np.where(np.sum(normals * centres, axis=1)[:, None] > 0.0, -normals, normals)
    measured = np.einsum("ni,nij,nj->n", normals, covariances, normals)
    return LineFeatures(
        points=points,
        covariances=covariances,
        centres=centres,
        normals=normals,
        variances=np.maximum(measured, thickness**2),
        reach=distances[:, -1],
        flat=(thickness < FLATNESS * length) & _supported(distances),
        tree=tree,
        slips=np.zeros((len(points), 2, 3)) if slips is None else slips,
    )


def _axes(spread: Array) -> tuple[Array, Array, Array]:
    """Return the normals (n, 2) of the lines through points (n, k, 2) around the origin.

    With the standard deviations (n,) along the normals and along the lines.
    """
    x, y = spread[..., 0], spread[..., 1]
    sums = np.stack([x * x, y * y, x * y]).mean(axis=-1)
    middle, half, mixed = 0.5 * (sums[0] + sums[1]), 0.5 * (sums[0] - sums[1]), sums[2]
    angle = 0.5 * np.arctan2(mixed, half)
    radius = np.hypot(half, mixed)
    thickness, length = np.sqrt(np.maximum([middle - radius, middle + radius], 0.0))
    return np.column_stack([-np.sin(angle), np.cos(angle)]), thickness, length


def _supported(distances: Array) -> np.ndarray:
    """Whether the neighbours are no farther than the spacing of the scan's points lets expect."""
    spacing = np.median(distances[:, 1])
    return np.asarray(distances[:, -1] < 8.0 * NEIGHBOURS * spacing)
