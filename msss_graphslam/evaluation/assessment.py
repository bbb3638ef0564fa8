# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What follows from a run's record: errors where there is a truth, gaps and sharpness always."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import transform_points, wrap
from msss_graphslam.core.types import Array, Estimate, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.covariance_consistency import Consistency, consistency
from msss_graphslam.evaluation.errors import PoseErrors, interpolate, position_errors
from msss_graphslam.evaluation.map_consistency import wall_thickness
from msss_graphslam.results.record import RunRecord

__all__ = ["DEAD_RECKONING", "Assessment", "assess", "dead_reckoned_points"]

DEAD_RECKONING = "dead_reckoning"


@dataclass(frozen=True, slots=True)
class Assessment:
    """A run and what was measured of it.

    ``errors`` are by estimator: the run's own and dead reckoning; empty without truth, as
    ``online_errors`` and ``keyframe_consistency`` are None. ``truth_note`` says why a truth that
    exists could not be used. Thicknesses are those of the map's walls [m].
    """

    record: RunRecord
    errors: dict[str, PoseErrors]
    online_errors: PoseErrors | None
    keyframe_consistency: Consistency | None
    thickness: float | None
    dead_reckoned_thickness: float | None
    truth_note: str = ""

    @property
    def estimator(self) -> str:
        """The estimator's name."""
        return self.record.estimator

    @property
    def trajectories(self) -> dict[str, Trajectory]:
        """The trajectories by estimator, dead reckoning first."""
        estimate = self.record.estimate
        return {
            DEAD_RECKONING: estimate.dead_reckoning,
            estimate.estimator: estimate.trajectory,
        }

    @property
    def anchored_truth(self) -> Array | None:
        """The true planar poses (n, 3) in ``map``, or None."""
        return self.errors[self.estimator].truth if self.errors else None


def assess(record: RunRecord) -> Assessment:
    """Measure what can be measured of the run, and make up nothing where there is no truth."""
    errors: dict[str, PoseErrors] = {}
    online, honesty, note = None, None, ""
    estimate = record.estimate
    if record.truth is not None:
        try:
            errors = {
                DEAD_RECKONING: position_errors(estimate.dead_reckoning, record.truth),
                estimate.estimator: position_errors(estimate.trajectory, record.truth),
            }
            online = position_errors(estimate.online, record.truth)
            honesty = _keyframe_consistency(estimate, errors[estimate.estimator])
        except UserError as error:
            note = str(error)
    return Assessment(
        record=record,
        errors=errors,
        online_errors=online,
        keyframe_consistency=honesty,
        thickness=wall_thickness(record.points),
        dead_reckoned_thickness=wall_thickness(dead_reckoned_points(estimate)),
        truth_note=note,
    )


def dead_reckoned_points(estimate: Estimate) -> Array:
    """Return the map points (n, 2) [m] as dead reckoning alone would have placed them."""
    placed = [transform_points(scan.odometry, scan.points) for scan in estimate.first_scans]
    return np.vstack(placed) if placed else np.zeros((0, 2))


def _keyframe_consistency(estimate: Estimate, errors: PoseErrors) -> Consistency | None:
    """Compare the keyframes' errors with their covariances; the first is fixed and left out."""
    frames = estimate.keyframes[1:]
    stamps = np.array([frame.scan.stamp_ns for frame in frames], dtype=np.int64)
    truth, covered = interpolate(_planar_trajectory(errors), stamps)
    covariances = np.array([frame.covariance for frame in frames])
    if not covered.any() or np.linalg.eigvalsh(covariances).min() <= 0.0:
        return None
    difference = np.array([frame.pose for frame in frames]) - truth
    difference[:, 2] = wrap(difference[:, 2])
    return consistency(difference[covered], covariances[covered])


def _planar_trajectory(errors: PoseErrors) -> Trajectory:
    poses = np.zeros((len(errors.truth), 6))
    poses[:, [0, 1, 5]] = errors.truth
    return Trajectory(errors.stamps_ns, poses)
