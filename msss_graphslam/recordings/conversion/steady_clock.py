# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a computer that records: it may be set back while it does."""

from collections import Counter

from msss_graphslam.messages import Refusal

__all__ = ["SteadyClock"]

# What the threads of a recorder mix up is less, a clock that is set differs by more.
_LARGEST_STEP_BACK_NS = 100_000_000
_LONGEST_INTERVAL_NS = 1_000_000_000
_LARGEST_JUMP_NS = 60 * 1_000_000_000


class SteadyClock:
    """Goes on where a recorded clock went back, as if the usual interval had passed.

    Nothing recorded is lost by that but the length of one interval; each is counted in
    ``refusals`` as ``clock_set_back``. A clock that is set ahead cannot be told from a pause;
    but a time far ahead may be a single wrong one, so it has to be confirmed by the next.
    """

    def __init__(self, refusals: Counter[str]) -> None:
        self._refusals = refusals
        self._shift_ns = self._former_shift_ns = 0
        self._interval_ns = 0
        self._last_ns: int | None = None
        self._ahead_ns: int | None = None

    def time(self, recorded_ns: int) -> int:
        """Return the time [ns] of what was recorded at ``recorded_ns``, or raise Refusal."""
        if self._last_ns is not None:
            self._shift_ns, self._former_shift_ns = self._shifts(recorded_ns, self._last_ns)
            interval_ns = recorded_ns + self._shift_ns - self._last_ns
            if 0 < interval_ns <= _LONGEST_INTERVAL_NS:
                self._interval_ns = interval_ns
        self._last_ns, self._ahead_ns = recorded_ns + self._shift_ns, None
        return self._last_ns

    def _shifts(self, recorded_ns: int, last_ns: int) -> tuple[int, int]:
        """Return what is added to the recorded clock now, and what was before it was set."""
        shift_ns, former_ns = self._shift_ns, self._former_shift_ns
        for candidate, other in ((shift_ns, former_ns), (former_ns, shift_ns)):
            interval_ns = recorded_ns + candidate - last_ns
            if -_LARGEST_STEP_BACK_NS <= interval_ns <= _LARGEST_JUMP_NS:
                return candidate, other
        if recorded_ns + shift_ns > last_ns:
            self._require_confirmed(recorded_ns + shift_ns)
            return shift_ns, former_ns
        self._refusals["clock_set_back"] += 1
        return last_ns + self._interval_ns - recorded_ns, shift_ns

    def _require_confirmed(self, now_ns: int) -> None:
        ahead_ns = self._ahead_ns
        if ahead_ns is None or not 0 <= now_ns - ahead_ns <= _LARGEST_JUMP_NS:
            self._ahead_ns = now_ns
            raise Refusal("stamp_jumps_ahead")
