# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans as scan generation makes them, of a synthetic sonar on a vehicle in known motion."""

from collections.abc import Sequence

import numpy as np
from synthetic_scans import scan as see

from msss_graphslam.core.scans.scan_generation import lay_out
from msss_graphslam.core.types import Array, Scan

TURN_NS = 10_000_000_000
BEAMS = 240


def standing_scan(
    walls: Sequence[Array],
    truth: Array,
    odometry: Array,
    number: int,
    rng: np.random.Generator,
    twist_deviation: float = 0.01,
) -> Scan:
    """A scan from a vehicle at rest at ``truth`` (3,), reckoned to be at ``odometry`` (3,)."""
    points, covariances = see(list(walls), truth, rng, outliers=0.0)
    start = number * TURN_NS
    stamps = start + TURN_NS // BEAMS * np.arange(BEAMS, dtype=np.int64)
    reckoned = np.zeros((BEAMS + 1, 6))
    reckoned[:, [0, 1, 5]] = odometry
    reckoned[:, 2] = -2.0
    scan = Scan(
        end_stamp_ns=start + TURN_NS,
        beam_stamps_ns=stamps,
        motion=np.zeros((BEAMS, 3)),
        motion_covariances=np.zeros((BEAMS, 3, 3)),
        reckoned=reckoned,
        beam_index=np.arange(len(points)),
        body_points=points,
        body_covariances=covariances,
        points=points,
        covariances=covariances,
        twist_covariance=np.diag([twist_deviation, twist_deviation, 1e-3]) ** 2,
    )
    return lay_out(scan, scan.motion, scan.twist_covariance)
