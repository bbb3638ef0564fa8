# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How long dead reckoning's twist error stays what it is: a Gauss-Markov process."""

import math
from dataclasses import dataclass

import numpy as np

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.types import Array

__all__ = ["Persistence", "persistence_of"]

SHORT = 1e-3
"""Share of the correlation time in which an error stays what it is."""


@dataclass(frozen=True, slots=True)
class Persistence:
    """How much of a twist error of one turn is still there in the next.

    Only the part that changes slowly is, within ``correlation_time`` [s]: its variances ``slow``
    (3,) of surge, sway [m^2/s^2] and yaw rate [rad^2/s^2]. What dead reckoning doubts beyond that,
    as without a gyro or without any sensor of motion, is new in every turn.
    """

    correlation_time: float
    slow: Array

    def over(self, interval: float, covariance: Array) -> Array:
        """Return what is left (3,) of an error of this covariance (3, 3) in the next turn.

        Errors are means over turns of ``interval`` [s] each, which are more alike than the
        process at their beginnings.
        """
        variances = np.maximum(np.diag(covariance), np.finfo(float).tiny)
        kept = _likeness(interval / self.correlation_time)
        return np.asarray(kept * np.minimum(self.slow, variances) / variances)

    def scaled(self, factors: Array) -> "Persistence":
        """Return the same with the slow variances times ``factors`` (3,)."""
        return Persistence(self.correlation_time, factors * self.slow)

    def mean_over(self, interval: float, covariance: Array) -> Array:
        """Return the covariance (3, 3) of an error's mean over ``interval`` [s].

        ``covariance`` (3, 3) is the error's at the beginning; it returns to ``slow`` meanwhile.
        """
        share = interval / self.correlation_time
        if share < SHORT:
            return covariance
        first = -math.expm1(-share) / share
        grown = max(2.0 * (1.0 - first) / share - first**2, 0.0)
        return first**2 * covariance + np.diag(grown * self.slow)


def persistence_of(config: DeadReckoning) -> Persistence:
    """Return the persistence that dead reckoning's parameters state."""
    deviations = np.array([config.surge_noise, config.sway_noise, config.gyro_bias])
    return Persistence(config.velocity_correlation_time, deviations**2)


def _likeness(share: float) -> float:
    """Return the correlation of a Gauss-Markov process' means over two turns, one after another.

    A turn lasts ``share`` of the correlation time.
    """
    if share < SHORT:
        return 1.0 - 2.0 * share / 3.0
    lost = -math.expm1(-share)
    return lost**2 / (2.0 * (share - lost))
