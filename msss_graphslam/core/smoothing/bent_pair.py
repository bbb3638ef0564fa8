# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Points of bent scans on the lines of another, linearised by displacement and twist errors."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.paired_lines import SAME_SIDE
from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors, vectors
from msss_graphslam.core.matching.robust_weights import cauchy_weights, robust_size
from msss_graphslam.core.smoothing.bent_scan import BentScan, Hanging
from msss_graphslam.core.types import Array

__all__ = ["Pairing", "pairings"]

FEWEST = 3
"""Pairs of points and lines that say something of a displacement."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """What the points say of nine numbers: ``information`` (9, 9), ``gradient`` (9,).

    Of half the sum of squares, by the displacement of the points' scan in the lines' one, the
    twist error of the points' scan, and that of the lines' one.
    """

    information: Array
    gradient: Array


def pairings(
    moving: Sequence[BentScan], displacements: Array, lines: BentScan, reach: float
) -> list[Pairing | None]:
    """Pair the points of k scans with lines at most ``reach`` [m] away; None without enough.

    ``displacements`` (k, 3) are the scans' poses in the frame of ``lines``.
    """
    counts = [len(scan.points) for scan in moving]
    if lines.lines is None or sum(counts) == 0:
        return [None] * len(moving)
    number = np.repeat(np.arange(len(moving)), counts)
    points = _points(moving, displacements[number])
    paired, nearest = _paired(points, lines.lines, reach)
    residuals, jacobian = _linearised(
        points.at(paired), lines.lines, nearest, lines.lines_hanging.at(nearest)
    )
    ends = np.searchsorted(number[paired], np.arange(len(moving) + 1))
    return [
        _weighed(residuals[start:stop], jacobian[start:stop]) if stop - start >= FEWEST else None
        for start, stop in pairwise(ends)
    ]


@dataclass(frozen=True, slots=True)
class _Points:
    """Points in their own scans' frames, and the ``turns`` and ``shifts`` into the lines'."""

    places: Vectors
    normals: Vectors
    covariances: Array
    hanging: Hanging
    turns: Vectors
    shifts: Vectors

    def at(self, chosen: Numbers) -> "_Points":
        return _Points(
            self.places[chosen],
            self.normals[chosen],
            self.covariances[chosen],
            self.hanging.at(chosen),
            self.turns[chosen],
            self.shifts[chosen],
        )


def _points(scans: Sequence[BentScan], displacements: Array) -> _Points:
    return _Points(
        np.concatenate([scan.points for scan in scans]),
        np.concatenate([scan.normals for scan in scans]),
        np.concatenate([scan.covariances for scan in scans]),
        Hanging.together([scan.points_hanging for scan in scans]),
        np.exp(1j * displacements[:, 2]),
        vectors(displacements),
    )


def _paired(points: _Points, lines: LineFeatures, reach: float) -> tuple[Numbers, Numbers]:
    """Return which points lie on which lines."""
    # A back end pairs nothing until the end.
    from msss_graphslam.core.matching.loops import nearest_of_each

    seen, there = points.turns * points.places + points.shifts, lines.as_lines
    found = nearest_of_each(there.places, seen, reach)
    near = np.flatnonzero(found >= 0)
    nearest = found[near]
    across = there.across[nearest]
    offsets = across * (seen[near] - there.centres[nearest])
    alike = np.real(across * points.turns[near] * points.normals[near]) > SAME_SIDE
    on = alike & (np.abs(offsets.imag) < there.supported[nearest])
    return near[on], lines.order[nearest[on]]


def _linearised(
    points: _Points, lines: LineFeatures, on: Numbers, hanging: Hanging
) -> tuple[Array, Array]:
    """Return the residuals (n,) and their derivatives (n, 9), over the standard deviations.

    ``hanging`` says how the lines move that the points are ``on``.
    """
    normals = vectors(lines.normals[on])
    levers = points.turns * points.places
    seen = levers + points.shifts
    own_normals = np.conj(points.turns) * normals
    deviations = np.sqrt(_spread(points.covariances, own_normals) + lines.variances[on])
    residuals = np.real(np.conj(normals) * (seen - vectors(lines.centres[on])))
    jacobian = np.empty((len(on), 9))
    jacobian[:, 0], jacobian[:, 1] = normals.real, normals.imag
    jacobian[:, 2] = np.real(np.conj(normals) * 1j * levers)
    jacobian[:, 3:6] = points.hanging.along(own_normals, points.places)
    # A line that turns about its beam moves under the point as the point would, the other way.
    jacobian[:, 6:] = -hanging.along(normals, seen)
    return residuals / deviations, jacobian / deviations[:, None]


def _spread(covariances: Array, normals: Vectors) -> Array:
    """Return the variances (n,) along normals."""
    x, y = normals.real, normals.imag
    mixed = covariances[:, 0, 1] + covariances[:, 1, 0]
    return covariances[:, 0, 0] * x**2 + mixed * x * y + covariances[:, 1, 1] * y**2


def _weighed(normalised: Array, jacobian: Array) -> Pairing:
    """Robust weights; residuals larger than their deviations say widen all of them."""
    scale = robust_size(normalised)
    weighted = jacobian.T * (cauchy_weights(normalised, scale) / max(scale, 1.0) ** 2)
    return Pairing(weighted @ jacobian, weighted @ normalised)
