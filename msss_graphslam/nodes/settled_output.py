# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Settled odometry, gathered so that a tenth of a second goes in one message at most."""

from collections.abc import Callable
from time import monotonic

import numpy as np

from msss_graphslam.core.types import Odometry
from msss_graphslam.messages import encoding, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode
from msss_graphslam.ros.qos import DEEP

__all__ = ["SettledOutput"]

_PERIOD_NS = 100_000_000
# At real time scans do not wait for so much: how much goes in one message changes no result.
_WALL_PERIOD = 0.04
_MOST_ROWS = 500
_LONG_AGO = -(2**62)


class SettledOutput:
    """Publishes what settles, and how far dead reckoning has taken its input.

    The latest minutes are kept for a scan generation that starts late, or again.
    """

    def __init__(self, node: SlamNode, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._refused = node.diagnostics.refused
        self._output = node.offer(topics.SETTLED_ODOMETRY, DEEP)
        self.reset()

    def reset(self) -> None:
        """Forget what was not published."""
        self._entries: list[Odometry] = []
        self._newest_ns = self._published_ns = _LONG_AGO
        self._published_at = self._clock()

    def add(self, entries: list[Odometry]) -> None:
        """Gather odometry; what is not finite is left out and counted."""
        for entry in entries:
            if _is_finite(entry):
                self._entries.append(entry)
            else:
                self._refused["not_finite_output"] += 1

    def seen(self, stamp_ns: int) -> None:
        """Note that input up to the stamp is taken; publish if it is time to."""
        self._newest_ns = max(self._newest_ns, stamp_ns)
        is_long = self._newest_ns - self._published_ns >= _PERIOD_NS
        if is_long or (self._entries and self._clock() - self._published_at >= _WALL_PERIOD):
            self.publish()

    def publish_rest(self) -> None:
        """Publish if anything is not yet."""
        if self._entries or self._newest_ns > self._published_ns:
            self.publish()

    def publish(self) -> None:
        """Publish all that is gathered."""
        if self._newest_ns == _LONG_AGO:
            return
        entries, self._entries = self._entries, []
        self._published_ns, self._published_at = self._newest_ns, self._clock()
        for first in range(0, max(len(entries), 1), _MOST_ROWS):
            rows = entries[first : first + _MOST_ROWS]
            self._output.publish(encoding.settled_odometry(make, self._newest_ns, rows))


def _is_finite(entry: Odometry) -> bool:
    numbers = (entry.pose, entry.covariance, entry.twist, entry.twist_covariance)
    return all(np.isfinite(values).all() for values in numbers)
