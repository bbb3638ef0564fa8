# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The results of some seeds, and their figures beside the bars."""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from benchmarks.missions import Accuracy
from benchmarks.page import metres
from msss_graphslam.core.types import Array

__all__ = ["Series", "against"]


@dataclass(frozen=True, slots=True)
class Series:
    """What came out under one condition; figures go by their names in Accuracy."""

    results: Sequence[Accuracy]

    def values(self, figure: str) -> Array:
        """Return a figure of every seed (n,) [m]."""
        return np.array([attrgetter(figure)(result) for result in self.results])

    def mean(self, figure: str) -> float:
        """Return the mean over the seeds [m]."""
        return float(np.mean(self.values(figure)))

    def worst(self, figure: str) -> float:
        """Return the largest over the seeds [m]."""
        return float(np.max(self.values(figure)))

    def worst_of(self, figure: str) -> Accuracy:
        """Return the result of the seed in which the figure is largest."""
        return max(self.results, key=attrgetter(figure))

    def unevenness(self, figure: str) -> float:
        """Return by how much the worst seed exceeds the mean, as a factor."""
        return self.worst(figure) / self.mean(figure)

    def mean_and_worst(self, figure: str) -> str:
        """Return both as a cell of a table."""
        return f"{metres(self.mean(figure))} / {metres(self.worst(figure))}"


def against(value: float, limit: float | None) -> str:
    """Return a cell with the value beside the bar, where there is one; bold where it is missed."""
    if limit is None:
        return metres(value)
    if value <= limit:
        return f"{metres(value)} (≤ {limit:.3g})"
    return f"**{metres(value)}** (> {limit:.3g})"
