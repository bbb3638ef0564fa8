# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Points of two scans on each other's lines, linearised by the displacement between them."""

import cmath

import numpy as np

from msss_graphslam.core.matching.both_ways import StackedLines, StackedPoints, along
from msss_graphslam.core.matching.line_features import Vectors
from msss_graphslam.core.types import Array

__all__ = ["SAME_SIDE", "PairedLines", "Pose"]

SAME_SIDE = 0.7
"""Smallest cosine between the normals of a pair: a wall has two sides and a corner two walls."""

Pose = tuple[float, float, float]
"""Displacement [m, m, rad] of the current scan in the reference scan."""


class PairedLines:
    """The pairs of both ways, each at its own displacement of the current scan.

    Forwards the points are the current scan's, backwards the reference scan's, whose points are
    seen from the current one. ``counts`` are the pairs of each way, ``middle`` is where the
    second way's begin. ``rows`` (4, k) are the derivatives of the normalised residuals by the
    displacement, and the residuals.
    """

    def __init__(
        self,
        lines: StackedLines,
        points: StackedPoints,
        poses: tuple[Pose, Pose],
        gates: tuple[float, float],
    ) -> None:
        self._points, self._lines = points, lines
        self._turns, shifts = _frames(poses)
        turns = self._turns[points.way]
        seen = turns * points.places + shifts[points.way]
        on = lines.nearest(seen, points.second, gates)
        across = lines.across[on]
        offsets = across * (seen - lines.centres[on])
        alike = (across * turns * points.normals).real > SAME_SIDE
        self._paired = paired = np.flatnonzero(alike & (abs(offsets.imag) < lines.supported[on]))
        self._on, self._way, self._seen = on[paired], points.way[paired], seen[paired]
        self._across, self._turned = across[paired], turns[paired]
        self.middle = int(paired.searchsorted(points.second))
        self.counts = self.middle, len(paired) - self.middle
        variances = points.variances(paired, self._across * self._turned)
        self._inverse_deviations = 1.0 / np.sqrt(variances + lines.variances[self._on])
        self._levers = self._lever(poses[0])
        self.rows = np.empty((4, len(paired)))
        self.rows[:3] = self._by_displacement(self._across)
        self.rows[3] = offsets.real[paired]
        self.rows *= self._inverse_deviations

    def _lever(self, forward: Pose) -> Vectors:
        """Return what the pairs turn about, with the sign of the way."""
        levers = self._seen.copy()
        levers[: self.middle] -= complex(forward[0], forward[1])
        levers[self.middle :] *= -1.0
        return levers

    def _by_displacement(self, across: Vectors) -> Array:
        """Return the derivatives (3, k) of distances along normals, given conjugated.

        Backwards a step of the displacement moves the points the other way, in a turned frame.
        """
        moved = across.copy()
        moved[self.middle :] *= -self._turns[1]
        return np.array([moved.real, -moved.imag, -(across * self._levers).imag])

    def twin(self) -> Array:
        """Return the first three ``rows`` with the points' own normals instead (3, k)."""
        own = np.conj(self._turned * self._points.normals[self._paired])
        return self._by_displacement(own) * self._inverse_deviations

    def slips(self) -> Array:
        """Return what the residuals change by units of both scans' twist errors (k, 6).

        Those of the points' scan come first.
        """
        moved = along(self._across * self._turned, self._points.slips[self._paired])
        carried = -along(self._across, self._lines.slips[self._on])
        return np.hstack([moved, carried]) * self._inverse_deviations[:, None]


def _frames(poses: tuple[Pose, Pose]) -> tuple[Vectors, Vectors]:
    """Return the turn and the shift of points into the other scan's frame, for both ways."""
    forward, backward = (cmath.exp(1j * pose[2]) for pose in poses)
    back = backward.conjugate()
    shifts = complex(poses[0][0], poses[0][1]), -back * complex(poses[1][0], poses[1][1])
    return np.array([forward, back]), np.array(shifts)
