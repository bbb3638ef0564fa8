# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans and keyframes brought together, which come by different ways."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import KeyframeReport, Scan

__all__ = ["brought_together"]


def brought_together(scans: Mapping[int, Scan], reports: Iterable[KeyframeReport]) -> list[Scan]:
    """Return the scans by stamp; those of the keyframes alone are usable, and all there.

    ``scans`` are those that have come, by stamp [ns].
    """
    keyframes = {report.stamp_ns: report for report in reports}
    found = {stamp: _silent_scan(report) for stamp, report in keyframes.items()}
    for stamp, scan in scans.items():
        found[stamp] = _with_use(scan, usable=stamp in keyframes)
    return [found[stamp] for stamp in sorted(found)]


def _with_use(scan: Scan, *, usable: bool) -> Scan:
    return scan if scan.usable == usable else replace(scan, usable=usable)


def _silent_scan(report: KeyframeReport) -> Scan:
    """Return the scan of a keyframe of which only the pose is left: one beam without echoes."""
    reckoned = np.zeros((2, 6))
    reckoned[:, [0, 1, 5]] = report.odometry
    return reckoned_scan(
        beam_stamps_ns=np.array([report.stamp_ns], dtype=np.int64),
        end_stamp_ns=report.stamp_ns,
        reckoned=reckoned,
        twist_covariance=np.zeros((3, 3)),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
    )
