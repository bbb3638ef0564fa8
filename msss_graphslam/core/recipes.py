# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The estimators by name: which parts of the pipeline each of them uses."""

from collections.abc import Callable
from dataclasses import dataclass

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.matching.matchers import LineMatcher, ScanMatcher, SpicMatcher
from msss_graphslam.core.scans.trajectory_correction import Solver, closed_form, nelder_mead

__all__ = ["ESTIMATORS", "Recipe"]


@dataclass(frozen=True, slots=True)
class Recipe:
    """An estimator.

    ``matcher`` makes the scan matcher, None leaves dead reckoning alone. ``closes_loops``: Section
    V. ``solver`` of the trajectory correction. ``goes_beyond``: what the paper does not have:
    motion learned from the sonar, odometry kept beside the matches, neighbours found by overlap,
    the last part turn, and joint smoothing of all scans.
    """

    name: str
    matcher: Callable[[Matching], ScanMatcher] | None
    closes_loops: bool
    solver: Solver
    goes_beyond: bool = False


ESTIMATORS = {
    recipe.name: recipe
    for recipe in (
        Recipe("dead_reckoning", None, closes_loops=False, solver=closed_form),
        Recipe("uspic", SpicMatcher, closes_loops=False, solver=nelder_mead),
        Recipe("chen2015", SpicMatcher, closes_loops=True, solver=nelder_mead),
        Recipe("full", LineMatcher, closes_loops=True, solver=closed_form, goes_beyond=True),
    )
}
"""Every estimator that can be chosen; ``full`` is the default."""
