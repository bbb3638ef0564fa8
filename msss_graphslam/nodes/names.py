# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The names of the nodes, and the order in which data goes through them. No ROS."""

__all__ = ["AWAITED", "DRIVER", "FED", "RECORDER", "REPLAY", "SLAM_NODES", "WORKING_ORDER"]

DRIVER = "micron_driver"
"""Runs only where a head, or its recorded bytes, is the source of beams."""

FED = ("dead_reckoning", "scan_generation")
"""The nodes that sensors, or a replay in their place, feed."""

AWAITED = (*FED, "back_end")
"""The nodes that would miss the beginning of a replay; the back end's part is the poses."""

SLAM_NODES = (*FED, "front_end", "back_end")
"""The nodes of every run, in the order in which data goes through them."""

WORKING_ORDER = (DRIVER, *SLAM_NODES)
"""All nodes that hold data at the end, in the order in which they have to work it off."""

REPLAY = "bag_replay"
RECORDER = "bag_recorder"
