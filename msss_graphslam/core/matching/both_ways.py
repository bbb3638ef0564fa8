# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two scans put behind each other, so that one call serves both ways of aligning them.

Plane vectors are complex numbers x + i y: the real part of conj(a) b is the dot product.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.matching.line_features import LineFeatures, Vectors, vectors
from msss_graphslam.core.types import Array

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = ["Numbers", "StackedLines", "StackedPoints", "Vectors", "along", "vectors"]

Numbers = NDArray[np.intp]


def along(across: Vectors, moves: Array) -> Array:
    """Return the parts (n, 3) of moves (n, 2, 3) along normals; ``across`` is their conjugate."""
    return across.real[:, None] * moves[:, 0] - across.imag[:, None] * moves[:, 1]


@dataclass(frozen=True, slots=True)
class StackedLines:
    """The lines of two scans, behind each scan's a place that stands for no line.

    ``across`` are the conjugated normals, without length where there is no line; ``supported``
    [m] is how far along a line a point may lie, ``second`` where the second scan's begin.
    """

    trees: "tuple[cKDTree, cKDTree]"
    centres: Vectors
    across: Vectors
    supported: Array
    variances: Array
    slips: Array
    second: int

    @staticmethod
    def of(first: LineFeatures, second: LineFeatures) -> "StackedLines":
        """Put the lines of two scans behind each other."""
        one, other = first.as_lines, second.as_lines
        return StackedLines(
            trees=(first.tree, second.tree),
            centres=np.concatenate([one.centres, other.centres]),
            across=np.concatenate([one.across, other.across]),
            supported=np.concatenate([one.supported, other.supported]),
            variances=np.concatenate([one.variances, other.variances]),
            slips=np.concatenate([one.slips, other.slips]),
            second=len(one.centres),
        )

    def nearest(self, places: Vectors, second: int, gates: tuple[float, float]) -> Numbers:
        """Return the numbers of the lines whose points are nearest to places, or of no line.

        The places from ``second`` on belong to the second scan's lines; ``gates`` [m] are
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
    def of(first: LineFeatures, second: LineFeatures) -> "StackedPoints":
        """Put the points of two scans behind each other."""
        one, other = first.as_points, second.as_points
        counts = np.array([len(one.places), len(other.places)])
        return StackedPoints(
            places=np.concatenate([one.places, other.places]),
            normals=np.concatenate([one.normals, other.normals]),
            mean=np.concatenate([one.mean, other.mean]),
            deviator=np.concatenate([one.deviator, other.deviator]),
            slips=np.concatenate([one.slips, other.slips]),
            way=np.repeat([0, 1], counts),
            second=int(counts[0]),
            counts=counts,
        )

    def variances(self, chosen: Numbers, across: Vectors) -> Array:
        """Return the variances (k,) of chosen points along normals, given conjugated."""
        return self.mean[chosen] + np.real(self.deviator[chosen] * across**2)
