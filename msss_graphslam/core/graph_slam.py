# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end and back end in turn, scan by scan: lines 8 to 22 of Algorithm 1."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.back_end import BackEnd
from msss_graphslam.core.front_end import FrontEnd
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.refinement import refine
from msss_graphslam.core.types import Array, Constraint, Keyframe, Scan, Stage

__all__ = ["GraphSlam"]


class GraphSlam:
    """Scans in, keyframes and constraints out."""

    def __init__(
        self, configuration: Configuration, recipe: Recipe, stage: Stage = lambda _: nullcontext()
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._stage = stage
        self.front_end = FrontEnd(configuration, recipe, stage)
        self._back_end = BackEnd(configuration.back_end)
        self.constraints: list[Constraint] = []

    def add_scan(self, scan: Scan) -> None:
        """Algorithm 1, lines 8 to 22, for one scan."""
        tried = self.front_end.add_scan(scan)  # lines 10 and 11
        self.constraints += tried
        with self._stage("back_end"):
            poses, covariance = self._optimise(tried)  # line 12
        self.front_end.correct(poses, covariance)  # lines 13 and 14

    def refine(self, progress: Callable[[float], None]) -> None:
        """Go over the whole graph again, where the recipe does so."""
        matcher = self._recipe.matcher
        if not self._recipe.goes_beyond or matcher is None or len(self.front_end.nodes) < 2:
            return
        with self._stage("refinement"):
            refined = refine(
                self.front_end.nodes,
                self.front_end.poses,
                self.constraints,
                matcher(self._configuration.matching),
                self._configuration.back_end,
                progress,
            )
        self.front_end.poses = refined.poses
        self.constraints = refined.constraints
        self._back_end = refined.back_end

    def keyframes(self) -> tuple[Keyframe, ...]:
        """Every keyframe with its scan, pose and covariance as they stand."""
        return tuple(
            Keyframe(node.scan, pose, self._back_end.covariance(number))
            for number, (node, pose) in enumerate(
                zip(self.front_end.nodes, self.front_end.poses, strict=True)
            )
        )

    def _optimise(self, tried: Sequence[Constraint]) -> tuple[Array, Array]:
        if not tried:
            self._back_end.add_keyframe(self.front_end.poses[0])
        poses = self._back_end.update([entry for entry in tried if entry.accepted])
        return poses, self._back_end.covariance(len(poses) - 1)
