# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Pairs of scans whose true displacement is known."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.types import Array, Estimate, Trajectory
from msss_graphslam.evaluation.errors import interpolate

__all__ = ["ScanPair", "Start", "scan_pairs", "starts"]


@dataclass(frozen=True, slots=True)
class ScanPair:
    """Two scans of a run by their numbers, and the true ``displacement`` (3,) between them."""

    reference: int
    current: int
    displacement: Array


@dataclass(frozen=True, slots=True)
class Start:
    """How far off a first guess is: ``distance`` [m] in any direction, ``angle`` [rad]."""

    distance: float
    angle: float

    @property
    def covariance(self) -> Array:
        """The covariance (3, 3) that such a first guess deserves."""
        return np.diag([0.5 * self.distance**2, 0.5 * self.distance**2, self.angle**2])

    def __str__(self) -> str:
        return f"{self.distance:g} m, {np.rad2deg(self.angle):.0f}°"


def scan_pairs(
    estimate: Estimate, truth: Trajectory, most: int, generator: np.random.Generator
) -> list[ScanPair]:
    """Choose at most ``most`` of the pairs that a run has matched.

    The scans are the keyframes', laid out by the corrected trajectory, the same for all matchers.
    """
    stamps = np.array([keyframe.scan.stamp_ns for keyframe in estimate.keyframes])
    poses, _ = interpolate(truth, stamps)
    matched = sorted({(edge.first, edge.second) for edge in estimate.constraints if edge.accepted})
    chosen = generator.choice(len(matched), min(most, len(matched)), replace=False)
    return [
        ScanPair(first, second, between(poses[first], poses[second]))
        for first, second in (matched[number] for number in np.sort(chosen))
    ]


def starts(
    pairs: Sequence[ScanPair], start: Start, generator: np.random.Generator
) -> Iterator[tuple[ScanPair, Array]]:
    """Yield each pair with a first guess (3,) that is as far off as ``start`` says."""
    for pair in pairs:
        direction = generator.uniform(-np.pi, np.pi)
        sign = generator.choice([-1.0, 1.0])
        offset = start.distance * np.array([np.cos(direction), np.sin(direction), 0.0])
        offset[2] = sign * start.angle
        yield pair, compose(pair.displacement, offset)
