# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far a replay runs ahead of a node that takes what is sent. No ROS."""

import struct
from collections import deque
from statistics import median_low

__all__ = ["Lead", "header_stamp_ns"]

_OFFSETS = 15
# Progress is told ten times a second, by dead reckoning behind its window for late data.
_REPORT_NS = 500_000_000
_STAMP = {1: struct.Struct("<iI"), 0: struct.Struct(">iI")}


def header_stamp_ns(data: bytes) -> int | None:
    """Return the stamp [ns] of a serialised message (CDR) that begins with a header."""
    if len(data) < 12 or data[0] != 0 or data[1] not in _STAMP:
        return None
    seconds, nanoseconds = _STAMP[data[1]].unpack_from(data, 4)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


class Lead:
    """Sensor time between what was sent and what the node has taken.

    Log times may differ from stamps by a constant. It is the median over some messages, so that
    a senseless stamp does not stop the replay.
    """

    def __init__(self, limit_ns: int) -> None:
        self._limit_ns = limit_ns
        self.restart()

    def restart(self) -> None:
        """Forget everything: the next message is the first."""
        self._offsets: deque[int] = deque(maxlen=_OFFSETS)
        self._sent_ns: int | None = None
        self._settled_ns: int | None = None
        self._allowed_ns: int | None = None

    def sent(self, log_ns: int, data: bytes) -> None:
        """Note a sensor's message as it goes out."""
        self.sent_at(log_ns, header_stamp_ns(data))

    def sent_at(self, log_ns: int, stamp_ns: int | None) -> None:
        """Note a message with that stamp, None for one that says none."""
        if stamp_ns is not None:
            self._offsets.append(stamp_ns - log_ns)
        if self._allowed_ns is None:
            self._allowed_ns = log_ns
        self._sent_ns = log_ns

    def settled(self, stamp_ns: int) -> bool:
        """Note how far the node is; return whether that is news."""
        if stamp_ns == self._settled_ns:
            return False
        self._settled_ns = stamp_ns
        return True

    def release(self) -> None:
        """Allow the limit once more from here, whatever the node says."""
        self._allowed_ns = self._sent_ns

    @property
    def is_too_long(self) -> bool:
        """Whether the replay has to wait."""
        if self._sent_ns is None or self._allowed_ns is None:
            return False
        taken_ns = max(self._allowed_ns, self._taken_ns or self._allowed_ns)
        return self._sent_ns - taken_ns > self._limit_ns

    @property
    def is_over(self) -> bool:
        """Whether the node has taken all that was sent, but for its last report."""
        if self._sent_ns is None:
            return True
        return self._taken_ns is not None and self._sent_ns - self._taken_ns <= _REPORT_NS

    @property
    def _taken_ns(self) -> int | None:
        """Log time of what the node has taken."""
        if self._settled_ns is None:
            return None
        return self._settled_ns - (median_low(self._offsets) if self._offsets else 0)
