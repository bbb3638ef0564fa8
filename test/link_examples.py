# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""An example of all that the nodes tell each other, and what builds and reads its message."""

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from made_scans import BEAMS, standing_scan
from synthetic_scans import corridor

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import (
    Constraint,
    ConstraintKind,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Odometry,
    Scan,
    Trajectory,
    TwistError,
)
from msss_graphslam.messages import encoding, link_decoding

CLOUD = "sensor_msgs/msg/PointCloud2"
ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
STAMP = 1_700_000_000_123_456_789
RNG = np.random.default_rng(5)
ERROR = TwistError(RNG.normal(size=3) / 3.0, np.cov(RNG.normal(size=(3, 9))))


def spread(size: int) -> np.ndarray:
    root = RNG.normal(size=(size, size))
    return root @ root.T / 3.0


def entry(stamp_ns: int) -> Odometry:
    return Odometry(stamp_ns, RNG.normal(size=6), spread(6), RNG.normal(size=6), spread(6))


def moving_scan() -> Scan:
    """A scan under way, whose second half of beams has no echo."""
    scan = standing_scan(corridor(), np.zeros(3), np.array([1.0, 2.0, 0.3]), 3, RNG)
    hits = np.flatnonzero(np.diff(scan.beam_index, prepend=-1) > 0)
    hits = hits[scan.beam_index[hits] < BEAMS // 2]
    return reckoned_scan(
        beam_stamps_ns=scan.beam_stamps_ns + STAMP,
        end_stamp_ns=scan.end_stamp_ns + STAMP,
        reckoned=scan.reckoned + np.cumsum(RNG.normal(size=(BEAMS + 1, 6)) * 0.01, axis=0),
        twist_covariance=spread(3) * 1e-3,
        beam_index=scan.beam_index[hits],
        body_points=scan.body_points[hits],
        body_covariances=scan.body_covariances[hits],
        complete=False,
        usable=True,
    )


SETTLED = [entry(STAMP), entry(STAMP + 1), entry(STAMP + 10**10)]
SCAN = moving_scan()
REPORT = KeyframeReport(
    number=7,
    stamp_ns=STAMP,
    pose=RNG.normal(size=3) / 3.0,
    odometry=RNG.normal(size=3) / 3.0,
    twist_error=ERROR,
    constraints=(
        Constraint(ConstraintKind.CONSECUTIVE, 6, 7, RNG.normal(size=3), spread(3)),
        Constraint(
            ConstraintKind.LOOP, 0, 7, RNG.normal(size=3), spread(3), "too_far", {"shift": 1 / 3}
        ),
    ),
)
GRAPH = GraphPoses(
    stamps_ns=STAMP + np.arange(4) * 10**10,
    poses=RNG.normal(size=(4, 3)),
    odometry=RNG.normal(size=(4, 3)),
    covariances=np.array([spread(3) for _ in range(4)]),
)
CORRECTION = MapCorrection(STAMP, np.array([1 / 3, -2.0, 3.1]), spread(3), ERROR)
POSE = np.array([1 / 3, -2.0, 0.5, 0.1, -0.2, 3.0])
TRACK = Trajectory(STAMP + np.arange(3) * 10**9, np.array([POSE * 0.0, POSE * 0.5, POSE]))

Make = Callable[..., Any]
MESSAGES: dict[str, tuple[Callable[[Make], Any], str, Callable[[Any], Any]]] = {
    "settled": (
        lambda maker: encoding.settled_odometry(maker, STAMP + 7, SETTLED),
        CLOUD,
        link_decoding.settled_odometry,
    ),
    "scan": (lambda maker: encoding.scan_beams(maker, SCAN), CLOUD, link_decoding.scan_beams),
    "tried": (lambda maker: encoding.tried(maker, REPORT), ARRAY, link_decoding.tried),
    "graph": (lambda maker: encoding.graph_poses(maker, GRAPH), CLOUD, link_decoding.graph_poses),
    "correction": (
        lambda maker: encoding.correction(maker, CORRECTION),
        "nav_msgs/msg/Odometry",
        link_decoding.correction,
    ),
    "pose": (
        lambda maker: encoding.pose(maker, STAMP, POSE, spread(6)),
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        link_decoding.stamped_pose,
    ),
    "path": (
        lambda maker: encoding.path(maker, TRACK),
        "nav_msgs/msg/Path",
        link_decoding.last_pose,
    ),
    "whole path": (
        lambda maker: encoding.path(maker, TRACK),
        "nav_msgs/msg/Path",
        link_decoding.path_poses,
    ),
}


def leaves(record: Any) -> Iterator[Any]:
    """Yield all that a record is made of."""
    if is_dataclass(record):
        for field in fields(record):
            yield from leaves(getattr(record, field.name))
    elif isinstance(record, tuple | list):
        for one in record:
            yield from leaves(one)
    elif isinstance(record, dict):
        yield from leaves(list(record.items()))
    else:
        yield record
