# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether all has come in: a service call may overtake what was sent before it. No ROS."""

from collections.abc import Callable
from math import inf
from time import monotonic

__all__ = ["Quiet"]

_PAUSE, _PATIENCE = 0.1, 0.2
# A question after so long [s] is another caller's.
_FORGOTTEN = 5.0
_LONG_AGO = -1e9


class Quiet:
    """Notes when something came, and how long a caller has been put off.

    Parameters
    ----------
    pause
        How long [s] nothing may have come.
    patience
        After so long [s] the caller is put off no more: sensors go on all the time.
    since_question
        Whether the pause begins with the first question at the earliest. It has to where other
        topics are on their way than the last that came.
    """

    def __init__(
        self,
        pause: float = _PAUSE,
        patience: float = _PATIENCE,
        *,
        since_question: bool = False,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._pause, self._patience = pause, patience
        self._since_question = since_question
        self._clock = clock
        self._taken = clock()
        self._first_asked = self._last_asked = _LONG_AGO

    @classmethod
    def between_nodes(cls, clock: Callable[[], float] = monotonic) -> "Quiet":
        """Return what another node is waited for with; it ends what it sends."""
        return cls(1.0, inf, since_question=True, clock=clock)

    def note(self) -> None:
        """Note that something was taken; at the end of the work it gives."""
        self._taken = self._clock()

    @property
    def lasting(self) -> float:
        """Seconds since the last that came."""
        return self._clock() - self._taken

    def is_reached(self) -> bool:
        """Answer a caller, who asks again and again until it is reached."""
        now = self._clock()
        if now - self._last_asked > _FORGOTTEN:
            self._first_asked = now
        self._last_asked = now
        since = max(self._taken, self._first_asked) if self._since_question else self._taken
        reached = now - since >= self._pause or now - self._first_asked >= self._patience
        if reached:
            self._last_asked = _LONG_AGO
        return reached
