# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which loop closures still agree with the graph that has grown since they were found."""

# Deviation: the paper keeps what it has once accepted. A closure that the later ones show to be
# wrong is taken out, and put back where later ones show it to be right.

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Constraint

__all__ = ["LAYOUT", "PATIENCE", "ClosureReview", "Verdict"]

LAYOUT = np.diag([0.15**2, 0.15**2, 0.02**2])
"""How far off a match may be for how dead reckoning has bent its scans (3, 3)."""

PATIENCE = 3
"""So many updates in a row a closure must disagree to be withdrawn, or agree to come back."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Numbers of the closures that are to leave the graph, and of those that are to return."""

    withdrawn: tuple[int, ...]
    readmitted: tuple[int, ...]


class ClosureReview:
    """Closures by number, in the order of ``add``; each is part of the graph or not.

    ``bound`` is the largest squared Mahalanobis distance between a closure and the graph.
    """

    def __init__(self, bound: float) -> None:
        self._bound = bound
        self._ends = np.empty((0, 2), dtype=np.intp)
        self._relative = np.empty((0, 3))
        self._information = np.empty((0, 3, 3))
        self._inside = np.empty(0, dtype=bool)
        self._streaks = np.empty(0, dtype=np.intp)
        self._distances = np.empty(0)
        self._poses = np.empty((0, 3))

    def add(self, edges: Sequence[Constraint]) -> None:
        """Take note of closures that the graph has taken."""
        if not edges:
            return
        spreads = np.array([edge.covariance for edge in edges]) + LAYOUT
        ends = np.array([(edge.first, edge.second) for edge in edges], dtype=np.intp)
        self._ends = np.concatenate([self._ends, ends])
        relative = np.array([edge.relative_pose for edge in edges])
        self._relative = np.concatenate([self._relative, relative])
        self._information = np.concatenate([self._information, np.linalg.inv(spreads)])
        self._inside = np.concatenate([self._inside, np.ones(len(edges), dtype=bool)])
        self._streaks = np.concatenate([self._streaks, np.zeros(len(edges), dtype=np.intp)])
        self._distances = np.concatenate([self._distances, np.full(len(edges), np.nan)])

    def judge(self, poses: Array) -> Verdict:
        """Compare all closures with the poses (n, 3) after an update."""
        self._follow(poses)
        changes = (self._distances > self._bound) == self._inside
        self._streaks = np.where(changes, self._streaks + 1, 0)
        due = self._streaks >= PATIENCE
        withdrawn, readmitted = (
            np.flatnonzero(due & side) for side in (self._inside, ~self._inside)
        )
        self._inside ^= due
        self._streaks[due] = 0
        return Verdict(tuple(withdrawn.tolist()), tuple(readmitted.tolist()))

    def _follow(self, poses: Array) -> None:
        """Measure again the closures that are new or whose keyframes have moved."""
        moved = np.ones(len(poses), dtype=bool)
        known = min(len(poses), len(self._poses))
        moved[:known] = (poses[:known] != self._poses[:known]).any(axis=1)
        again = np.flatnonzero(moved[self._ends].any(axis=1) | np.isnan(self._distances))
        self._distances[again] = self._squared_distances(poses, again)
        self._poses = poses.copy()

    def _squared_distances(self, poses: Array, chosen: NDArray[np.intp]) -> Array:
        first, second = (poses[ends] for ends in self._ends[chosen].T)
        away = second - first
        cosine, sine = np.cos(first[:, 2]), np.sin(first[:, 2])
        along = cosine * away[:, 0] + sine * away[:, 1]
        across = cosine * away[:, 1] - sine * away[:, 0]
        off = np.stack([along, across, away[:, 2]], axis=1) - self._relative[chosen]
        off[:, 2] = wrap(off[:, 2])
        return np.asarray(np.einsum("ni,nij,nj->n", off, self._information[chosen], off))
