# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether covariances are honest."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from msss_graphslam.core.types import Array

__all__ = ["Consistency", "StepConsistency", "consistency", "step_consistency"]


@dataclass(frozen=True, slots=True)
class Consistency:
    """Mean normalised estimation error squared (NEES) and the 95 % band of honest covariances."""

    mean: float
    low: float
    high: float
    samples: int

    @property
    def honest(self) -> bool:
        """Whether the mean lies in the band."""
        return self.low <= self.mean <= self.high


def consistency(errors: Array, covariances: Array) -> Consistency:
    """Return the NEES of errors (n, d) under covariances (n, d, d), divided by d: 1 is honest.

    Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with Applications to Tracking and
    Navigation, 2001, section 5.4. The band takes the samples as independent; those of one
    trajectory are not, so that it is too narrow for them.
    """
    samples, dimension = errors.shape
    solved = np.linalg.solve(covariances, errors[..., None])[..., 0]
    degrees = samples * dimension
    low, high = chdtri(degrees, [0.975, 0.025]) / degrees
    mean = float(np.sum(errors * solved) / degrees)
    return Consistency(mean, float(low), float(high), samples)


@dataclass(frozen=True, slots=True)
class StepConsistency:
    """NEES of many missions, step by step, each step's mean against the band of honest ones.

    ``mean`` over all, the 95 % band from ``low`` to ``high`` for a step, and the shares of the
    steps in it: ``inside``, ``above`` (errors larger than stated) and ``below``.
    """

    mean: float
    low: float
    high: float
    inside: float
    above: float
    below: float
    missions: int


def step_consistency(errors: Array, covariances: Array) -> StepConsistency:
    """Return the consistency of errors (m, s, d) under covariances (m, s, d, d).

    ``m`` missions that are independent of each other, each looked at in the same ``s`` steps. The
    errors within one mission hang together, so that the band is that of ``m`` samples, however
    many steps there are. Raises ValueError where there is nothing to compare.
    """
    missions, steps, dimension = errors.shape
    if not missions or not steps:
        raise ValueError("no mission or no step to compare errors of")
    solved = np.linalg.solve(covariances, errors[..., None])[..., 0]
    means = np.sum(errors * solved, axis=(0, 2)) / (missions * dimension)
    degrees = missions * dimension
    low, high = chdtri(degrees, [0.975, 0.025]) / degrees
    above, below = float(np.mean(means > high)), float(np.mean(means < low))
    return StepConsistency(
        float(means.mean()),
        float(low),
        float(high),
        1.0 - above - below,
        above,
        below,
        missions,
    )
