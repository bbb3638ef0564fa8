# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Measurements of several sensors, put into the order of their stamps."""

import heapq
from collections import Counter

from msss_graphslam.core.types import Measurement

__all__ = ["Sequencer"]

_LONG_AGO = -(2**62)


class Sequencer:
    """Holds measurements until no sensor that speaks can have an earlier one.

    A sensor is waited for as long as it is silent for no more than ``patience`` [s] of the others'
    time, so the order that comes out depends on the stamps alone, not on the order of arrival.
    Who speaks is not known at first, so nothing leaves for the first ``patience``. What comes more
    than ``window`` [s] after the newest of all is refused and counted, unless it still fits.
    """

    def __init__(self, window: float, patience: float, refused: Counter[str]) -> None:
        self._window_ns = round(window * 1e9)
        self._patience_ns = round(patience * 1e9)
        self._refused = refused
        self._heap: list[tuple[int, str, int, Measurement]] = []
        self._count = 0
        self._first_ns: int | None = None
        self._heard: dict[str, int] = {}
        self._newest_ns = _LONG_AGO
        self._often: Counter[str] = Counter()
        self._released_ns = _LONG_AGO

    def push(self, measurement: Measurement) -> list[Measurement]:
        """Take in one measurement; return those whose turn has come."""
        if not self.admits(measurement):
            self._refused["later_than_reorder_window"] += 1
            return []
        kind, stamp_ns = type(measurement).__name__, measurement.stamp_ns
        heapq.heappush(self._heap, (stamp_ns, kind, self._count, measurement))
        self._count += 1
        self._often[kind] += 1
        if stamp_ns > self._heard.get(kind, _LONG_AGO):
            self._heard[kind] = stamp_ns
        if stamp_ns > self._newest_ns:
            self._newest_ns = stamp_ns
        if self._first_ns is None:
            self._first_ns = stamp_ns
        return self._release(self._settled_ns(self._first_ns))

    def admits(self, measurement: Measurement) -> bool:
        """Whether the measurement can still find its place."""
        return measurement.stamp_ns >= self._released_ns

    @property
    def reached_ns(self) -> int | None:
        """Newest stamp of the sensor that speaks most often, None before the first."""
        return self._heard[self._often.most_common(1)[0][0]] if self._often else None

    def held(self) -> list[Measurement]:
        """Return what is held, in the order of the stamps."""
        return [entry[3] for entry in sorted(self._heap, key=lambda entry: entry[:3])]

    def flush(self) -> list[Measurement]:
        """Return all that is still held."""
        return self._release(self._newest_ns)

    def _settled_ns(self, first_ns: int) -> int:
        newest = self._newest_ns
        if newest - first_ns < self._patience_ns:
            return _LONG_AGO
        settled, silent = newest - self._window_ns, newest - self._patience_ns
        for heard in self._heard.values():
            if silent <= heard < settled:
                settled = heard
        return settled

    def _release(self, until_ns: int) -> list[Measurement]:
        released = []
        heap = self._heap
        while heap and heap[0][0] <= until_ns:
            released.append(heapq.heappop(heap)[3])
        if until_ns > self._released_ns:
            self._released_ns = until_ns
        return released
