# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How long dead reckoning's twist error stays what it is: a Gauss-Markov process."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.types import Array

__all__ = ["Persistence", "persistence_of"]

SHORT = 1e-3
"""No error is followed as staying what it is over less than this share of that time."""


@dataclass(frozen=True, slots=True)
class Persistence:
    """How much of a twist error of one turn is still there in the next.

    Only the part that changes slowly is, within ``correlation_time`` [s], one or (3,): its
    variances ``slow`` (3,) of surge, sway [m^2/s^2] and yaw rate [rad^2/s^2]. What dead reckoning
    doubts beyond that, as without a gyro or without any sensor of motion, is new in every turn.
    """

    correlation_time: float | Array
    slow: Array

    def over(self, interval: float, covariance: Array) -> Array:
        """Return what is left (3,) of an error of this covariance (3, 3) in the next turn.

        Errors are means over turns of ``interval`` [s] each, which are more alike than the
        process at their beginnings.
        """
        variances = np.maximum(np.diag(covariance), np.finfo(float).tiny)
        share = self._share(interval)
        lost = -np.expm1(-share)
        # The correlation of the process' means over two turns, one after another.
        kept = lost**2 / (2.0 * (share - lost))
        return np.asarray(kept * np.minimum(self.slow, variances) / variances)

    def scaled(self, larger: Array, longer: Array) -> "Persistence":
        """Return the same with slow variances and times as many times as large (3,)."""
        return Persistence(longer * self.correlation_time, larger * self.slow)

    def mean_over(self, interval: float, covariance: Array) -> Array:
        """Return the covariance (3, 3) of an error's mean over ``interval`` [s].

        ``covariance`` (3, 3) is the error's at the beginning; it returns to ``slow`` meanwhile.
        """
        share = self._share(interval)
        first = -np.expm1(-share) / share
        grown = 2.0 * (1.0 - first) / share - first**2
        return np.asarray(np.outer(first, first) * covariance + np.diag(grown * self.slow))

    def _share(self, interval: float) -> Array:
        """Return the interval as a share (3,) of the correlation time."""
        return np.maximum(interval / self.correlation_time * np.ones(3), SHORT)


def persistence_of(config: DeadReckoning) -> Persistence:
    """Return the persistence that dead reckoning's parameters state."""
    deviations = np.array([config.surge_noise, config.sway_noise, config.gyro_bias])
    return Persistence(config.velocity_correlation_time, deviations**2)
