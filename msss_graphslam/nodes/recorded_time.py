# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The times that a recorded message gets, live and in a replay. No ROS."""

from collections import deque
from collections.abc import Callable

__all__ = ["RecordedTime"]

_KEPT = 5000

_Writing = Callable[[int, int], None]


class RecordedTime:
    """Log times: live those of arrival, in a replay those of publishing, by the replay's clock.

    A replay may be faster than the recorder, which then takes the messages of several topics in
    another order than they were published in. When the middleware published them keeps that
    order, and tells to which reading of the clock they belong.

    Parameters
    ----------
    now
        Returns the node's time [ns].
    is_replayed
        Whether that follows a clock that is published, which has not begun yet.
    """

    def __init__(self, now: Callable[[], int], is_replayed: bool) -> None:
        self._now = now
        self._is_replayed = is_replayed
        self._ticks: deque[tuple[int, int]] = deque(maxlen=_KEPT)
        self._early: list[tuple[int, _Writing]] = []

    def date(self, published_ns: int, write: _Writing) -> None:
        """Have a message written with its log time and time of publishing [ns].

        What comes before the clock has begun is written when it begins, with that time.

        Parameters
        ----------
        published_ns
            Time of publishing by the middleware's clock, 0 where it does not tell.
        write
            Writes the message; gets the two times.
        """
        if not self._is_replayed or not published_ns:
            now_ns = self._now()
            write(now_ns, published_ns or now_ns)
        elif self._ticks:
            write(self._mission_ns(published_ns), published_ns)
        else:
            self._early.append((published_ns, write))

    def tick(self, published_ns: int, clock_ns: int) -> None:
        """Take a reading of the clock, and when the middleware published that."""
        if published_ns:
            self._ticks.append((published_ns, clock_ns))
            self._write_early()

    def finish(self) -> None:
        """Write what still waits for a clock, with its time of publishing."""
        self._is_replayed = False
        self._write_early()

    def _write_early(self) -> None:
        early, self._early = self._early, []
        for published_ns, write in early:
            write(self._mission_ns(published_ns), published_ns)

    def _mission_ns(self, published_ns: int) -> int:
        """Return the reading before, and what has passed since, but less than to the next one."""
        if not self._ticks:
            return published_ns
        _, next_ns = self._ticks[-1]
        if len(self._ticks) > 1:
            next_ns += next_ns - self._ticks[-2][1]
        for tick_ns, clock_ns in reversed(self._ticks):
            if tick_ns <= published_ns:
                return clock_ns + max(min(published_ns - tick_ns, next_ns - clock_ns - 1), 0)
            next_ns = clock_ns
        return next_ns
