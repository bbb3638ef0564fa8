# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How much dead reckoning's slow error changes, learned from what the matches show of it."""

# Deviation: the paper's noise is a parameter. How unsteadily a vehicle moves depends on the day,
# and all that is stated of a scan's layout depends on it.

from dataclasses import dataclass, field

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["NoiseScale"]

BELIEF = 10.0
"""The parameters count as much as so many turns."""

MEMORY = 30.0
"""So many turns count at most: the water changes."""

OUTLIER = 9.0
"""A squared error of more than so many variances tells of a wrong match, not of the noise."""


@dataclass(frozen=True, slots=True)
class NoiseScale:
    """By what ``factors`` (3,) the variances of the slow error's changes differ from the assumed.

    ``turns`` (3,) is how many the factors rest on, the assumption included. If there are more
    changes than assumed, the error is larger. If there are fewer, it may be smaller or last
    longer, as a gyro's bias does, and changes do not tell which: as much of the one as the other.
    """

    factors: Array = field(default_factory=lambda: np.ones(3))
    turns: Array = field(default_factory=lambda: np.full(3, BELIEF))

    @property
    def larger(self) -> Array:
        """By what (3,) the slow error's variances differ from the assumed."""
        return np.maximum(self.factors, np.sqrt(self.factors))

    @property
    def longer(self) -> Array:
        """How many times as long (3,) as assumed the slow error lasts."""
        return self.larger / self.factors

    def applied(self, stationary: Array, slow: Array) -> Array:
        """Return the a-priori covariance (3, 3) of the error with its slow part scaled.

        ``slow`` (3,) are the variances that the slow part may have, unscaled.
        """
        variances = np.maximum(np.diag(stationary), np.finfo(float).tiny)
        grown = variances + (self.larger - 1.0) * np.minimum(slow, variances)
        roots = np.sqrt(grown / variances)
        return np.asarray(np.outer(roots, roots) * stationary)

    def with_shown(self, squares: Array, expected: Array, shares: Array) -> "NoiseScale":
        """Return what is known with one more turn.

        Its errors' ``squares`` (3,) are compared with the variances ``expected`` (3,) of them, of
        which the slow error makes up the ``shares`` (3,). That is a step of Fisher's scoring: the
        less of a variance the noise makes up, the less it says of the noise.
        """
        turns = self.turns + shares**2
        excess = np.minimum(squares / expected, OUTLIER) - 1.0
        factors = self.factors * (1.0 + shares * excess / turns)
        return NoiseScale(factors, np.minimum(turns, MEMORY))
