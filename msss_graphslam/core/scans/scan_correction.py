# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans made anew from the corrected trajectory, Section VII."""

from collections.abc import Sequence

import numpy as np

from msss_graphslam.core.compounding import between
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.scan_generation import lay_out, motion_derivatives
from msss_graphslam.core.scans.trajectory_correction import Solver, correct_motion
from msss_graphslam.core.types import Array, Scan, TwistError

__all__ = ["correct_scan", "corrected_scan", "corrected_scans"]


def correct_scan(
    scan: Scan, following: Scan, target: Array, solver: Solver, twist_covariance: Array
) -> tuple[Scan, Array]:
    """Return the scan made anew so that the following keyframe is met, and delta X (3,).

    ``target`` (3,) is the following keyframe in the scan's; both scans are as dead reckoning laid
    them out. ``twist_covariance`` (3, 3) is that of the motion's remaining slow error.
    """
    end = between(scan.odometry, following.odometry)
    correction = correct_motion(scan.motion, end, target, solver)
    return lay_out(scan, correction.poses, twist_covariance), correction.delta


def corrected_scans(
    scans: Sequence[Scan], poses: Array, solver: Solver, known: TwistError | None
) -> list[Scan]:
    """Return all scans, as dead reckoning laid them out, made anew by the poses (n, 3)."""
    rows = list(zip(scans, poses, strict=True))
    return [corrected_scan(number, scans, poses, solver, known) for number, _ in enumerate(rows)]


def corrected_scan(
    number: int,
    scans: Sequence[Scan],
    poses: Array,
    solver: Solver,
    known: TwistError | None,
    spread: Array | None = None,
) -> Scan:
    """Return one of the scans made anew by the poses (n, 3).

    Its motion's error stays as uncertain as dead reckoning says, unless ``spread`` (3, 3) says how
    well the displacement of the following keyframe is known. The last scan, which no keyframe
    follows, has the twist error taken out that is known by then.
    """
    scan = scans[number]
    if number == len(scans) - 1:
        return _with_twist_error(scan, known)
    error = scan.twist_covariance if spread is None else _remaining_error(scan, spread)
    target = between(poses[number], poses[number + 1])
    return correct_scan(scan, scans[number + 1], target, solver, error)[0]


def _remaining_error(scan: Scan, spread: Array) -> Array:
    """Return the twist error's covariance (3, 3) of a scan that ends as well known as ``spread``.

    Where dead reckoning knows the way better, it is what dead reckoning says.
    """
    end = motion_derivatives(scan.motion, scan.beam_times[:-1])[-1]
    reckoned = end @ scan.twist_covariance @ end.T
    if np.trace(spread[:2, :2]) >= np.trace(reckoned[:2, :2]):
        return scan.twist_covariance
    # A vehicle that spins round once comes back to where it was, whatever its speed.
    by_end = np.linalg.pinv(end)
    return np.asarray(by_end @ spread @ by_end.T)


def _with_twist_error(scan: Scan, known: TwistError | None) -> Scan:
    if known is None:
        return scan
    motion = offset_motion(scan.motion, scan.beam_times[:-1], known.mean)
    return lay_out(scan, motion, known.covariance)
