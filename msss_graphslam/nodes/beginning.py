# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What others have sent, or kept for a node that is started again, takes a moment to come."""

from collections.abc import Callable
from time import monotonic

__all__ = ["Beginning"]

# So long others are looked for, so long it must have been still, and no longer than that [s].
_DISCOVERY = 3.0
_STILL = 1.0
_LONGEST = 15.0


class Beginning:
    """Whether a node can know already all that it is to know."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._started = self._arrival = clock()
        self._asked: float | None = None

    def note(self) -> None:
        """Note that something has come."""
        self._arrival = self._clock()

    def expects_more(self, *, whole: bool) -> bool:
        """Whether something of before the start, or of before the question, is on its way.

        ``whole`` says whether what is there looks as if it were all; what does not is asked for
        again for some time.
        """
        now = self._clock()
        age = now - self._started
        self._asked = None if whole else now if self._asked is None else self._asked
        if self._asked is not None and now - self._asked < _LONGEST:
            return True
        return age < _DISCOVERY or (age < _LONGEST and now - self._arrival < _STILL)
