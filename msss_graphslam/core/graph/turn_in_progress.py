# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the vehicle is, by the part of a turn that has been heard so far."""

# Deviation: the paper corrects the pose with whole scans alone. A vehicle whose speed wanders is
# then reckoned on for one and a half turns. A part of a turn shows by how much it is off: its
# beams meet the walls that the last turn met there. The graph does not know of it.

from dataclasses import replace

import numpy as np

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import compose, compose_covariance, wrap
from msss_graphslam.core.graph.graph_construction import consecutive_constraint
from msss_graphslam.core.graph.keyframes import Node
from msss_graphslam.core.graph.scan_layout import ReckonedStep, ScanLayout
from msss_graphslam.core.matching.matchers import ScanMatcher
from msss_graphslam.core.types import Array, Constraint, MapCorrection, Scan

__all__ = ["facing", "lenient", "previewed"]

PAIRED = 0.5
"""A part is matched by a smaller share of paired points than a scan, times this.

At both its ends points have no partners, and a false match moves the pose alone, until the turn is
whole. What little a match with few pairs says is in its covariance.
"""


def lenient(config: Matching) -> Matching:
    """Return how parts are matched, ``config`` being how whole scans are."""
    return replace(config, overlap=PAIRED * config.overlap)


def previewed(
    part: Scan, newest: Node, pose: Array, layout: ScanLayout, matcher: ScanMatcher
) -> MapCorrection | None:
    """Return where the vehicle was in the middle of ``part``, the turn that follows ``newest``.

    ``pose`` (3,) is that of the newest keyframe. None where the part cannot be matched with it,
    or is of a turn that has been taken. What is given stays as it is.
    """
    previous = newest.first_scan
    if part.stamp_ns <= previous.stamp_ns:
        return None
    ahead = layout.apart()
    ahead.pass_by(previous, part)
    step = ahead.step(previous, part)
    current = ahead.node(part, newest.covariance)
    seen = facing(newest.scan, current.scan, float(step.relative_pose[2]))
    nodes = [replace(newest, scan=seen, prepared=matcher.prepare(seen)), current]
    match = consecutive_constraint(nodes, step.relative_pose, step.covariance, matcher)
    if not match.accepted:
        return None
    ahead.learn_twist(previous, part, match)
    relative, spread = _fused(step, ahead.widened(match))
    current.covariance = compose_covariance(pose, newest.covariance, relative, spread)
    return ahead.correction(current, compose(pose, relative))


def facing(reference: Scan, part: Scan, turned: float) -> Scan:
    """Return the reference with those of its points alone that lie where the part looked.

    ``turned`` [rad] is the part's heading in the reference. All others have no partners, and would
    make the two scans look unlike each other.
    """
    looked = np.unwrap(_directions(part)) + turned
    if not looked.size:
        looked = np.zeros(1)
    centre, half = 0.5 * (looked.max() + looked.min()), 0.5 * (looked.max() - looked.min())
    kept = np.abs(wrap(_directions(reference) - centre)) <= half
    return replace(
        reference,
        beam_index=reference.beam_index[kept],
        body_points=reference.body_points[kept],
        body_covariances=reference.body_covariances[kept],
        points=reference.points[kept],
        covariances=reference.covariances[kept],
    )


def _directions(scan: Scan) -> Array:
    """Return where each point (n,) was seen from the vehicle, in the scan's frame [rad]."""
    seen = scan.points - scan.motion[scan.beam_index, :2]
    return np.asarray(np.arctan2(seen[:, 1], seen[:, 0]))


def _fused(step: ReckonedStep, match: Constraint) -> tuple[Array, Array]:
    """Return the pose (3,) and covariance (3, 3) that reckoning and match make together.

    Along a bare wall the match says nothing, and dead reckoning stands.
    """
    off = match.relative_pose - step.relative_pose
    off[2] = wrap(off[2])
    gain = step.edge_covariance @ np.linalg.inv(step.edge_covariance + match.covariance)
    spread = (np.eye(3) - gain) @ step.edge_covariance
    return step.relative_pose + gain @ off, 0.5 * (spread + spread.T)
