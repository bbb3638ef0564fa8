# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which scans the graph has not worked off yet. No ROS."""

from msss_graphslam.core.types import Scan

__all__ = ["Backlog"]

_MOST = 2


class Backlog:
    """Keeps a replay beside the front end, so that ``pose`` is what it would be on the vehicle."""

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._waiting: list[int] = []

    def restart(self) -> None:
        """Forget every scan, also those that no correction will come for."""
        self._waiting = []

    def scanned(self, scan: Scan) -> None:
        """Note a scan; one that is not usable makes no keyframe."""
        if scan.usable:
            self._waiting.append(scan.stamp_ns)

    def corrected(self, stamp_ns: int) -> None:
        """Note a correction, which stands at the end of its scan."""
        self._waiting = [waiting for waiting in self._waiting if waiting >= stamp_ns]

    @property
    def is_too_long(self) -> bool:
        """Whether the replay has to wait."""
        return len(self._waiting) > self._most
