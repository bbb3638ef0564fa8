# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether two runs of dead reckoning said the same."""

from collections.abc import Sequence

from msss_graphslam.core.types import Odometry


def said(odometry: Sequence[Odometry]) -> list[bytes]:
    """Every number of the odometry, to be compared bit by bit."""
    return [
        entry.stamp_ns.to_bytes(8)
        + entry.pose.tobytes()
        + entry.covariance.tobytes()
        + entry.twist.tobytes()
        + entry.twist_covariance.tobytes()
        for entry in odometry
    ]
