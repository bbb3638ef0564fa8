# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Local lines through a scan's points: what point-to-line matching aligns with."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors, vectors
from msss_graphslam.core.types import Array

__all__ = ["NEIGHBOURS", "FlatPoints", "LineFeatures", "Lines", "line_features"]

NEIGHBOURS = 7
"""Points of a local line, itself included: enough to average, few enough to follow a bend."""

FLATNESS = 0.15
"""Largest ratio of a local line's thickness to its length (standard deviations)."""


class Lines(NamedTuple):
    """The n lines of a scan, by ascending x of the points, ``places``, that they belong to.

    ``across`` (n,) are the conjugated normals, without length where there is no line;
    ``supported`` (n,) [m] is how far along a line a point may lie.
    """

    places: Vectors
    centres: Vectors
    across: Vectors
    supported: Array
    variances: Array


class FlatPoints(NamedTuple):
    """The k points of a scan that lie on a line.

    A covariance is ``mean`` [m^2], half its trace, and a ``deviator`` that turns with twice the
    angle.
    """

    places: Vectors
    normals: Vectors
    mean: Array
    deviator: Vectors


@dataclass(frozen=True)
class LineFeatures:
    """The local line at each point of a scan.

    ``points`` (n, 2) and their ``covariances`` (n, 2, 2); the lines' ``centres`` (n, 2), their
    ``normals`` (n, 2) towards the sensor, ``variances`` (n,) [m^2] of a point along the normal,
    ``reach`` (n,) [m] how far a line is supported, ``flat`` (n,) whether there is a line at all;
    ``slips`` (n, 2, 3) [m] is how the points move together for a unit of the error of the scan's
    motion, see ``point_slips``. ``order`` (n,) puts the points by ascending x.
    """

    points: Array
    covariances: Array
    centres: Array
    normals: Array
    variances: Array
    reach: Array
    flat: np.ndarray
    slips: Array
    order: Numbers

    @cached_property
    def as_lines(self) -> Lines:
        """The lines, for a match."""
        order, normals = self.order, vectors(self.normals)
        return Lines(
            places=vectors(self.points)[order],
            centres=vectors(self.centres)[order],
            # A normal of no length is like none other.
            across=np.where(self.flat, np.conj(normals), 0.0)[order],
            supported=2.0 * self.reach[order],
            variances=self.variances[order],
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
    # A back end matches nothing until the end.
    from msss_graphslam.core.matching.loops import local_lines

    order = np.argsort(points[:, 0], kind="stable")
    table = np.empty((8, len(points)))
    table[:, order] = local_lines(vectors(points)[order], NEIGHBOURS)
    centres, normals = table[:2].T, table[2:4].T
    thickness, length, spacing, reach = table[4:]
    measured = np.einsum("ni,nij,nj->n", normals, covariances, normals)
    return LineFeatures(
        points=points,
        covariances=covariances,
        centres=centres,
        normals=normals,
        variances=np.maximum(measured, thickness**2),
        reach=reach,
        flat=(thickness < FLATNESS * length) & _supported(spacing, reach),
        slips=np.broadcast_to(0.0, (len(points), 2, 3)) if slips is None else slips,
        order=order,
    )


def _supported(spacing: Array, reach: Array) -> np.ndarray:
    """Whether the neighbours are no farther than the spacing of the scan's points lets expect."""
    return np.asarray(reach < 8.0 * NEIGHBOURS * np.median(spacing))
