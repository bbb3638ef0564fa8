# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether all has come in: a service call may overtake messages that wait in their queues."""

from time import monotonic

__all__ = ["Quiet"]

_PAUSE = 0.1
# Sensors that go on all the time are not waited for any longer [s].
_PATIENCE = 0.2


class Quiet:
    """Notes when the last message was taken, and how long a caller has been put off."""

    def __init__(self) -> None:
        self._taken = monotonic()
        self._asked: float | None = None

    def note(self) -> None:
        """Note that a message was taken; at the end of the work it gives."""
        self._taken = monotonic()

    @property
    def lasting(self) -> float:
        """Seconds since the last message."""
        return monotonic() - self._taken

    def is_reached(self) -> bool:
        """Whether the queues are empty by now, or the caller has been put off long enough."""
        now = monotonic()
        self._asked = now if self._asked is None else self._asked
        if now - self._taken < _PAUSE and now - self._asked < _PATIENCE:
            return False
        self._asked = None
        return True
