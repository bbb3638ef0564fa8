# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far a replay has come, told at each tenth. No ROS."""

import time
from collections.abc import Callable

__all__ = ["Progress"]


class Progress:
    """Tells mission time and achieved rate at each 10 % of a recording.

    Parameters
    ----------
    start_ns, end_ns
        First and last log time.
    clock
        Monotonic time [s].
    """

    def __init__(
        self, start_ns: int, end_ns: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._start_ns = start_ns
        self._span_ns = max(end_ns - start_ns, 1)
        self._clock = clock
        self._began = clock()
        self._told = 0

    def at(self, log_ns: int) -> str | None:
        """Return a line where another tenth is complete, else None."""
        done_ns = log_ns - self._start_ns
        tenth = 10 * done_ns // self._span_ns
        if tenth <= self._told:
            return None
        self._told = tenth
        rate = done_ns * 1e-9 / max(self._clock() - self._began, 1e-9)
        return (
            f"replayed {10 * tenth} %: {done_ns * 1e-9:.1f} s of {self._span_ns * 1e-9:.1f} s,"
            f" {rate:.1f} x real time"
        )
