# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Stamps that repeat, go back or jump ahead."""

from msss_graphslam.messages.refusal import Refusal

__all__ = ["StampOrder"]

# No sensor of a running vehicle is silent for a minute; a clock that is set may jump so far.
_LARGEST_JUMP_NS = 60 * 1_000_000_000


class StampOrder:
    """Admits the messages of one topic as long as their stamps increase.

    A stamp far ahead could be a single wrong one, after which all right ones would seem to go
    back; so it is refused, and admitted only when the next one agrees with it.
    """

    def __init__(self) -> None:
        self._last_ns: int | None = None
        self._ahead_ns: int | None = None

    def check(self, stamp_ns: int) -> None:
        """Take the stamp as the latest, or raise Refusal."""
        if self._last_ns is not None:
            if stamp_ns <= self._last_ns:
                raise Refusal("stamp_not_increasing")
            if stamp_ns - self._last_ns > _LARGEST_JUMP_NS and not self._is_confirmed(stamp_ns):
                self._ahead_ns = stamp_ns
                raise Refusal("stamp_jumps_ahead")
        self._last_ns, self._ahead_ns = stamp_ns, None

    def _is_confirmed(self, stamp_ns: int) -> bool:
        return self._ahead_ns is not None and 0 < stamp_ns - self._ahead_ns <= _LARGEST_JUMP_NS
