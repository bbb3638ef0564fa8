# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The Tritech Micron DST head: packets, beams, session and transports; without ROS."""
