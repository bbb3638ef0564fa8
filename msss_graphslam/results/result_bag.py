# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""result.mcap: the output topics of a run, to be looked at in Foxglove or RViz.

What stands for the whole run (graph, paths, maps) comes first and holds the final result. The
moving topics follow in the order of time, at most five a second.
"""

import heapq
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from msss_graphslam.core.compounding import (
    carried_over,
    compose,
    compose_covariance,
    inverse,
    wrap,
)
from msss_graphslam.core.types import Array, Estimate, Keyframe, Stamps, Trajectory
from msss_graphslam.messages import encoding
from msss_graphslam.messages.encoding import batches, serialised
from msss_graphslam.messages.topics import OUTPUTS
from msss_graphslam.recordings.typestore import make
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.results.record import RunRecord

__all__ = ["write_result_bag"]

_SHORTEST_PERIOD_NS = 200_000_000
_PLANAR = [0, 1, 5]

_TYPES = {topic.absolute: topic.type_name for topic in OUTPUTS}

_Message = tuple[int, str, Any]
"""Stamp [ns], topic, message or its bytes."""


def write_result_bag(path: Path, record: RunRecord) -> None:
    """Write the bag; its bytes depend on the record alone."""
    estimate = record.estimate
    streams = (_standing(record), _moving(estimate), _scans(record))
    with BagWriter(path) as bag:
        for stamp, topic, message in heapq.merge(*streams, key=lambda entry: entry[0]):
            if isinstance(message, bytes):
                bag.write_raw(topic, _TYPES[topic], message, stamp, stamp)
            else:
                bag.write(topic, message, stamp)


def _standing(record: RunRecord) -> Iterator[_Message]:
    estimate, grid = record.estimate, record.grid
    start = int(estimate.trajectory.stamps_ns[0])
    keyframes = record.keyframe_trajectory
    yield start, "/graph/keyframes", serialised.path(keyframes)
    markers = serialised.graph_markers(start, keyframes.planar, estimate.constraints)
    yield start, "/graph/markers", markers
    yield start, "/path", serialised.path(_thinned(estimate.trajectory))
    dead_reckoning = serialised.path(_thinned(estimate.dead_reckoning), "odom")
    yield start, "/path/dead_reckoning", dead_reckoning
    yield start, "/map/points", encoding.map_cloud(make, start, record.points)
    cells = encoding.occupancy_grid(make, start, grid.occupancy, grid.resolution, grid.origin)
    yield start, "/map", cells


def _moving(estimate: Estimate) -> Iterator[_Message]:
    """Yield dead reckoning, the corrected pose where its covariance is known, and both frames."""
    rows = _thinned_rows(estimate.trajectory.stamps_ns)
    stamps, corrected = estimate.trajectory.stamps_ns[rows], estimate.trajectory.poses[rows]
    reckoned = Trajectory(stamps, estimate.dead_reckoning.poses[rows])
    odometry = batches.odometries(reckoned, _twists(estimate.dead_reckoning)[rows])
    odom_in_map = carried_over(corrected, reckoned.poses)
    frames = [(odom_in_map, "map", "odom"), (reckoned.poses, "odom", "base_link")]
    poses = _known_poses(Trajectory(stamps, corrected), estimate.keyframes)
    moved = zip(stamps.tolist(), odometry, batches.transforms(stamps, frames), strict=True)
    for stamp, odom, transforms in moved:
        yield stamp, "/odom", odom
        if stamp in poses:
            yield stamp, "/pose", poses[stamp]
        yield stamp, "/tf", transforms


def _known_poses(corrected: Trajectory, keyframes: Sequence[Keyframe]) -> dict[int, bytes]:
    """Return the corrected pose by stamp, as a message, where its covariance is known."""
    covariances = _beam_covariances(keyframes)
    stamps = corrected.stamps_ns.tolist()
    rows = [row for row, stamp in enumerate(stamps) if stamp in covariances]
    known = Trajectory(corrected.stamps_ns[rows], corrected.poses[rows])
    spread = np.array([covariances[stamps[row]] for row in rows]).reshape(-1, 3, 3)
    messages = batches.planar_poses(known, spread)
    return dict(zip(known.stamps_ns.tolist(), messages, strict=True))


def _scans(record: RunRecord) -> Iterator[_Message]:
    """Yield each scan when it was whole, in its keyframe's frame, and the edges that end there."""
    poses, edges = record.keyframe_trajectory.poses, defaultdict(list)
    for edge in record.estimate.constraints:
        if edge.accepted:
            edges[edge.second].append(edge)
    for number, keyframe in enumerate(record.estimate.keyframes):
        scan, frame = keyframe.scan, f"keyframe_{number}"
        placement = encoding.transform(make, scan.stamp_ns, poses[number], "map", frame)
        yield scan.end_stamp_ns, "/tf", encoding.tf_message(make, [placement])
        yield scan.end_stamp_ns, "/scan", encoding.scan_cloud(make, scan, frame)
        for edge in edges[number]:
            message = encoding.constraint(make, scan.stamp_ns, edge)
            yield scan.end_stamp_ns, "/graph/constraints", message


def _beam_covariances(keyframes: Sequence[Keyframe]) -> dict[int, Array]:
    """Return the covariance (3, 3) of the corrected pose by stamp, for the beams of the scans."""
    covariances: dict[int, Array] = {}
    for keyframe in keyframes:
        scan = keyframe.scan
        spread = compose_covariance(
            keyframe.pose, keyframe.covariance, scan.motion, scan.motion_covariances
        )
        covariances.update(zip(scan.beam_stamps_ns.tolist(), spread, strict=True))
    return covariances


def _twists(trajectory: Trajectory) -> Array:
    """Return the velocity (n, 6) in the body from pose to pose; only surge, sway and yaw rate."""
    planar, twists = trajectory.planar, np.zeros((len(trajectory.poses), 6))
    if len(planar) > 1:
        seconds = np.diff(trajectory.stamps_ns)[:, None] * 1e-9
        steps = compose(inverse(planar[:-1]), planar[1:])
        steps[:, 2] = wrap(steps[:, 2])
        twists[1:, _PLANAR] = steps / seconds
    return twists


def _thinned(trajectory: Trajectory) -> Trajectory:
    rows = _thinned_rows(trajectory.stamps_ns)
    return Trajectory(trajectory.stamps_ns[rows], trajectory.poses[rows])


def _thinned_rows(stamps_ns: Stamps) -> list[int]:
    """Return the rows that are at least the shortest period apart, and the last."""
    rows, last = [], None
    for row, stamp in enumerate(stamps_ns.tolist()):
        if last is None or stamp - last >= _SHORTEST_PERIOD_NS or row == len(stamps_ns) - 1:
            rows.append(row)
            last = stamp
    return rows
