# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A scan between two keyframes, and how its points move when either of them does."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import between, compose, rotation, transform_points
from msss_graphslam.core.line_features import LineFeatures, line_features
from msss_graphslam.core.scan_generation import lay_out
from msss_graphslam.core.trajectory_correction import closed_form, correct_motion
from msss_graphslam.core.types import Array, Scan

__all__ = ["BentScan", "bend", "reckoned_ends"]

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@dataclass(frozen=True, slots=True)
class BentScan:
    """A scan laid out so that it starts at its own keyframe and ends at the next.

    ``start`` (3,) is the keyframe in ``map``; ``lines`` are its local lines in that frame, None
    with too few points; ``normals`` (n, 2), ``centres`` (n, 2), ``points`` (n, 2) and their
    ``covariances`` (n, 2, 2) the same in ``map``, the sonar's noise alone; ``beams`` (b, 2) the
    vehicle's places in ``map`` and ``beam_index`` (n,) the beam of each point. ``by_keyframes``
    (b, 3, 6) derives the vehicle's pose at each beam by the two keyframes.
    ``twist`` (3,) is what has to be added to the reckoned surge, sway [m/s] and yaw rate [rad/s]
    for all this, ``twist_by_keyframes`` (3, 6) its derivative, ``duration`` [s] the scan's.
    """

    start: Array
    lines: LineFeatures | None
    normals: Array
    centres: Array
    points: Array
    covariances: Array
    beams: Array
    beam_index: NDArray[np.intp]
    by_keyframes: Array
    twist: Array
    twist_by_keyframes: Array
    duration: float


def reckoned_ends(scans: Sequence[Scan]) -> list[Array]:
    """Return the next keyframe (3,) by dead reckoning in each scan, at last the end."""
    ends = [scan.odometry for scan in scans[1:]]
    ends += [scan.reckoned[-1, [0, 1, 5]] for scan in scans[-1:]]
    return [between(scan.odometry, end) for scan, end in zip(scans, ends, strict=True)]


def bend(scan: Scan, reckoned_end: Array, start: Array, end: Array, duration: float) -> BentScan:
    """Lay out a scan between the keyframes ``start`` and ``end`` (3,) in ``map``.

    ``reckoned_end`` (3,) is where dead reckoning has the end in the scan's frame, ``duration``
    [s] later. The correction is that of equation 14, the same at every beam.
    """
    relative = between(start, end)
    correction = correct_motion(scan.motion, reckoned_end, relative, closed_form)
    laid_out = lay_out(scan, correction.poses, np.zeros((3, 3)))
    lines = line_features(laid_out.points, laid_out.covariances)
    by_twist = _by_twist(np.vstack([correction.poses, relative]), duration)
    by_relative = np.linalg.inv(by_twist[-1])
    turn = rotation(start[2])
    relative_by_keyframes = _relative_by_keyframes(relative, turn)
    no_points = np.empty((0, 2))
    return BentScan(
        start=start,
        lines=lines,
        normals=lines.normals @ turn.T if lines else no_points,
        centres=transform_points(start, lines.centres) if lines else no_points,
        points=transform_points(start, laid_out.points),
        covariances=turn @ laid_out.covariances @ turn.T,
        beams=compose(start, correction.poses)[:, :2],
        beam_index=scan.beam_index,
        by_keyframes=_by_keyframes(
            correction.poses, turn, by_twist[:-1] @ by_relative @ relative_by_keyframes
        ),
        twist=correction.delta * len(scan.motion) / duration,
        twist_by_keyframes=by_relative @ relative_by_keyframes,
        duration=duration,
    )


def _by_twist(motion: Array, duration: float) -> Array:
    """Return the derivatives (n, 3, 3) of the motion (n, 3) by a constant twist error.

    Equation 14 gives every step between beams the same share, whatever time it takes.
    """
    elapsed = np.linspace(0.0, duration, len(motion))
    steps = np.diff(motion, axis=0, prepend=motion[:1])
    derivative = np.zeros((len(motion), 3, 3))
    share = np.where(elapsed > 0.0, duration / (len(motion) - 1), 0.0)
    derivative[:, :2, :2] = np.cumsum(rotation(motion[:, 2]) * share[:, None, None], axis=0)
    derivative[:, 0, 2] = np.cumsum(-steps[:, 1] * elapsed)
    derivative[:, 1, 2] = np.cumsum(steps[:, 0] * elapsed)
    derivative[:, 2, 2] = elapsed
    return derivative


def _relative_by_keyframes(relative: Array, turn: Array) -> Array:
    """Return the derivative (3, 6) of the end in the start's frame by both in ``map``."""
    derivative = np.zeros((3, 6))
    derivative[:2, :2] = -turn.T
    derivative[:2, 2] = -QUARTER_TURN @ relative[:2]
    derivative[2, 2] = -1.0
    derivative[:2, 3:5] = turn.T
    derivative[2, 5] = 1.0
    return derivative


def _by_keyframes(motion: Array, turn: Array, motion_by_keyframes: Array) -> Array:
    """Return the derivatives (b, 3, 6) of the beams' poses in ``map`` by both keyframes."""
    derivative = motion_by_keyframes.copy()
    derivative[:, :2] = turn @ motion_by_keyframes[:, :2]
    derivative[:, range(3), range(3)] += 1.0
    derivative[:, :2, 2] += motion[:, :2] @ turn.T @ QUARTER_TURN.T
    return derivative
