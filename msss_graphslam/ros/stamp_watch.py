# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The order of a topic's stamps, and what is to be said where it stays disturbed."""

from msss_graphslam.messages.order import StampOrder
from msss_graphslam.messages.refusal import Refusal

__all__ = ["StampWatch"]

_REPEATED = 2


class StampWatch:
    """A StampOrder that remembers what it refused in a row."""

    def __init__(self, topic_name: str) -> None:
        self._topic_name = topic_name
        self.reset()

    def reset(self) -> None:
        """Start anew: whatever comes next is in order."""
        self._order = StampOrder()
        self._last_ns = 0
        self._refused = 0
        self._back_ns = 0

    def check(self, stamp_ns: int) -> None:
        """Take the stamp as the latest, or raise Refusal."""
        try:
            self._order.check(stamp_ns)
        except Refusal:
            self._refused += 1
            self._back_ns = self._last_ns - stamp_ns
            raise
        self._last_ns, self._refused = stamp_ns, 0

    @property
    def complaint(self) -> str:
        """What is wrong with the clock, empty if nothing is."""
        if self._refused < _REPEATED:
            return ""
        seconds = abs(self._back_ns) * 1e-9
        if self._back_ns < 0:
            return f"clock of {self._topic_name} jumps ahead by {seconds:.3f} s, again and again"
        return (
            f"clock of {self._topic_name} went back by {seconds:.3f} s;"
            " refused until it has caught up (or call ~/reset)"
        )
