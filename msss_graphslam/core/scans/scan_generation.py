# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scan generation: the readings of a turn in one frame, Algorithm 2."""

from dataclasses import replace
from typing import Any

import numpy as np

from msss_graphslam.config.groups import Sonar
from msss_graphslam.core.compounding import between, rotation, transform_points
from msss_graphslam.core.reckoning.attitude import level
from msss_graphslam.core.scans.history import DeadReckoningHistory, Turn
from msss_graphslam.core.types import Array, Odometry, Reading, Scan

__all__ = [
    "generate_scan",
    "lay_out",
    "motion_covariances",
    "motion_derivatives",
    "reckoned_motion",
    "reckoned_scan",
]


def generate_scan(turn: Turn[Reading], history: DeadReckoningHistory, sonar: Sonar) -> Scan:
    """Algorithm 2: the turn's points in the frame {I} of the vehicle at its first beam.

    The history has to cover ``turn.end_ns``. Beams without a range support the motion only, and so
    do all beams of a turn that is not usable.
    """
    stamps = np.array([reading.stamp_ns for reading in turn.readings], dtype=np.int64)
    reckoned = history.poses_at(np.append(stamps, turn.end_ns))
    hits = np.array(
        [i for i, r in enumerate(turn.readings) if r.ranges.size and turn.usable], dtype=np.intp
    )
    ranges = np.array([turn.readings[i].ranges[0] for i in hits])
    variances = np.array([turn.readings[i].variances[0] for i in hits])
    bearings = np.array([turn.readings[i].bearing for i in hits]) + sonar.mount_yaw
    return reckoned_scan(
        beam_stamps_ns=stamps,
        end_stamp_ns=turn.end_ns,
        reckoned=reckoned,
        twist_covariance=twist_error(history.at(int(stamps[0]))),
        beam_index=hits,
        body_points=_body_points(ranges, bearings, reckoned[hits], sonar),
        body_covariances=_polar_covariances(ranges, variances, bearings, sonar.beam_width),
        complete=turn.complete,
        usable=turn.usable,
    )


def reckoned_scan(
    *, reckoned: Array, body_points: Array, body_covariances: Array, **measured: Any
) -> Scan:
    """Return the scan of what was measured, laid out by dead reckoning; fields as in Scan."""
    scan = Scan(
        reckoned=reckoned,
        body_points=body_points,
        body_covariances=body_covariances,
        motion=reckoned_motion(reckoned)[:-1],
        motion_covariances=np.empty((0, 3, 3)),
        points=body_points,
        covariances=body_covariances,
        **measured,
    )
    return lay_out(scan, scan.motion, scan.twist_covariance)


def reckoned_motion(reckoned: Array) -> Array:
    """Return the planar motion (n, 3) since the first of the poses (n, 6)."""
    planar = reckoned[:, [0, 1, 5]]
    return between(planar[0], planar)


def lay_out(scan: Scan, motion: Array, twist_covariance: Array) -> Scan:
    """Return the scan made anew with another motion (b, 3) and its slow error's covariance."""
    covariances = motion_covariances(motion, scan.beam_times[:-1], twist_covariance)
    at_hits = motion[scan.beam_index]
    points = transform_points(at_hits, scan.body_points)  # Algorithm 2, line 6
    to_scan = rotation(at_hits[:, 2])
    lever = points - at_hits[:, :2]
    jacobian = np.zeros((len(points), 2, 3))
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1.0
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -lever[:, 1], lever[:, 0]
    spread = (  # Algorithm 2, line 7
        to_scan @ scan.body_covariances @ np.swapaxes(to_scan, -1, -2)
        + jacobian @ covariances[scan.beam_index] @ np.swapaxes(jacobian, -1, -2)
    )
    return replace(
        scan, motion=motion, motion_covariances=covariances, points=points, covariances=spread
    )


def motion_covariances(motion: Array, elapsed: Array, twist_covariance: Array) -> Array:
    """Return the covariances (b, 3, 3) of the motion (b, 3) since its first pose.

    ``elapsed`` (b,) are the times since then [s]; ``twist_covariance`` (3, 3) is that of an error
    of surge, sway [m/s] and yaw rate [rad/s].
    """
    # Deviation: the paper's line 7 adds the global covariances of both poses as if independent.
    # Within a turn their error is one slowly changing velocity error, integrated.
    derivative = motion_derivatives(motion, elapsed)
    return np.asarray(derivative @ twist_covariance @ np.swapaxes(derivative, -1, -2))


def motion_derivatives(motion: Array, elapsed: Array) -> Array:
    """Return the derivatives (b, 3, 3) of the motion (b, 3) by a constant twist error.

    ``elapsed`` (b,) are the times since the first pose [s].
    """
    steps = np.diff(motion, axis=0, prepend=motion[:1])
    durations = np.diff(elapsed, prepend=0.0)
    derivative = np.zeros((len(motion), 3, 3))
    derivative[:, :2, :2] = np.cumsum(rotation(motion[:, 2]) * durations[:, None, None], axis=0)
    derivative[:, 0, 2] = np.cumsum(-steps[:, 1] * elapsed)
    derivative[:, 1, 2] = np.cumsum(steps[:, 0] * elapsed)
    derivative[:, 2, 2] = elapsed
    return derivative


def twist_error(odometry: Odometry) -> Array:
    """Return the covariance (3, 3) of the error of surge, sway and yaw rate."""
    planar = [0, 1, 5]
    return np.asarray(odometry.twist_covariance[np.ix_(planar, planar)])


def _body_points(ranges: Array, bearings: Array, poses: Array, sonar: Sonar) -> Array:
    """T_R^S (+) P2C(rho), levelled by the vehicle's roll and pitch: (n, 2)."""
    points = np.column_stack(
        [
            sonar.mount_x + ranges * np.cos(bearings),
            sonar.mount_y + ranges * np.sin(bearings),
            np.zeros(len(ranges)),
        ]
    )
    return level(poses[:, 3], poses[:, 4], points)[:, :2]


def _polar_covariances(
    ranges: Array, variances: Array, bearings: Array, beam_width: float
) -> Array:
    """Return the covariances (n, 2, 2) of points measured in polar coordinates."""
    polar = np.zeros((len(ranges), 2, 2))
    polar[:, 0, 0] = variances
    polar[:, 1, 1] = (ranges * beam_width) ** 2 / 12.0
    turned = rotation(bearings)
    return np.asarray(turned @ polar @ np.swapaxes(turned, -1, -2))
