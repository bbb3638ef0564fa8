# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Robust Gauss-Newton steps of points onto lines, both ways of two scans side by side."""

import math

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.matching.both_ways import StackedLines, StackedPoints
from msss_graphslam.core.matching.line_features import LineFeatures
from msss_graphslam.core.matching.match_covariance import LEAST_SCALE, MatchedPairs
from msss_graphslam.core.matching.paired_lines import SAME_SIDE, PairedLines, Pose
from msss_graphslam.core.types import Array

__all__ = ["CAUCHY", "SAME_SIDE", "Alignment"]

CAUCHY = 2.0
"""Residual, in robust standard deviations, at which a pair's weight is halved."""

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
    first neither way knows of the other, they only share the calls: ``apart`` (2, 3) is what they
    come to, and where they disagree the match is a wrong one. From the mean of both they go on
    together, to the ``pose`` (3,) at which all pairs fit best: the mean weighs both ways alike,
    however little one of them sees. ``overlaps`` and ``scales`` (2,) are the share of points with
    a pair and the robust size of the normalised residuals.
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
        self._lines = StackedLines.of(reference, current)
        self._points = StackedPoints.of(current, reference)
        self._initial, self._prior = initial.tolist(), np.asarray(np.linalg.inv(covariance))
        self._information = self._prior.tolist()
        x, y, yaw = start.tolist()
        self._poses: tuple[Pose, Pose] = ((x, y, yaw), (x, y, yaw))
        left = self._align_apart(_reaches(initial, covariance), config)
        self.apart = np.array(self._poses)
        self._poses = (_middle(*self._poses),) * 2
        if min(self._pairs.counts) >= FEWEST:
            self._align_together(config.pairing_distance, max(left, 1))
        self.pose = np.array(self._poses[0])
        self.scales = np.array(self._scales)
        self.overlaps = np.array(self._pairs.counts) / np.maximum(self._points.counts, 1)

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
                _step(*sums) if count >= FEWEST else (0.0, 0.0, 0.0)
                for sums, count in zip(equations, self._pairs.counts, strict=True)
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
        self._pairs = pairs = PairedLines(self._lines, self._points, self._poses, gates)
        rows, ways = pairs.rows, (slice(0, pairs.middle), slice(pairs.middle, None))
        size = np.abs(rows[3])
        self._scales = [_robust_size(size[way]) for way in ways]
        widths = [CAUCHY * max(scale, LEAST_SCALE) for scale in self._scales]
        self._weights = 1.0 / (1.0 + (rows[3] / np.repeat(widths, pairs.counts)) ** 2)
        weighted = rows[:3] * self._weights
        first, second = (
            self._with_prior((weighted[:, way] @ rows[:, way].T).tolist(), pose)
            for way, pose in zip(ways, self._poses, strict=True)
        )
        return first, second

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
        if min(self._pairs.counts) < FEWEST:
            return None
        rows, twin, slips = self._pairs.rows, self._pairs.twin(), self._pairs.slips()
        middle = self._pairs.middle
        forward, backward = (
            MatchedPairs(
                rows[:3, way].T,
                twin[:, way].T,
                rows[3, way],
                self._weights[way],
                slips[way],
                self._prior,
            )
            for way in (slice(0, middle), slice(middle, None))
        )
        return forward, backward


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


def _robust_size(sizes: Array) -> float:
    """Return the standard deviation that sizes of residuals speak of, 1 without any."""
    middle = len(sizes) // 2
    return 1.4826 * float(np.partition(sizes, middle)[middle]) if len(sizes) else 1.0


def _within(steps: tuple[Pose, ...], most: float, most_angle: float) -> bool:
    return all(math.hypot(x, y) < most and abs(yaw) < most_angle for x, y, yaw in steps)
