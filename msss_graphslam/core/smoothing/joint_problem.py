# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans on each other's lines and dead reckoning's doubts, as normal equations of keyframes."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import (
    between,
    between_jacobians,
    inverse,
    inverse_jacobian,
)
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing.bent_pair import Pairing, pairings
from msss_graphslam.core.smoothing.bent_scans import BentScans, applied, change_of
from msss_graphslam.core.smoothing.joint_pairs import weights_of
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.smoothing.sonar_calibration import sonar_calibration, velocities_of
from msss_graphslam.core.smoothing.twist_chain import TwistChain
from msss_graphslam.core.types import Array, Scan, SonarCalibration

__all__ = ["SLACK", "JointProblem"]

SLACK = 0.1
"""A linearisation holds until points move farther than this share of their deviation."""

AT_ONCE = 4096
"""Pairs put into the normal equations together: bounds the memory."""

TOGETHER = 512
"""Scans whose pairs with earlier ones are made together: so many and the places are kept bent."""

OTHER_WAY = [0, 1, 2, 6, 7, 8, 3, 4, 5]
"""A pairing's nine numbers when points and lines change places."""

Numbers = NDArray[np.intp]


class JointProblem:
    """All scans and the pairs of them that are to be aligned.

    As in iSAM2 (Kaess et al. 2012) only what has moved is linearised again: a scan whose own shape
    has changed is bent anew, a pair whose shapes or displacement have changed is paired anew.
    ``slack`` is how far that is, in deviations of the points across the line of sight.
    """

    def __init__(
        self,
        scans: Sequence[Scan],
        pairs: Sequence[tuple[int, int]],
        persistence: Persistence,
        slack: float = SLACK,
    ) -> None:
        self._scans = BentScans(scans, slack)
        self._chain = TwistChain(scans, persistence)
        self._pairs = np.asarray(pairs, dtype=np.intp).reshape(-1, 2)
        # Every pair both ways: the first scan's points on the second one's lines, then the others.
        self._moving, self._lines = np.vstack([self._pairs, self._pairs[:, ::-1]]).T
        self._parts = np.tile(self._pairs.max(axis=1) // TOGETHER, 2)
        self._weights = weights_of(self._pairs, len(scans))
        self._pair_nothing()

    def linearised(self, states: Array, reach: float) -> NormalEquations:
        """Return the normal equations at the states (n + 1, 3)."""
        bent = self._scans.follow(states)
        displacements = between(states[self._pairs[:, 1]], states[self._pairs[:, 0]])
        self._pair_moved(displacements, bent, reach)
        equations = NormalEquations(len(states))
        twists, by_keyframes = self.twists(states)
        self._chain.add_to(equations, twists, by_keyframes)
        for start in range(0, len(self._pairs), AT_ONCE):
            chosen = slice(start, start + AT_ONCE)
            self._add_pairs(chosen, equations, states, twists, by_keyframes)
        return equations

    def twists(self, states: Array) -> tuple[Array, Array]:
        """Return the twist errors (n, 3) of all scans, and their derivatives (n, 3, 6).

        By the scan's own and the next keyframe.
        """
        return self._scans.twists_at(states)

    def sonar_calibration(
        self, equations: NormalEquations, states: Array
    ) -> SonarCalibration | None:
        """Return by what the sonar's motion differs from dead reckoning's, if that is observable.

        ``equations`` are those of the solution, the states (n + 1, 3).
        """
        velocities = velocities_of(states, self._chain.durations)
        return sonar_calibration(self._chain, equations, *self.twists(states), velocities)

    def forget(self) -> None:
        """Let go of what can be had again, for what comes after needs the memory."""
        self._scans.forget()
        self._pair_nothing()

    def _pair_nothing(self) -> None:
        count = len(self._pairs)
        self._reach = np.nan
        self._displacements = np.full((count, 3), np.nan)
        self._information, self._gradient = np.zeros((count, 9, 9)), np.zeros((count, 9))

    def _pair_moved(self, displacements: Array, bent: NDArray[np.bool_], reach: float) -> None:
        """Pair anew the pairs of scans that were bent or whose displacement has moved."""
        change = change_of(displacements, self._displacements)
        moved = self._scans.moved(change, *self._pairs.T)
        again = moved | bent[self._pairs].any(axis=1) | (reach != self._reach)
        self._reach = reach
        self._displacements[again] = displacements[again]
        self._information[again], self._gradient[again] = 0.0, 0.0
        for _, part in _grouped(self._parts, np.flatnonzero(np.tile(again, 2))):
            for lines, ways in _grouped(self._lines, part):
                self._pair_with(lines, ways, reach)

    def _pair_with(self, lines: int, ways: Numbers, reach: float) -> None:
        """Take in what the points of several scans say on the lines of one."""
        numbers = ways % len(self._pairs)
        displacements = self._displacements[numbers]
        other_way = ways >= len(self._pairs)
        displacements[other_way] = inverse(displacements[other_way])
        points = [self._scans.at(scan) for scan in self._moving[ways].tolist()]
        found = pairings(points, displacements, self._scans.at(lines), reach)
        for number, turned, pairing in zip(numbers, other_way, found, strict=True):
            if pairing is not None:
                self._take(number, self._turned(number, pairing) if turned else pairing)

    def _turned(self, number: int, found: Pairing) -> Pairing:
        """Return what the second scan's points say as if the first one's did."""
        by_first = np.eye(9)
        by_first[:3, :3] = inverse_jacobian(self._displacements[number])
        by_first = by_first[OTHER_WAY]
        return Pairing(by_first.T @ found.information @ by_first, by_first.T @ found.gradient)

    def _take(self, number: int, found: Pairing) -> None:
        # Both ways make one measurement.
        self._information[number] += 0.5 * self._weights[number] * found.information
        self._gradient[number] += 0.5 * self._weights[number] * found.gradient

    def _add_pairs(
        self,
        chosen: slice,
        equations: NormalEquations,
        states: Array,
        twists: Array,
        by_keyframes: Array,
    ) -> None:
        first, second = self._pairs[chosen].T
        change = np.zeros((len(first), 9))
        change[:, :3] = change_of(
            between(states[second], states[first]), self._displacements[chosen]
        )
        change[:, 3:] = (twists - self._scans.twists)[self._pairs[chosen]].reshape(-1, 6)
        jacobian = np.zeros((len(first), 9, 12))
        by_second, by_first = between_jacobians(states[second], states[first])
        jacobian[:, :3, :3], jacobian[:, :3, 6:9] = by_first, by_second
        jacobian[:, 3:6, :6] = by_keyframes[first]
        jacobian[:, 6:, 6:] = by_keyframes[second]
        turned = np.swapaxes(jacobian, 1, 2)
        information = self._information[chosen]
        gradient = self._gradient[chosen] + applied(information, change)
        nodes = np.column_stack([first, first + 1, second, second + 1])
        equations.add(nodes, turned @ information @ jacobian, applied(turned, gradient))


def _grouped(keys: Numbers, numbers: Numbers) -> Iterator[tuple[int, Numbers]]:
    """Yield the numbers that have the same key, by key."""
    numbers = numbers[np.argsort(keys[numbers], kind="stable")]
    found, starts = np.unique(keys[numbers], return_index=True)
    for key, group in zip(found, np.split(numbers, starts[1:]), strict=False):
        yield int(key), group
