# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Point clouds of odometry, beams and keyframes to records."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import GraphPoses, Odometry, Scan
from msss_graphslam.messages.columns import BEAMS, POSES, SETTLED, read_columns, read_stamps
from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.messages.refusal import Refusal

__all__ = ["SettledOdometry", "graph_poses", "scan_beams", "settled_odometry"]


@dataclass(frozen=True, slots=True)
class SettledOdometry:
    """Dead reckoning that stays as it is: ``entries`` in order of their stamps.

    ``stamp_ns`` is how far dead reckoning has taken its input.
    """

    stamp_ns: int
    entries: tuple[Odometry, ...]


def settled_odometry(message: Any) -> SettledOdometry:
    """Return the entries of ``encoding.settled_odometry``."""
    name = "settled_odometry"
    rows = read_columns(message, SETTLED, name)
    stamps = read_stamps(rows, name)
    if (np.diff(stamps) <= 0).any():
        raise Refusal("settled_odometry_stamps_not_increasing")
    columns = zip(
        stamps.tolist(),
        rows["pose"].copy(),
        rows["covariance"].reshape(-1, 6, 6),
        rows["twist"].copy(),
        rows["twist_covariance"].reshape(-1, 6, 6),
        strict=True,
    )
    return SettledOdometry(stamp_of(message, name), tuple(Odometry(*row) for row in columns))


def scan_beams(message: Any) -> Scan:
    """Return the scan of ``encoding.scan_beams``, laid out by dead reckoning."""
    rows = read_columns(message, BEAMS, "scan_beams")
    stamps = read_stamps(rows, "scan_beams")
    if len(rows) < 2:
        raise Refusal("scan_beams_without_beams")
    beams_ns, end_ns = stamps[:-1], int(stamps[-1])
    if (np.diff(beams_ns) <= 0).any() or end_ns < beams_ns[-1]:
        raise Refusal("scan_beams_stamps_not_increasing")
    if stamp_of(message, "scan_beams") != beams_ns[0]:
        raise Refusal("scan_beams_stamp_differs")
    hits = np.flatnonzero(rows["echo"][:-1])
    with np.errstate(all="ignore"):  # what overflows is refused
        scan = reckoned_scan(
            beam_stamps_ns=beams_ns,
            end_stamp_ns=end_ns,
            reckoned=rows["reckoned"].copy(),
            twist_covariance=rows["twist_covariance"][0].reshape(3, 3).copy(),
            beam_index=hits,
            body_points=rows["body_point"][hits],
            body_covariances=rows["body_covariance"][hits].reshape(-1, 2, 2),
            complete=bool(rows["complete"][0]),
            usable=bool(rows["usable"][0]),
        )
    laid_out = (scan.motion, scan.motion_covariances, scan.points, scan.covariances)
    if not all(np.isfinite(values).all() for values in laid_out):
        raise Refusal("scan_beams_not_finite")
    return scan


def graph_poses(message: Any) -> GraphPoses:
    """Return the keyframes of ``encoding.graph_poses``."""
    rows = read_columns(message, POSES, "graph_poses")
    stamps = read_stamps(rows, "graph_poses")
    if (np.diff(stamps) <= 0).any():
        raise Refusal("graph_poses_stamps_not_increasing")
    return GraphPoses(
        stamps_ns=stamps,
        poses=rows["pose"].copy(),
        odometry=rows["odometry"].copy(),
        covariances=rows["covariance"].reshape(-1, 3, 3),
    )
