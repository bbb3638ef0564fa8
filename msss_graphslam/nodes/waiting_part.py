# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The part of the turn in progress until everything before it is worked off."""

from msss_graphslam.core.types import Scan

__all__ = ["WaitingPart"]


class WaitingPart:
    """Keeps the newest part of a turn; scans and parts may come in any order."""

    def __init__(self) -> None:
        self._part: Scan | None = None
        self._ended_ns = self._heard_ns = -(2**62)

    def add(self, part: Scan) -> None:
        """Keep the part, in place of an earlier one; what was kept before is left out."""
        if part.end_stamp_ns > self._heard_ns:
            self._part, self._heard_ns = part, part.end_stamp_ns

    def follow(self, scan: Scan) -> None:
        """Note the newest whole turn."""
        self._ended_ns = scan.end_stamp_ns

    def take(self) -> Scan | None:
        """Return the part, once, if it begins where the newest turn ends.

        One that is of that turn or an earlier one is dropped; any other goes on waiting.
        """
        part = self._part
        if part is None or part.stamp_ns > self._ended_ns:
            return None
        self._part = None
        return part if part.stamp_ns == self._ended_ns else None
