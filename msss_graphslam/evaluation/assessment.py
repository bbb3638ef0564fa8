# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What follows from a run's record: errors where there is a truth, gaps and sharpness always."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import between, compose, transform_points, wrap
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
    ``online_errors`` and the keyframes' are None. ``keyframe_errors`` (k, 3) are estimated minus
    true poses relative to the first keyframe, NaN where the truth is silent. ``truth_note`` says
    why a truth that exists could not be used. Thicknesses are those of the map's walls [m].
    """

    record: RunRecord
    errors: dict[str, PoseErrors]
    online_errors: PoseErrors | None
    keyframe_errors: Array | None
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
    online, keyframes, note = None, None, ""
    estimate = record.estimate
    if record.truth is not None:
        try:
            errors = {
                DEAD_RECKONING: position_errors(estimate.dead_reckoning, record.truth),
                estimate.estimator: position_errors(estimate.trajectory, record.truth),
            }
            online = position_errors(estimate.online, record.truth, estimate.trajectory)
            keyframes = _keyframe_errors(record, errors[estimate.estimator])
        except UserError as error:
            note = str(error)
    return Assessment(
        record=record,
        errors=errors,
        online_errors=online,
        keyframe_errors=keyframes,
        keyframe_consistency=_keyframe_consistency(estimate, keyframes),
        thickness=wall_thickness(record.points),
        dead_reckoned_thickness=wall_thickness(dead_reckoned_points(estimate)),
        truth_note=note,
    )


def dead_reckoned_points(estimate: Estimate) -> Array:
    """Return the map points (n, 2) [m] as dead reckoning alone would have placed them."""
    placed = [transform_points(scan.odometry, scan.points) for scan in estimate.first_scans]
    return np.vstack(placed) if placed else np.zeros((0, 2))


def _keyframe_errors(record: RunRecord, errors: PoseErrors) -> Array | None:
    """Return estimated minus true poses with the first keyframe put upon its true pose.

    The first keyframe is the graph's gauge: covariances are relative to it, heading included.
    """
    keyframes = record.keyframe_trajectory
    truth, covered = interpolate(_planar_trajectory(errors), keyframes.stamps_ns)
    if not covered.any():
        return None
    first = int(np.argmax(covered))
    relative = between(truth[first], truth)
    difference = keyframes.planar - compose(keyframes.planar[first], relative)
    difference[:, 2] = wrap(difference[:, 2])
    difference[~covered] = np.nan
    return difference


def _keyframe_consistency(estimate: Estimate, errors: Array | None) -> Consistency | None:
    """Compare the keyframes' errors with their covariances; the first is fixed and left out."""
    if errors is None or len(errors) < 2:
        return None
    covariances = np.array([frame.covariance for frame in estimate.keyframes[1:]])
    known = np.isfinite(errors[1:, 0])
    if not known.any() or np.linalg.eigvalsh(covariances[known]).min() <= 0.0:
        return None
    return consistency(errors[1:][known], covariances[known])


def _planar_trajectory(errors: PoseErrors) -> Trajectory:
    poses = np.zeros((len(errors.truth), 6))
    poses[:, [0, 1, 5]] = errors.truth
    return Trajectory(errors.stamps_ns, poses)
