# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether covariances are honest."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from msss_graphslam.core.types import Array

__all__ = ["Consistency", "consistency"]


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
