# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far off matches are for how dead reckoning has bent their scans, by what they show."""

from dataclasses import dataclass, replace

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["LAYOUT", "LayoutSlack"]

LAYOUT = np.diag([0.15**2, 0.15**2, 0.02**2])
"""How far off a match may be for how dead reckoning has bent its scans (3, 3), at most."""

PRIOR = 20
"""As many matches count as ``LAYOUT`` before the first: those of some seven scans."""

AT_MOST = float(np.trace(LAYOUT[:2, :2]))


@dataclass(frozen=True, slots=True)
class LayoutSlack:
    """The mean of ``count`` squared distances between near matches and the way.

    ``squares`` [m^2] is their sum.
    Scans that lie few turns apart tell how much bent scans disagree; far ones are bent alike.
    """

    squares: float = PRIOR * AT_MOST
    count: int = PRIOR

    @property
    def covariance(self) -> Array:
        """What is allowed beside the stated covariances (3, 3): a share of ``LAYOUT``."""
        return min(self.squares / (self.count * AT_MOST), 1.0) * LAYOUT

    def with_match(self, off: Array) -> "LayoutSlack":
        """Return what is known after a near match was ``off`` (3,) the way."""
        square = float(off[:2] @ off[:2])
        return replace(self, squares=self.squares + square, count=self.count + 1)
