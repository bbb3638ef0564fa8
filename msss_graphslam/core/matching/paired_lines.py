# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Points of one scan on the lines of another, linearised by the displacement and weighed."""

import cmath

import numpy as np

from msss_graphslam.core.matching.line_features import FlatPoints, LineFeatures, Lines
from msss_graphslam.core.matching.match_covariance import MatchedPairs
from msss_graphslam.core.matching.plane_vectors import Numbers, along
from msss_graphslam.core.matching.robust_weights import cauchy_weights, robust_size
from msss_graphslam.core.types import Array

__all__ = ["SAME_SIDE", "PairedLines", "Pose", "Way"]

SAME_SIDE = 0.7
"""Smallest cosine between the normals of a pair: a wall has two sides and a corner two walls."""

Pose = tuple[float, float, float]
"""Displacement [m, m, rad] of the current scan in the reference scan."""


class Way:
    """One way of aligning two scans.

    Forwards the points are the current scan's and the lines the reference scan's, ``backwards``
    the other way round; the displacement is the current scan's both ways.
    """

    def __init__(self, points: LineFeatures, lines: LineFeatures, *, backwards: bool) -> None:
        self.points: FlatPoints = points.as_points
        self.lines: Lines = lines.as_lines
        self.backwards = backwards
        self._from, self._onto = points, lines

    def paired(self, pose: Pose, gate: float) -> "PairedLines":
        """Pair the points with the lines at a displacement, at most ``gate`` [m] apart."""
        return PairedLines(self, pose, gate)

    def slips(self, chosen: Numbers, on: Numbers) -> tuple[Array, Array]:
        """Return those (k, 2, 3) of points and of lines, both by their numbers (k,)."""
        of_points = self._from.slips[np.flatnonzero(self._from.flat)[chosen]]
        return of_points, self._onto.slips[self._onto.order[on]]

    def frame(self, pose: Pose) -> tuple[complex, complex]:
        """Return the turn and the shift that take points into the lines' frame."""
        turn, shift = cmath.exp(1j * pose[2]), complex(pose[0], pose[1])
        if self.backwards:
            return turn.conjugate(), -turn.conjugate() * shift
        return turn, shift


class PairedLines:
    """The pairs of one way at a displacement.

    ``rows`` (4, k) are the derivatives of the normalised residuals by the displacement, and the
    residuals; ``scale`` is their robust size, ``weights`` (k,) are Cauchy's.
    """

    def __init__(self, way: Way, pose: Pose, gate: float) -> None:
        # A back end matches nothing until the end.
        from msss_graphslam.core.matching.loops import paired_points

        self._way, self._frame = way, way.frame(pose)
        rows, self._chosen, self._on = paired_points(
            way.points, way.lines, *self._frame, gate, SAME_SIDE, way.backwards
        )
        self.rows, self._inverse_deviations = rows[:4], rows[4]
        self.scale = robust_size(rows[3])
        self.weights = cauchy_weights(rows[3], self.scale)

    def __len__(self) -> int:
        return len(self._chosen)

    @property
    def overlap(self) -> float:
        """The share of the points that have a pair."""
        return len(self) / max(len(self._way.points.places), 1)

    @property
    def sums(self) -> Array:
        """The normal equations (3, 4): the matrix, and the gradient behind it."""
        return np.asarray((self.rows[:3] * self.weights) @ self.rows.T)

    def matched(self, prior: Array) -> MatchedPairs:
        """Return the pairs with what the covariance asks of them; ``prior`` as there."""
        points, lines, chosen, on = self._way.points, self._way.lines, self._chosen, self._on
        turn, shift = self._frame
        across, turned = lines.across[on], turn * points.places[chosen]
        own = np.conj(turn * points.normals[chosen])
        moved, lever = (-turn * own, -turned - shift) if self._way.backwards else (own, turned)
        twin = np.array([moved.real, -moved.imag, -(own * lever).imag])
        of_points, of_lines = self._way.slips(chosen, on)
        slips = np.hstack([along(turn * across, of_points), -along(across, of_lines)])
        inverse = self._inverse_deviations
        return MatchedPairs(
            jacobian=self.rows[:3].T,
            twin=(twin * inverse).T,
            residuals=self.rows[3],
            weights=self.weights,
            slips=slips * inverse[:, None],
            prior=prior,
        )
