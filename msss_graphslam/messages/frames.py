# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The names of the frames (REP-105)."""

__all__ = ["BASE_LINK", "IMU_LINK", "MAP", "ODOM", "SONAR_LINK"]

MAP = "map"
ODOM = "odom"
BASE_LINK = "base_link"
SONAR_LINK = "sonar_link"
IMU_LINK = "imu_link"
