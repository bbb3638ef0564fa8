# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When to do slow things: by wall time."""

from collections.abc import Callable
from time import monotonic

__all__ = ["Leisure", "Throttle"]

_LEISURE = 10.0


class Throttle:
    """Allows work when something has changed, at most every ``period`` seconds.

    Work that takes long is done more rarely: nine tenths of the time at least are left to others.
    """

    def __init__(self, period: float, clock: Callable[[], float] = monotonic) -> None:
        self._period = period
        self._clock = clock
        self._next = -1e9
        self._is_due = False

    def ask(self) -> None:
        """Note that there is something to do."""
        self._is_due = True

    def run(self, work: Callable[[], object]) -> bool:
        """Do the work if it is asked for and it is time; return whether it was done."""
        begun = self._clock()
        if not self._is_due or begun < self._next:
            return False
        self._is_due = False
        try:
            work()
        finally:
            end = self._clock()
            self._next = begun + max(self._period, _LEISURE * (end - begun))
        return True


class Leisure:
    """Whether slow work can be done before something comes that must be answered at once.

    It comes in nearly equal intervals: the first half of one is free, and what lasts long after
    one, as nothing may come any more.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._last = clock()
        self._interval = 0.0

    def end(self) -> None:
        """Note that it has come."""
        now = self._clock()
        self._interval, self._last = now - self._last, now

    @property
    def lasts(self) -> bool:
        """Whether there is time."""
        since = self._clock() - self._last
        return since < 0.5 * self._interval or since > 2.0 * self._interval
