# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Measurements of several sensors, put into the order of their stamps."""

import heapq
from collections import Counter

from msss_graphslam.core.types import Measurement

__all__ = ["Sequencer"]


class Sequencer:
    """Holds measurements for ``window`` [s] of sensor time: the late ones find their place.

    The order that comes out depends on the stamps alone, not on the order of arrival, as long as
    nothing is later than the window; what is later is refused and counted.
    """

    def __init__(self, window: float, refused: Counter[str]) -> None:
        self._window_ns = round(window * 1e9)
        self._refused = refused
        self._heap: list[tuple[int, str, int, Measurement]] = []
        self._count = 0
        self._newest_ns = -(2**62)
        self._released_ns = -(2**62)

    def push(self, measurement: Measurement) -> list[Measurement]:
        """Take in one measurement; return those whose turn has come."""
        if measurement.stamp_ns < self._released_ns:
            self._refused["later_than_reorder_window"] += 1
            return []
        kind = type(measurement).__name__
        heapq.heappush(self._heap, (measurement.stamp_ns, kind, self._count, measurement))
        self._count += 1
        self._newest_ns = max(self._newest_ns, measurement.stamp_ns)
        return self._release(self._newest_ns - self._window_ns)

    def flush(self) -> list[Measurement]:
        """Return all that is still held."""
        return self._release(self._newest_ns)

    def _release(self, until_ns: int) -> list[Measurement]:
        released = []
        while self._heap and self._heap[0][0] <= until_ns:
            released.append(heapq.heappop(self._heap)[3])
        self._released_ns = max(self._released_ns, until_ns)
        return released
