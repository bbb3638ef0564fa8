# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the last scan of a mission has come: scan generation says which one that is. No ROS."""

__all__ = ["LastScan"]


class LastScan:
    """Compares the scans that have come with the one that was told to be the last."""

    def __init__(self) -> None:
        self._newest_ns = 0
        self._told_ns: int | None = None

    def came(self, stamp_ns: int) -> None:
        """Note a scan; what was told before a newer one is outdated."""
        self._newest_ns = max(self._newest_ns, stamp_ns)
        if self._told_ns is not None and self._told_ns < stamp_ns:
            self._told_ns = None

    def told(self, stamp_ns: int) -> None:
        """Note which scan is the last, 0 where there is none."""
        self._told_ns = stamp_ns

    def take(self) -> bool:
        """Return whether it has come; the next time it has to be told anew."""
        if self._told_ns is None or self._told_ns > self._newest_ns:
            return False
        self._told_ns = None
        return True
