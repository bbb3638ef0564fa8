# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of the sonar's port in a message, with the time at which they came in."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from msss_graphslam.messages.refusal import Refusal

__all__ = ["RawBytes", "label_of", "raw_bytes"]

_NANOSECONDS = 1_000_000_000
_KIND = "received"
_LABEL = re.compile(r"received (\d{1,10})\.(\d{9})", re.ASCII)
_LAST_SECOND = 2**31 - 1  # of builtin_interfaces/Time
# No port brings a megabyte between two looks at it; more would keep a node busy for long.
_LONGEST = 1 << 20


@dataclass(frozen=True, slots=True)
class RawBytes:
    """Bytes as read in one piece, and when [ns]; None where whoever sent them did not say."""

    received_ns: int | None
    data: bytes


def label_of(received_ns: int) -> str:
    """Return the time as the label of the message's only dimension."""
    seconds, nanoseconds = divmod(int(received_ns), _NANOSECONDS)
    return f"{_KIND} {seconds}.{nanoseconds:09d}"


def raw_bytes(message: Any) -> RawBytes:
    """Return the bytes of a std_msgs/UInt8MultiArray, or raise Refusal.

    The dimension's sizes are not looked at: the data have their own length. A label of another
    kind is somebody else's, and says nothing.
    """
    data = np.asarray(message.data, dtype=np.uint8)
    offset = int(message.layout.data_offset)
    if data.size > _LONGEST:
        raise Refusal("raw_too_long")
    if not 0 <= offset <= data.size:
        raise Refusal("raw_offset_outside")
    return RawBytes(_received(message.layout.dim), data[offset:].tobytes())


def _received(dimensions: Any) -> int | None:
    label = str(dimensions[0].label) if len(dimensions) else ""
    if not label.startswith(_KIND):
        return None
    found = _LABEL.fullmatch(label)
    if found is None or int(found[1]) > _LAST_SECOND:
        raise Refusal("raw_label_invalid")
    return int(found[1]) * _NANOSECONDS + int(found[2])
