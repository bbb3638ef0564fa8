# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end and back end in turn, scan by scan: lines 8 to 22 of Algorithm 1."""

from contextlib import nullcontext

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.guarded_back_end import GuardedBackEnd
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.types import Constraint, Scan, Stage

__all__ = ["GraphSlam"]


class GraphSlam:
    """Scans in, poses and constraints out."""

    def __init__(
        self, configuration: Configuration, recipe: Recipe, stage: Stage = lambda _: nullcontext()
    ) -> None:
        self._stage = stage
        self.front_end = FrontEnd(configuration, recipe, stage)
        self._back_end = GuardedBackEnd(configuration.back_end, guards=recipe.goes_beyond)

    @property
    def constraints(self) -> list[Constraint]:
        """All constraints tried, in order, refused as they stand now."""
        return self._back_end.tried

    def add_scan(self, scan: Scan) -> list[Constraint]:
        """Algorithm 1, lines 8 to 22, for one scan; return the constraints tried."""
        tried = self.front_end.add_scan(scan)  # lines 10 and 11
        with self._stage("back_end"):
            answer = self._back_end.take(self.front_end.poses[-1], tried)  # line 12
        self.front_end.correct(*answer)  # lines 13 and 14
        return self.constraints[len(self.constraints) - len(tried) :]
