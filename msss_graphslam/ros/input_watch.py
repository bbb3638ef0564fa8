# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What came on one input: rate, age, gaps, losses."""

from collections import deque
from collections.abc import Callable, Iterator
from statistics import median

__all__ = ["InputWatch"]

_SPAN = 10.0
_PERIODS = 100
_GAP_PERIODS = 5.0
_SHORTEST_GAP_NS = 1_000_000_000


class InputWatch:
    """Counts the messages of a topic; ``clock()`` is a steady time [s].

    Rate and age are those of arrival, gaps those of the stamps, so that the speed of a replay does
    not make any.
    """

    def __init__(self, name: str, clock: Callable[[], float]) -> None:
        self.name = name
        self.received = 0
        self.lost = 0
        self.gaps = 0
        self._clock = clock
        self._since = self._last_arrival = clock()
        self._arrivals: deque[float] = deque()
        self._last_ns: int | None = None
        self._periods: deque[int] = deque(maxlen=_PERIODS)

    def seen(self, stamp_ns: int | None = None) -> None:
        """Count one message, with the stamp if it has one that can be trusted."""
        now = self._clock()
        self.received += 1
        self._last_arrival = now
        self._arrivals.append(now)
        self._forget(now)
        if stamp_ns is not None:
            self._follow(stamp_ns)

    @property
    def rate(self) -> float:
        """Messages a second over the last 10 s, or since the start [Hz]."""
        now = self._clock()
        self._forget(now)
        return len(self._arrivals) / max(min(_SPAN, now - self._since), 1.0)

    @property
    def silence(self) -> float:
        """Seconds since the last message, or since the start."""
        return self._clock() - self._last_arrival

    @property
    def values(self) -> Iterator[tuple[str, str | int | float]]:
        """The rows for the diagnostics."""
        yield f"rate/{self.name}", self.rate
        yield f"age/{self.name}", self.silence if self.received else "none"
        yield f"gaps/{self.name}", self.gaps
        yield f"received/{self.name}", self.received
        yield f"lost/{self.name}", self.lost

    def _forget(self, now: float) -> None:
        while self._arrivals and now - self._arrivals[0] > _SPAN:
            self._arrivals.popleft()

    def _follow(self, stamp_ns: int) -> None:
        last, self._last_ns = self._last_ns, stamp_ns
        if last is None or stamp_ns <= last:
            return
        period = stamp_ns - last
        if period > _SHORTEST_GAP_NS and self._is_unusual(period):
            self.gaps += 1
        else:
            self._periods.append(period)

    def _is_unusual(self, period: int) -> bool:
        return bool(self._periods) and period > _GAP_PERIODS * median(self._periods)
