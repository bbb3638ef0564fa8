# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Coloured noise."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["GaussMarkov"]


@dataclass(frozen=True, slots=True)
class GaussMarkov:
    """A first-order Gauss-Markov process, behind a first-order ``lag`` [s] where it has inertia.

    ``deviation`` is the stationary standard deviation of the result, ``correlation_time`` [s]
    (or [m]) that of the driving process. Without a lag the rate of change is white.
    """

    deviation: float
    correlation_time: float
    lag: float = 0.0

    def sample(
        self, generator: np.random.Generator, count: int, period: float, *, from_zero: bool = False
    ) -> Array:
        """Return ``count`` samples, ``period`` [s] apart; stationary, or begun at 0."""
        # The other commands of ``msss`` are spared the time that it takes.
        from scipy.signal import lfilter

        gain = np.sqrt(1.0 + self.lag / self.correlation_time)
        decay = np.exp(-period / self.correlation_time)
        driving = gain * self.deviation * generator.standard_normal(count)
        driving[1:] *= np.sqrt(1.0 - decay**2)
        if from_zero:
            driving[0] = 0.0
        process = lfilter([1.0], [1.0, -decay], driving)
        if not self.lag:
            return np.asarray(process)
        decay = np.exp(-period / self.lag)
        start = process[0] / gain - (1.0 - decay) * process[0]
        return np.asarray(lfilter([1.0 - decay], [1.0, -decay], process, zi=[start])[0])
