# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two scans put behind each other, so that one call serves both ways of aligning them.

Plane vectors are complex numbers x + i y: the real part of conj(a) b is the dot product.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.types import Array

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = ["Numbers", "StackedLines", "StackedPoints", "Vectors", "along", "vectors"]

Numbers = NDArray[np.intp]
Vectors = NDArray[np.complex128]


def vectors(rows: Array) -> Vectors:
    """Return the first two columns of ``rows`` (n, 2 or more)."""
    return np.asarray(rows[:, 0] + 1j * rows[:, 1])


def along(across: Vectors, moves: Array) -> Array:
    """Return the parts (n, 3) of moves (n, 2, 3) along normals; ``across`` is their conjugate."""
    return across.real[:, None] * moves[:, 0] - across.imag[:, None] * moves[:, 1]


@dataclass(frozen=True, slots=True)
class StackedLines:
    """The lines of two scans, behind each scan's a place that stands for no line.

    ``across`` are the conjugated normals, without length where there is no line; ``supported``
    [m] is how far along a line a point may lie, ``second`` where the second scan's begin.
    """

    trees: "Sequence[cKDTree]"
    centres: Vectors
    across: Vectors
    supported: Array
    variances: Array
    slips: Array
    second: int

    @staticmethod
    def of(*scans: LineFeatures) -> "StackedLines":
        """Put the lines of two scans behind each other."""
        return StackedLines(
            trees=[scan.tree for scan in scans],
            centres=vectors(_padded([scan.centres for scan in scans])),
            # A normal of no length is like none other.
            across=np.conj(
                vectors(_padded([scan.normals * scan.flat[:, None] for scan in scans]))
            ),
            supported=2.0 * _padded([scan.reach for scan in scans]),
            variances=_padded([scan.variances for scan in scans]),
            slips=_padded([scan.slips for scan in scans]),
            second=len(scans[0].points) + 1,
        )

    def nearest(self, places: Vectors, second: int, gates: Array) -> Numbers:
        """Return the numbers of the lines whose points are nearest to places, or of no line.

        The places from ``second`` on belong to the second scan's lines; ``gates`` (2,) [m] are
        how far each may be.
        """
        rows = places.view(np.float64).reshape(-1, 2)
        first = self.trees[0].query(rows[:second], distance_upper_bound=gates[0])[1]
        others = self.trees[1].query(rows[second:], distance_upper_bound=gates[1])[1]
        return np.concatenate([first, others + self.second])


@dataclass(frozen=True, slots=True)
class StackedPoints:
    """The points of two scans that lie on a line; ``way`` (n,) is 0 for the first scan's, then 1.

    A covariance is ``mean`` [m^2], half its trace, and a ``deviator`` that turns with twice the
    angle. ``second`` is where the second scan's begin, ``counts`` (2,) how many each has.
    """

    places: Vectors
    normals: Vectors
    mean: Array
    deviator: Vectors
    slips: Array
    way: Numbers
    second: int
    counts: Numbers

    @staticmethod
    def of(*scans: LineFeatures) -> "StackedPoints":
        """Put the points of two scans behind each other."""
        flat = np.concatenate([scan.flat for scan in scans])
        covariances = _together(scans, lambda scan: scan.covariances)[flat]
        xx, yy = covariances[:, 0, 0], covariances[:, 1, 1]
        counts = np.array([np.count_nonzero(scan.flat) for scan in scans])
        return StackedPoints(
            places=vectors(_together(scans, lambda scan: scan.points)[flat]),
            normals=vectors(_together(scans, lambda scan: scan.normals)[flat]),
            mean=0.5 * (xx + yy),
            deviator=0.5 * (xx - yy) + 1j * covariances[:, 0, 1],
            slips=_together(scans, lambda scan: scan.slips)[flat],
            way=np.repeat([0, 1], counts),
            second=int(counts[0]),
            counts=counts,
        )

    def variances(self, chosen: Numbers, across: Vectors) -> Array:
        """Return the variances (k,) of chosen points along normals, given conjugated."""
        return self.mean[chosen] + np.real(self.deviator[chosen] * across**2)


def _together(scans: Sequence[LineFeatures], part: Callable[[LineFeatures], Array]) -> Array:
    return np.concatenate([part(scan) for scan in scans])


def _padded(parts: Sequence[Array]) -> Array:
    """Return one after the other, each with a row of zeros behind it."""
    rows = [(part, np.zeros((1, *part.shape[1:]))) for part in parts]
    return np.concatenate([part for row in rows for part in row])
