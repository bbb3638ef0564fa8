# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A smooth planned path through waypoints, by arc length."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["Path"]

_SAMPLES_PER_METRE = 50


@dataclass(frozen=True, slots=True)
class Path:
    """One lap, closed and smooth.

    ``points`` (n, 2) [m], ``tangents`` (n, 2) of any length there, and the arc length (n,) [m] up
    to each point.
    """

    points: Array
    tangents: Array
    arc_lengths: Array

    @classmethod
    def through(cls, waypoints: Array) -> "Path":
        """Return the closed path through the ``waypoints`` (k, 2) [m], a periodic cubic spline."""
        # The other commands of ``msss`` are spared the time that it takes.
        from scipy.interpolate import CubicSpline

        closed = np.vstack([waypoints, waypoints[:1]])
        chords = np.linalg.norm(np.diff(closed, axis=0), axis=1)
        knots = np.concatenate([[0.0], np.cumsum(chords)])
        spline = CubicSpline(knots, closed, bc_type="periodic")
        dense = np.linspace(0.0, knots[-1], int(knots[-1] * _SAMPLES_PER_METRE))
        points = spline(dense)
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        return cls(points, spline(dense, 1), np.concatenate([[0.0], np.cumsum(steps)]))

    @property
    def lap_length(self) -> float:
        """The length of one lap [m]."""
        return float(self.arc_lengths[-1])

    def at(self, distances: Array) -> tuple[Array, Array]:
        """Return positions (n, 2) and unit normals to port (n, 2) at ``distances`` (n,) [m].

        Distances beyond a lap go round again.
        """
        along = np.mod(distances, self.lap_length)
        positions = self._interpolate(self.points, along)
        tangents = self._interpolate(self.tangents, along)
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        return positions, np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)

    def _interpolate(self, values: Array, along: Array) -> Array:
        columns = [np.interp(along, self.arc_lengths, column) for column in values.T]
        return np.stack(columns, axis=1)
