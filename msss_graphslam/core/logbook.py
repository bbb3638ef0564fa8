# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What happened in a mission, and what is made of it in the end."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.beam_log import BeamLog
from msss_graphslam.core.graph.whole_graph import whole_graph
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.scans.bare_scans import LaidOut, bare
from msss_graphslam.core.scans.corrected_keyframes import corrected_keyframes
from msss_graphslam.core.scans.persistence import persistence_of
from msss_graphslam.core.scans.scan_correction import corrected_scans
from msss_graphslam.core.smoothing.joint_pairs import first_reach, pairs_of
from msss_graphslam.core.smoothing.joint_smoothing import Reach, Smoothed, smooth
from msss_graphslam.core.types import (
    Array,
    Constraint,
    Estimate,
    Scan,
    SonarCalibration,
    Stage,
    TwistError,
)

__all__ = ["Logbook"]


class Logbook:
    """Scans, constraints and poses as they come; an Estimate at the end.

    ``poses`` (n, 3) are those of the keyframes as the graph has them now, ``twist_error``
    what the newest one has shown of dead reckoning.
    """

    def __init__(
        self, configuration: Configuration, recipe: Recipe, stage: Stage = lambda _: nullcontext()
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._stage = stage
        self._beams = BeamLog()
        self.scans: list[Scan] = []
        self.constraints: list[Constraint] = []
        self.poses: Array = np.empty((0, 3))
        self.twist_error: TwistError | None = None
        self._calibration: SonarCalibration | None = None

    def add_scan(self, scan: Scan) -> None:
        """Note the beams of a scan, and the scan if it is a keyframe's."""
        self._beams.add_scan(scan)
        if scan.usable:
            self.scans.append(bare(scan))

    def add_online(self, stamp_ns: int, pose: Array) -> None:
        """Note the pose (6,) that a subscriber had at ``stamp_ns``."""
        self._beams.add_online(stamp_ns, pose)

    def keyframe_scans(self) -> list[Scan]:
        """Return the keyframes' scans, made anew from the trajectory as it stands."""
        solver = self._recipe.solver
        return corrected_scans(self._keyframes_own(), self.poses, solver, self._learned)

    def finish(self, progress: Callable[[float], None] = lambda _: None) -> Estimate:
        """Smooth the trajectory if the recipe says so, and return everything.

        ``progress`` takes the share of joint smoothing that is done, from 0, before it, to 1.
        """
        covariances = self._settle(progress)
        solver = self._recipe.solver
        error = self._learned.mean if self._learned else np.zeros(3)
        trajectory = self._beams.corrected(self.scans, self.poses, solver, error)
        return Estimate(
            estimator=self._recipe.name,
            trajectory=trajectory,
            online=self._beams.online,
            dead_reckoning=self._beams.dead_reckoning_at(trajectory.stamps_ns),
            keyframes=corrected_keyframes(
                self._keyframes_own(), self.poses, covariances, solver, self._learned
            ),
            first_scans=LaidOut(self.scans[: len(self.poses)]),
            constraints=tuple(self.constraints),
            sonar_calibration=self._calibration,
        )

    def _keyframes_own(self) -> list[Scan]:
        """Return the keyframes' scans; the last, which none follows to correct it, laid out."""
        scans = self.scans[: len(self.poses)]
        return [*scans[:-1], *LaidOut(scans[-1:])]

    @property
    def _learned(self) -> TwistError | None:
        return self.twist_error if self._recipe.goes_beyond else None

    def _settle(self, progress: Callable[[float], None]) -> Sequence[Array]:
        """Smooth, and return the covariances (3, 3) of the keyframes."""
        if not self._recipe.goes_beyond or len(self.poses) < 2:
            config = self._configuration.back_end
            back_end = whole_graph(self.poses, self.constraints, config)
            return [back_end.covariance(number) for number in range(len(self.poses))]
        with self._stage("joint_smoothing"):
            progress(0.0)
            smoothed = self._smooth(progress)
        self.poses = smoothed.poses
        self.twist_error = TwistError(smoothed.twist, smoothed.twist_covariance)
        self._calibration = smoothed.sonar_calibration
        return list(smoothed.covariances)

    def _smooth(self, progress: Callable[[float], None]) -> Smoothed:
        config = self._configuration
        learned = self._learned.mean if self._learned else np.zeros(3)
        scans, narrow = self.scans[: len(self.poses)], config.matching.pairing_distance
        return smooth(
            scans,
            self.poses,
            learned,
            pairs_of(self.constraints, config.association.most),
            persistence_of(config.dead_reckoning),
            Reach(first_reach(scans, self.constraints, narrow), narrow),
            progress,
        )
