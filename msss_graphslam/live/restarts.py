# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When a process that has died is started again, and when no more."""

from collections import deque

__all__ = ["Restarts"]

_PAUSE = 0.5
_MOST, _SPAN = 5, 60.0


class Restarts:
    """The deaths of one process: it comes back after 0.5 s, at most five times a minute."""

    def __init__(self) -> None:
        self.count = 0
        self.due: float | None = None
        self._deaths: deque[float] = deque()

    def died(self, now: float) -> bool:
        """Note a death at this time [s]; return whether the process comes back."""
        while self._deaths and now - self._deaths[0] >= _SPAN:
            self._deaths.popleft()
        if len(self._deaths) >= _MOST:
            return False
        self._deaths.append(now)
        self.due = now + _PAUSE
        return True

    def take(self, now: float) -> bool:
        """Return whether it is time to start the process, and count that it was started."""
        if self.due is None or now < self.due:
            return False
        self.due = None
        self.count += 1
        return True
