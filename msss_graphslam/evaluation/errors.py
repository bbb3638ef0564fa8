# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far an estimate is from the truth.

Errors are horizontal: the depth is measured, not estimated. Two views are given of them, since a
good estimator's anchored error is mostly a rotation of the whole map about the launch.
"""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Stamps, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.alignment import align

__all__ = [
    "PoseErrors",
    "Statistics",
    "interpolate",
    "position_errors",
    "start_end_gap",
]

LONGEST_TRUTH_GAP_NS = 5_000_000_000
"""Across a longer silence the truth is not interpolated: the vehicle may have turned."""


@dataclass(frozen=True, slots=True)
class Statistics:
    """Mean, root mean square and maximum."""

    mean: float
    rmse: float
    max: float

    @classmethod
    def of(cls, errors: Array) -> "Statistics":
        """Summarise errors (n,)."""
        return cls(
            float(np.mean(errors)),
            float(np.sqrt(np.mean(errors**2))),
            float(np.max(np.abs(errors))),
        )


@dataclass(frozen=True, slots=True)
class PoseErrors:
    """Errors at the stamps (n,) that the truth covers; ``left_out`` counts the others.

    ``truth`` (n, 3) is the true planar pose in ``map``, anchored. ``anchored`` (n,) [m] are the
    distances to it, ``aligned`` (n,) [m] those after the best rotation and translation,
    ``heading`` (n,) [rad] the estimated minus the true yaw.
    """

    stamps_ns: Stamps
    truth: Array
    anchored: Array
    aligned: Array
    heading: Array
    left_out: int


def position_errors(
    estimate: Trajectory, truth: Trajectory, launched_as: Trajectory | None = None
) -> PoseErrors:
    """Compare an estimate with the truth.

    Anchored as in Section VIII-A: the truth is shifted so that the first common position is the
    estimate's, and nothing is rotated, so that an error of the heading at launch counts. An
    estimate that may begin later is anchored where ``launched_as``, in the same frame, begins.
    Raises UserError where the truth covers none of the stamps.
    """
    true_poses, covered = _covered(estimate, truth)
    poses = estimate.planar[covered]
    anchored = true_poses[covered]
    anchored[:, :2] += _launch_offset(estimate if launched_as is None else launched_as, truth)
    return PoseErrors(
        stamps_ns=estimate.stamps_ns[covered],
        truth=anchored,
        anchored=_distances(poses, anchored),
        aligned=_distances(align(poses[:, :2], anchored[:, :2]), anchored),
        heading=wrap(poses[:, 2] - anchored[:, 2]),
        left_out=int(np.count_nonzero(~covered)),
    )


def interpolate(
    trajectory: Trajectory, stamps_ns: Stamps
) -> tuple[Array, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Return planar poses (n, 3) at the stamps, and which of them (n,) the trajectory covers.

    Linear in position and unwrapped yaw; not beyond the ends, and not across a silence of more
    than LONGEST_TRUTH_GAP_NS.
    """
    planar = trajectory.planar
    planar[:, 2] = np.unwrap(planar[:, 2])
    # Relative to the first stamp, for a float of today's epoch has only 1e-7 s.
    known = (trajectory.stamps_ns - trajectory.stamps_ns[0]).astype(float)
    wanted = (stamps_ns - trajectory.stamps_ns[0]).astype(float)
    poses = np.column_stack([np.interp(wanted, known, column) for column in planar.T])
    after = np.searchsorted(known, wanted, side="left").clip(0, len(known) - 1)
    before = (np.searchsorted(known, wanted, side="right") - 1).clip(0)
    inside = (wanted >= known[0]) & (wanted <= known[-1])
    return poses, inside & (known[after] - known[before] <= LONGEST_TRUTH_GAP_NS)


def start_end_gap(trajectory: Trajectory) -> float:
    """Return the distance [m] of the last position from the first; the paper's measure in VIII-B.

    It is an error only where the vehicle came back to its start.
    """
    return float(np.linalg.norm(trajectory.planar[-1, :2] - trajectory.planar[0, :2]))


def _covered(
    estimate: Trajectory, truth: Trajectory
) -> tuple[Array, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    true_poses, covered = interpolate(truth, estimate.stamps_ns)
    if not covered.any():
        raise UserError("the ground truth covers no time of the trajectory: compare their stamps")
    return true_poses, covered


def _launch_offset(estimate: Trajectory, truth: Trajectory) -> Array:
    """Return what is added to true positions (2,) [m] to make the first common one agree."""
    true_poses, covered = _covered(estimate, truth)
    first = int(np.argmax(covered))
    return np.asarray(estimate.planar[first, :2] - true_poses[first, :2])


def _distances(first: Array, second: Array) -> Array:
    return np.asarray(np.linalg.norm(first[:, :2] - second[:, :2], axis=1))
