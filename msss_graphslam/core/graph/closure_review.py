# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which loop closures still agree with the graph that has grown since they were found."""

# Deviation: the paper keeps what it has once accepted. A closure that the later ones show to be
# wrong is taken out, and put back where later ones show it to be right.

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.graph.layout_slack import LAYOUT
from msss_graphslam.core.types import Array, Constraint

__all__ = ["PATIENCE", "ClosureReview", "Verdict"]

PATIENCE = 3
"""So many updates in a row a closure must disagree to be withdrawn, or agree to come back."""

NEARING = 0.9
"""While the graph comes nearer to a closure by this factor of the squared distance or more from
update to update, it is being convinced: where a loop closes at last, the first closures pull the
graph over only bit by bit."""

FIRST_ROOM = 64
"""For so many closures at first."""


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
        self._count = 0
        self._kept = _Closures.empty(FIRST_ROOM)
        self._poses = np.empty((0, 3))

    def add(self, edges: Sequence[Constraint], slack: Array = LAYOUT) -> None:
        """Take note of closures that the graph has taken; ``slack`` (3, 3) is allowed beside."""
        if not edges:
            return
        first, self._count = self._count, self._count + len(edges)
        while self._count > len(self._kept.ends):
            self._kept = self._kept.doubled()
        new = self._kept.part(first, self._count)
        spreads = np.array([edge.covariance for edge in edges]) + slack
        new.ends[:] = [(edge.first, edge.second) for edge in edges]
        new.relative[:] = [edge.relative_pose for edge in edges]
        new.information[:] = np.linalg.inv(spreads)
        new.inside[:], new.streaks[:], new.distances[:] = True, 0, np.nan

    def judge(self, poses: Array) -> Verdict:
        """Compare all closures with the poses (n, 3) after an update."""
        closures = self._kept.part(0, self._count)
        before = closures.distances.copy()
        self._follow(closures, poses)
        nearing = closures.inside & (closures.distances < NEARING * before)
        changes = ((closures.distances > self._bound) == closures.inside) & ~nearing
        closures.streaks[:] = np.where(changes, closures.streaks + 1, 0)
        due = closures.streaks >= PATIENCE
        withdrawn, readmitted = (
            np.flatnonzero(due & side) for side in (closures.inside, ~closures.inside)
        )
        closures.inside[:] ^= due
        closures.streaks[due] = 0
        return Verdict(tuple(withdrawn.tolist()), tuple(readmitted.tolist()))

    def _follow(self, closures: "_Closures", poses: Array) -> None:
        """Measure again the closures that are new or whose keyframes have moved."""
        moved = np.ones(len(poses), dtype=bool)
        known = min(len(poses), len(self._poses))
        moved[:known] = (poses[:known] != self._poses[:known]).any(axis=1)
        first, second = closures.ends.T
        again = np.flatnonzero(moved[first] | moved[second] | np.isnan(closures.distances))
        closures.distances[again] = _squared_distances(closures, poses, again)
        self._poses = poses.copy()


@dataclass(frozen=True, slots=True)
class _Closures:
    """Closures as rows (n,): kept with room for more, as there is one call for every scan."""

    ends: NDArray[np.intp]
    relative: Array
    information: Array
    inside: NDArray[np.bool_]
    streaks: NDArray[np.intp]
    distances: Array

    @staticmethod
    def empty(count: int) -> "_Closures":
        return _Closures(
            np.empty((count, 2), dtype=np.intp),
            np.empty((count, 3)),
            np.empty((count, 3, 3)),
            np.empty(count, dtype=bool),
            np.empty(count, dtype=np.intp),
            np.empty(count),
        )

    def part(self, start: int, stop: int) -> "_Closures":
        """Return some of the rows, which are these very ones."""
        rows = slice(start, stop)
        return _Closures(*(getattr(self, entry.name)[rows] for entry in fields(self)))

    def doubled(self) -> "_Closures":
        """Return the same with twice the room."""
        larger = _Closures.empty(2 * len(self.ends))
        for entry in fields(self):
            getattr(larger, entry.name)[: len(self.ends)] = getattr(self, entry.name)
        return larger


def _squared_distances(closures: _Closures, poses: Array, chosen: NDArray[np.intp]) -> Array:
    first, second = (poses[ends] for ends in closures.ends[chosen].T)
    away = second - first
    cosine, sine = np.cos(first[:, 2]), np.sin(first[:, 2])
    along = cosine * away[:, 0] + sine * away[:, 1]
    across = cosine * away[:, 1] - sine * away[:, 0]
    off = np.stack([along, across, away[:, 2]], axis=1) - closures.relative[chosen]
    off[:, 2] = wrap(off[:, 2])
    return np.asarray(np.einsum("ni,nij,nj->n", off, closures.information[chosen], off))
