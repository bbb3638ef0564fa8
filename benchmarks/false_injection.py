# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Loop closures that are false, as no gate would let them through."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["FalseClosures", "FalseKind"]

COVARIANCE = np.diag([0.05, 0.05, 0.01]) ** 2
"""Of every false closure [m^2, rad^2]: about what true matches state."""

FAR = (2.0, 5.0, 0.1)
NEAR = (0.3, 1.0, 0.02)
"""How far a false closure is off: least and most [m], and its deviation in heading [rad]."""

LONGEST, SHORTEST = 16, 8
"""Scans of a stretch that is taken for another one."""

NEIGHBOURS = (0, 2, -2, 4)
"""With which scans of the other stretch each of them is closed, counted from its own place."""


class FalseKind(StrEnum):
    """What goes wrong.

    ``anywhere``: two random scans, any displacement. ``shifted``: two random scans, metres off.
    ``alike``: a stretch of scans is taken for another one, all with one and the same error, as in
    a basin of which two parts look alike. ``near``: the same, but less than a metre off.
    """

    ANYWHERE = "anywhere"
    SHIFTED = "shifted"
    ALIKE = "alike"
    NEAR = "near"


@dataclass
class _Stretch:
    first: int
    other: int
    length: int
    error: Array
    left: int


class FalseClosures:
    """False closures to be added to those that the front end has found, scan by scan.

    ``truth`` (n, 3) are the true poses of the keyframes, ``count`` how many there shall be in all.
    ``made`` holds the pairs of scans that were closed.
    """

    def __init__(self, kind: FalseKind, truth: Array, count: int, seed: int) -> None:
        self._kind = kind
        self._truth = truth
        self._random = np.random.default_rng(seed)
        self._extent = 0.5 * float(np.ptp(truth[:, :2], axis=0).max())
        places = self._random.integers(2, len(truth), count)
        self._due = np.bincount(places, minlength=len(truth))
        self._in_stretches = kind in {FalseKind.ALIKE, FalseKind.NEAR}
        self._off = NEAR if kind is FalseKind.NEAR else FAR
        self._stretches = self._planned(count) if self._in_stretches else []
        self.made: set[tuple[int, int]] = set()

    def at(self, keyframe: int) -> list[Constraint]:
        """Return those that end at a keyframe, no two to the same other one."""
        if self._in_stretches:
            found = [edge for one in self._stretches for edge in self._alike(one, keyframe)]
        else:
            found = [self._single(keyframe) for _ in range(int(self._due[keyframe]))]
        unique = {edge.first: edge for edge in found}
        self.made |= {(edge.first, edge.second) for edge in unique.values()}
        return list(unique.values())

    def _single(self, second: int) -> Constraint:
        first = int(self._random.integers(0, second - 1))
        if self._kind is FalseKind.SHIFTED:
            true = between(self._truth[first], self._truth[second])
            return self._closure(first, second, compose(true, self._error()))
        extent = self._extent
        place = self._random.uniform(-extent, extent, 2)
        return self._closure(first, second, np.append(place, self._random.uniform(-np.pi, np.pi)))

    def _planned(self, count: int) -> list[_Stretch]:
        planned: list[_Stretch] = []
        while count > 0:
            length = int(self._random.integers(SHORTEST, LONGEST + 1))
            first = int(self._random.integers(length + 5, len(self._truth) - length))
            other = int(self._random.integers(0, first - length - 4))
            most = min(count, length * len(NEIGHBOURS))
            planned.append(_Stretch(first, other, length, self._error(), most))
            count -= most
        return planned

    def _alike(self, stretch: _Stretch, second: int) -> list[Constraint]:
        since = second - stretch.first
        if not 0 <= since < stretch.length:
            return []
        anchor = self._truth[stretch.first]
        believed = compose(compose(anchor, stretch.error), between(anchor, self._truth[second]))
        others = [stretch.other + since + more for more in NEIGHBOURS]
        others = [first for first in others if 0 <= first < second - 1][: stretch.left]
        stretch.left -= len(others)
        return [
            self._closure(first, second, between(self._truth[first], believed)) for first in others
        ]

    def _error(self) -> Array:
        bearing = self._random.uniform(-np.pi, np.pi)
        least, most, turning = self._off
        distance = self._random.uniform(least, most)
        turn = self._random.normal(0.0, turning)
        return np.array([distance * np.cos(bearing), distance * np.sin(bearing), turn])

    def _closure(self, first: int, second: int, relative: Array) -> Constraint:
        noise = self._random.multivariate_normal(np.zeros(3), COVARIANCE)
        noisy = compose(relative, noise)
        return Constraint(ConstraintKind.LOOP, first, second, noisy, COVARIANCE.copy())
