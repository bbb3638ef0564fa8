# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""ROS messages to records and back, by field names alone: serves rclpy and bags alike."""

from msss_graphslam.messages.refusal import Refusal

__all__ = ["Refusal"]
