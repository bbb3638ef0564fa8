# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The way of a process that has ended, for the one that goes on from there. No ROS."""

from collections.abc import Callable
from time import monotonic

from msss_graphslam.messages.link_decoding import StampedPose

__all__ = ["Predecessor"]

# So long it is waited for others to be found, and for the way's end [s].
_LEAST = 1.0
_DISCOVERY = 3.0
_LONGEST = 6.0
# What ends longer before the first measurement is not told to its end yet, perhaps.
_NEAR_NS = 5_000_000_000


class Predecessor:
    """Whether the way is known well enough to begin.

    ``is_told()`` says whether somebody tells of it. ``poses`` is empty where there was nobody.
    """

    def __init__(
        self, is_told: Callable[[], bool], clock: Callable[[], float] = monotonic
    ) -> None:
        self.poses: list[StampedPose] = []
        self._is_told = is_told
        self._clock = clock
        self._started = clock()
        self._is_known = False

    def tell(self, poses: list[StampedPose]) -> None:
        """Note the way as it is told last; none means that nobody was there."""
        self.poses, self._is_known = poses, True

    def may_begin(self, first_ns: int) -> bool:
        """Whether to begin with a first measurement of that stamp."""
        age = self._clock() - self._started
        if age < _LEAST:
            return False
        if not self._is_known:
            return age > (_LONGEST if self._is_told() else _DISCOVERY)
        is_near = not self.poses or first_ns - self.poses[-1].stamp_ns <= _NEAR_NS
        return is_near or age > _LONGEST
