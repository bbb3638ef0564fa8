# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other back to records; what cannot be used raises Refusal.

No bytes of a message can make a record with a number that is not finite.
"""

from msss_graphslam.messages.link_decoding.clouds import (
    SettledOdometry,
    graph_poses,
    scan_beams,
    settled_odometry,
)
from msss_graphslam.messages.link_decoding.poses import (
    StampedPose,
    correction,
    last_pose,
    moment,
    path_poses,
    stamped_pose,
)
from msss_graphslam.messages.link_decoding.reports import tried

__all__ = [
    "SettledOdometry",
    "StampedPose",
    "correction",
    "graph_poses",
    "last_pose",
    "moment",
    "path_poses",
    "scan_beams",
    "settled_odometry",
    "stamped_pose",
    "tried",
]
