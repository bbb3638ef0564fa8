# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""All scans bent between their keyframes, each again only when its points have moved."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import between, between_jacobians, wrap
from msss_graphslam.core.smoothing.bent_scan import BentScan, bend, reckoned_ends
from msss_graphslam.core.smoothing.twist_chain import durations_of
from msss_graphslam.core.types import Array, Scan

__all__ = ["BentScans", "applied", "change_of"]

KEPT = 768
"""Bent scans at hand; others are bent again when they are needed: bounds the memory."""


class BentScans:
    """The newest linearisation of every scan.

    It holds until a point has moved by ``slack`` times its deviation. ``twists`` (n, 3) are the
    twist errors there.
    """

    def __init__(self, scans: Sequence[Scan], slack: float) -> None:
        self._scans = scans
        self._ends, self._durations = reckoned_ends(scans), durations_of(scans)
        self._extents = np.array([_extent(scan) for scan in scans])
        self._tolerances = slack * np.array([_deviation(scan) for scan in scans])
        # First nothing is bent anywhere.
        self._relatives = np.full((len(scans), 3), np.nan)
        self._by_relative = np.zeros((len(scans), 3, 3))
        self.twists = np.zeros((len(scans), 3))
        self._versions = [0] * len(scans)
        self._version = lru_cache(KEPT)(self._bend)

    def follow(self, states: Array) -> NDArray[np.bool_]:
        """Bend anew what the states (n + 1, 3) have moved; return which scans (n,)."""
        relatives = between(states[:-1], states[1:])
        moved = self.moved(change_of(relatives, self._relatives), np.arange(len(self._scans)))
        self._relatives[moved] = relatives[moved]
        for number in np.flatnonzero(moved).tolist():
            self._versions[number] += 1
            bent = self.at(number)
            self.twists[number], self._by_relative[number] = bent.twist, bent.twist_by_relative
        return moved

    def moved(self, changes: Array, *numbers: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Whether changes (m, 3) of a pose move points of the first scans by more than the slack.

        That of any of the scans ``numbers``, each (m,).
        """
        way = np.hypot(changes[:, 0], changes[:, 1])
        way += self._extents[numbers[0]] * np.abs(changes[:, 2])
        tolerances = np.min([self._tolerances[chosen] for chosen in numbers], axis=0)
        return np.asarray(~(way <= tolerances))

    def at(self, number: int) -> BentScan:
        """Return a scan as it was last bent."""
        return self._version(number, self._versions[number])

    def twists_at(self, states: Array) -> tuple[Array, Array]:
        """Return the twist errors (n, 3) at the states (n + 1, 3) and their derivatives (n, 3, 6).

        By the scan's own and the next keyframe.
        """
        changes = change_of(between(states[:-1], states[1:]), self._relatives)
        twists = self.twists + applied(self._by_relative, changes)
        jacobians = np.concatenate(between_jacobians(states[:-1], states[1:]), axis=2)
        return twists, self._by_relative @ jacobians

    def forget(self) -> None:
        """Let go of the bent scans; they are bent again if they are asked for."""
        self._version.cache_clear()

    def _bend(self, number: int, _: int) -> BentScan:
        relative = self._relatives[number].copy()
        return bend(self._scans[number], self._ends[number], relative, self._durations[number])


def applied(matrices: Array, rows: Array) -> Array:
    """Return each matrix (m, i, j) times its row (m, j)."""
    return np.asarray((matrices @ rows[:, :, None])[:, :, 0])


def change_of(now: Array, before: Array) -> Array:
    """Return the differences (m, 3) of poses."""
    change = now - before
    change[:, 2] = wrap(change[:, 2])
    return np.asarray(change)


def _extent(scan: Scan) -> float:
    """Return the median range [m] of a scan's points."""
    ranges = np.hypot(scan.body_points[:, 0], scan.body_points[:, 1])
    return float(np.median(ranges)) if len(ranges) else 0.0


def _deviation(scan: Scan) -> float:
    """Return the median deviation [m] of a scan's points where they are known best."""
    if len(scan.body_points) == 0:
        return 0.0
    return float(np.sqrt(np.median(np.linalg.eigvalsh(scan.body_covariances)[:, 0])))
