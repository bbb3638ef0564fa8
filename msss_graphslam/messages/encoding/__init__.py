# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Records to messages.

Every function takes ``make(type_name, **fields)`` first, which returns the message; so the classes
of rclpy and those of a bag library both serve. Numbers leave as ``float`` and ``int``, because
rclpy turns a numpy scalar into 0.0 without a word; arrays leave as numpy arrays.
"""

from msss_graphslam.messages.encoding.clouds import map_cloud, occupancy_grid, scan_cloud
from msss_graphslam.messages.encoding.graph import constraint, graph_markers
from msss_graphslam.messages.encoding.links import (
    correction,
    graph_poses,
    moment,
    scan_beams,
    settled_odometry,
    tried,
)
from msss_graphslam.messages.encoding.poses import (
    ground_truth,
    odometry,
    path,
    pose,
    tf_message,
    transform,
)
from msss_graphslam.messages.encoding.primitives import Make, quaternion
from msss_graphslam.messages.encoding.sensors import (
    fluid_pressure,
    imu,
    laser_scan,
    raw_bytes,
    twist,
)

__all__ = [
    "Make",
    "constraint",
    "correction",
    "fluid_pressure",
    "graph_markers",
    "graph_poses",
    "ground_truth",
    "imu",
    "laser_scan",
    "map_cloud",
    "moment",
    "occupancy_grid",
    "odometry",
    "path",
    "pose",
    "quaternion",
    "raw_bytes",
    "scan_beams",
    "scan_cloud",
    "settled_odometry",
    "tf_message",
    "transform",
    "tried",
    "twist",
]
