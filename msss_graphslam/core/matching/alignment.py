# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Robust Gauss-Newton steps of points onto lines, both ways of two scans side by side."""

import math

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.match_covariance import MatchedPairs
from msss_graphslam.core.matching.paired_lines import Pose, Way
from msss_graphslam.core.types import Array

__all__ = ["Alignment"]

APART, APART_ANGLE = 0.02, 4e-3
"""Each way alone has come near enough for both to go on together [m], [rad]."""

STEP, STEP_ANGLE = 2e-3, 3e-4
"""An iteration that moves less than this has converged [m], [rad]."""

FEWEST = 3
"""Pairs of points and lines that say something of a displacement."""

Equations = tuple[list[list[float]], list[float]]
"""Normal equations: the matrix (3, 3) and the gradient (3,)."""


class Alignment:
    """Point-to-line ICP of two scans, each on the other's lines.

    Row 0 of what has two is the way forwards, the ``current`` scan's points on the lines of
    ``reference``; row 1 the way backwards. Either finds the displacement of the current scan. At
    first neither way knows of the other: ``apart`` (2, 3) is what they come to, and where they
    disagree the match is a wrong one. From the mean of both they go on together, to the ``pose``
    (3,) at which all pairs fit best: the mean weighs both ways alike, however little one of them
    sees. ``overlaps`` and ``scales`` (2,) are the share of points with a pair and the robust size
    of the normalised residuals.
    """

    def __init__(
        self,
        reference: LineFeatures,
        current: LineFeatures,
        initial: Array,
        covariance: Array,
        config: Matching,
        start: Array,
    ) -> None:
        self._ways = (
            Way(current, reference, backwards=False),
            Way(reference, current, backwards=True),
        )
        self._initial, self._prior = initial.tolist(), np.asarray(np.linalg.inv(covariance))
        self._information = self._prior.tolist()
        x, y, yaw = start.tolist()
        self._poses: tuple[Pose, Pose] = ((x, y, yaw), (x, y, yaw))
        left = self._align_apart(_reaches(initial, covariance), config)
        self.apart = np.array(self._poses)
        self._poses = (_middle(*self._poses),) * 2
        if self._is_enough:
            self._align_together(config.pairing_distance, max(left, 1))
        self.pose = np.array(self._poses[0])
        self.scales = np.array([pairs.scale for pairs in self._pairs])
        self.overlaps = np.array([pairs.overlap for pairs in self._pairs])

    @property
    def _is_enough(self) -> bool:
        """Whether there are pairs enough either way."""
        return min(map(len, self._pairs)) >= FEWEST

    def _align_apart(self, reaches: tuple[float, float], config: Matching) -> int:
        """Align each way for itself; return how many iterations are left."""
        narrow, left = config.pairing_distance, config.iterations
        settled = False
        while left and not settled:
            left -= 1
            wide = max(reaches) > narrow
            gates = max(reaches[0], narrow), max(reaches[1], narrow)
            equations = self._equations(gates)
            steps = tuple(
                _step(*sums) if len(pairs) >= FEWEST else (0.0, 0.0, 0.0)
                for sums, pairs in zip(equations, self._pairs, strict=True)
            )
            self._poses = _moved(self._poses[0], steps[0]), _moved(self._poses[1], steps[1])
            settled = not wide and _within(steps, APART, APART_ANGLE)
            reaches = 0.7 * gates[0], 0.7 * gates[1]
        return left

    def _align_together(self, gate: float, iterations: int) -> None:
        """Align both ways with one displacement."""
        for _ in range(iterations):
            (first, one), (second, other) = self._equations((gate, gate))
            step = _step(_sum(first, second), [a + b for a, b in zip(one, other, strict=True)])
            self._poses = (_moved(self._poses[0], step),) * 2
            if _within((step,), STEP, STEP_ANGLE):
                break

    def _equations(self, gates: tuple[float, float]) -> tuple[Equations, Equations]:
        """Pair anew and sum up robustly, with the initial guess as a weak prior."""
        self._pairs = forward, backward = (
            self._ways[0].paired(self._poses[0], gates[0]),
            self._ways[1].paired(self._poses[1], gates[1]),
        )
        return (
            self._with_prior(forward.sums.tolist(), self._poses[0]),
            self._with_prior(backward.sums.tolist(), self._poses[1]),
        )

    def _with_prior(self, sums: list[list[float]], pose: Pose) -> Equations:
        """Add the weak prior to the sums (3, 4) of one way at its pose."""
        x, y, yaw = (now - before for now, before in zip(pose, self._initial, strict=True))
        yaw = wrap_angle(yaw)
        gradient = [
            row[3] + a * x + b * y + c * yaw
            for row, (a, b, c) in zip(sums, self._information, strict=True)
        ]
        return _sum([row[:3] for row in sums], self._information), gradient

    def pairs(self) -> tuple[MatchedPairs, MatchedPairs] | None:
        """Return the last step's pairs, None where there were too few either way."""
        if not self._is_enough:
            return None
        forward, backward = self._pairs
        return forward.matched(self._prior), backward.matched(self._prior)


def _reaches(initial: Array, covariance: Array) -> tuple[float, float]:
    """Return how far off [m] points may be, three standard deviations, forwards and backwards."""
    x, y, _ = initial.tolist()
    seen_back = np.array([[1.0, 0.0, y], [0.0, 1.0, -x]])
    both = np.array([covariance[:2, :2], seen_back @ covariance @ seen_back.T])
    first, second = np.linalg.eigvalsh(both)[:, 1].tolist()
    return 3.0 * math.sqrt(first), 3.0 * math.sqrt(second)


def _step(matrix: list[list[float]], gradient: list[float]) -> Pose:
    """Return the step that solves normal equations; three numbers are too few for an array."""
    (a, b, c), (_, d, e), (_, _, f) = matrix
    u, v, w = gradient
    e -= b * c / a
    d -= b * b / a
    v -= b * u / a
    yaw = (w - c * u / a - e * v / d) / (f - c * c / a - e * e / d)
    y = (v - e * yaw) / d
    return -(u - b * y - c * yaw) / a, -y, -yaw


def _sum(first: list[list[float]], second: list[list[float]]) -> list[list[float]]:
    rows = zip(first, second, strict=True)
    return [[a + b for a, b in zip(one, other, strict=True)] for one, other in rows]


def _moved(pose: Pose, step: Pose) -> Pose:
    return pose[0] + step[0], pose[1] + step[1], wrap_angle(pose[2] + step[2])


def _middle(first: Pose, second: Pose) -> Pose:
    x, y, yaw = (b - a for a, b in zip(first, second, strict=True))
    return _moved(first, (0.5 * x, 0.5 * y, 0.5 * wrap_angle(yaw)))


def _within(steps: tuple[Pose, ...], most: float, most_angle: float) -> bool:
    return all(math.hypot(x, y) < most and abs(yaw) < most_angle for x, y, yaw in steps)
