# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Graphs of noisy constraints whose truth is known, and back ends that have taken them."""

import numpy as np

from msss_graphslam.config.groups import BackEnd as Config
from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

LEAST_SQUARES = Config(robust_width=0.0)
START = np.array([1.0, -2.0, 0.4])
NODES = 12


def random_covariance(rng: np.random.Generator) -> Array:
    """Not diagonal, so that the axes matter."""
    root = np.diag([0.08, 0.03, 0.01]) @ rng.normal(size=(3, 3))
    return root @ root.T + np.diag([1e-4, 1e-4, 1e-6])


def edge(
    first: int,
    second: int,
    relative: Array,
    covariance: Array | None = None,
    kind: ConstraintKind = ConstraintKind.ODOMETRY,
) -> Constraint:
    spread = np.diag([1e-3, 2e-3, 1e-4]) if covariance is None else covariance
    return Constraint(kind, first, second, relative, spread)


def loop(first: int, second: int, relative: Array, covariance: Array | None = None) -> Constraint:
    return edge(first, second, relative, covariance, ConstraintKind.LOOP)


def ring(seed: int) -> tuple[Array, list[list[Constraint]]]:
    """The truth (n, 3), and for each new keyframe its noisy constraints: a chain and chords."""
    rng = np.random.default_rng(seed)
    truth = [START]
    for _ in range(NODES - 1):
        truth.append(compose(truth[-1], np.array([1.0, 0.1, 0.55]) + rng.normal(0.0, 0.05, 3)))
    steps = []
    for second in range(1, NODES):
        pairs = [(second - 1, second)] + [(second - k, second) for k in (3, 7) if second >= k]
        new = []
        for first, other in pairs:
            covariance = random_covariance(rng)
            exact = between(truth[first], truth[other])
            noisy = exact + rng.multivariate_normal(np.zeros(3), covariance)
            kind = ConstraintKind.ODOMETRY if other - first == 1 else ConstraintKind.LOOP
            new.append(edge(first, other, noisy, covariance, kind))
        steps.append(new)
    return np.array(truth), steps


def fed(steps: list[list[Constraint]], config: Config = LEAST_SQUARES) -> BackEnd:
    back_end = BackEnd(config)
    back_end.add_keyframe(START)
    back_end.update([])
    for new in steps:
        back_end.update(new)
    return back_end


def assert_same_poses(poses: Array, expected: Array, tolerance: float) -> None:
    np.testing.assert_allclose(poses[:, :2], expected[:, :2], atol=tolerance)
    np.testing.assert_allclose(wrap(poses[:, 2] - expected[:, 2]), 0.0, atol=tolerance)
