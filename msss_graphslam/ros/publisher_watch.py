# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two publishers on a topic that has room for one: the first heard is followed."""

from collections.abc import Callable

from msss_graphslam.messages.refusal import Refusal

__all__ = ["PublisherWatch"]

# What a publisher may have lost on the way and is still itself, where there may be another, and
# where there is none: an outage of the link takes an hour of poses.
_WINDOW = 1000
_OUTAGE = 200_000
_SILENCE = 2.0
# A middleware that does not number says so with the largest number.
_UNNUMBERED = 2**63


class PublisherWatch:
    """Follows one publisher by the running numbers of its messages.

    An ``exclusive`` watch refuses other publishers; one that is not takes what comes, and knows of
    losses only while there is one publisher. ``count_publishers()`` is asked only where a number
    does not continue the last one.
    """

    def __init__(self, count_publishers: Callable[[], int], *, exclusive: bool = True) -> None:
        self.numbered = True
        self._count = count_publishers
        self._exclusive = exclusive
        self._last: int | None = None
        self._accepted_at = 0.0

    def check(self, number: int, now: float) -> int:
        """Take the message of that number at ``now`` [s], or raise Refusal.

        Returns how many messages of the same publisher are missing before it.
        """
        self.numbered = number < _UNNUMBERED
        if not self.numbered:
            return 0
        missing = 0 if self._last is None else number - self._last - 1
        if missing and not self._continues(missing, now):
            missing = 0
        self._last, self._accepted_at = number, now
        return missing

    def _continues(self, missing: int, now: float) -> bool:
        """Whether the publisher followed speaks, after losing some, and no new one."""
        if not self._exclusive:
            return 0 < missing < _OUTAGE and self._count() <= 1
        is_near = 0 < missing < _WINDOW
        if not is_near and now - self._accepted_at <= _SILENCE and self._count() > 1:
            raise Refusal("second_publisher")
        return is_near
