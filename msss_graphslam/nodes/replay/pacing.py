# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When a recorded message is due, and messages in batches. No ROS."""

import time
from collections.abc import Callable, Iterable, Iterator

from msss_graphslam.recordings.mcap_reading import RawMessage

__all__ = ["BATCH_NS", "Pace", "batches"]

BATCH_NS = 100_000_000
"""Span of a batch [ns of mission time]: between batches the replay looks at its listeners."""

# A replay that was held back this long goes on from there, instead of racing to catch up.
_LATE = 0.5


class Pace:
    """Sets log times against a monotonic clock.

    Parameters
    ----------
    rate
        Mission seconds a second; 0 means that everything is due at once.
    clock
        Monotonic time [s].
    """

    def __init__(self, rate: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate = rate
        self._clock = clock
        self._anchor: tuple[int, float] | None = None

    def restart(self) -> None:
        """Make the next message due at once, and count from there."""
        self._anchor = None

    def delay(self, log_ns: int) -> float:
        """Return how long [s] until a message is due; 0 where it is due or late."""
        if self._rate == 0.0:
            return 0.0
        now = self._clock()
        if self._anchor is None:
            self._anchor = log_ns, now
        first_ns, began = self._anchor
        delay = began + (log_ns - first_ns) * 1e-9 / self._rate - now
        if delay < -_LATE:
            self._anchor = log_ns, now
        return max(delay, 0.0)


def batches(messages: Iterable[RawMessage], span_ns: int = BATCH_NS) -> Iterator[list[RawMessage]]:
    """Yield the messages in lists that span less than ``span_ns`` of log time each."""
    batch: list[RawMessage] = []
    for message in messages:
        if batch and message.log_ns - batch[0].log_ns >= span_ns:
            yield batch
            batch = []
        batch.append(message)
    if batch:
        yield batch
