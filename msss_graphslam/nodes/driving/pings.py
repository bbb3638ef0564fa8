# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams on their way out, and how regular they are."""

import threading
from collections import deque
from time import monotonic

import numpy as np

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import encoding, topics
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode

__all__ = ["Pings"]

_SPAN = 10.0
_STAMPS = 200
_ENOUGH = 3


class Pings:
    """Publishes beams on ``sonar/ping``; may be used from any thread."""

    def __init__(self, node: SlamNode) -> None:
        self.count = 0
        self.frame_id = ""
        self._output = node.offer(topics.SONAR_PING)
        self._output.show_listeners()
        self._lock = threading.Lock()
        self._since = monotonic()
        self._arrivals: deque[float] = deque()
        self._stamps: deque[int] = deque(maxlen=_STAMPS)

    def publish(self, beam: Beam, period: float) -> None:
        """Publish a beam; ``period`` is the time to the next one [s]."""
        self._output.publish(encoding.laser_scan(make, beam, self.frame_id, period), period)
        with self._lock:
            self.count += 1
            self._arrivals.append(monotonic())
            self._stamps.append(beam.stamp_ns)
            self._forget()

    @property
    def silence(self) -> float:
        """Seconds since the last beam, or since the start."""
        with self._lock:
            return monotonic() - (self._arrivals[-1] if self._arrivals else self._since)

    @property
    def rate(self) -> float:
        """Beams a second over the last 10 s [Hz]."""
        with self._lock:
            self._forget()
            return len(self._arrivals) / max(min(_SPAN, monotonic() - self._since), 1.0)

    @property
    def jitter_ms(self) -> float | str:
        """How far the times between two stamps scatter about their median [ms]."""
        with self._lock:
            intervals = np.diff(np.array(self._stamps, dtype=np.int64)) * 1e-6
        if intervals.size < _ENOUGH:
            return "none"
        return float(np.median(np.abs(intervals - np.median(intervals))) * 1.4826)

    def _forget(self) -> None:
        now = monotonic()
        while len(self._arrivals) > 1 and now - self._arrivals[0] > _SPAN:
            self._arrivals.popleft()
