# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that differ in their stamp and numbers alone, cast as bytes.

To make an Odometry of its parts and have it serialised takes ten times as long as to write 85
numbers where the last one had them.
"""

from typing import Any

import numpy as np
from rclpy.serialization import serialize_message

from msss_graphslam.core.types import Array

__all__ = ["Mould"]

_STAMP = 4  # bytes of the encapsulation before it
_BIG_ENDIAN, _LITTLE_ENDIAN = 0, 1
_NANOSECONDS = 1_000_000_000


class Mould:
    """Casts messages like a first one.

    ``prototype`` is a message whose header comes first and whose only other contents are text,
    which stays, and after it ``count`` 64-bit numbers. They are written into ``numbers`` (count,).
    Raises ValueError where the middleware lays it out in another way.
    """

    def __init__(self, prototype: Any, count: int) -> None:
        self._data = bytearray(serialize_message(prototype))
        if len(self._data) < _STAMP + 8 * (count + 1) or self._data[1] > _LITTLE_ENDIAN:
            raise ValueError(f"not laid out as in CDR: {bytes(self._data[:_STAMP])!r}")
        order = ">" if self._data[1] == _BIG_ENDIAN else "<"
        size = len(self._data)
        self._stamp = np.frombuffer(self._data, f"{order}u4", count=2, offset=_STAMP)
        self.numbers: Array = np.frombuffer(self._data, f"{order}f8", offset=size - 8 * count)

    def cast(self, stamp_ns: int) -> bytes:
        """Return the message with this stamp and the numbers as they are now."""
        self._stamp[:] = divmod(stamp_ns, _NANOSECONDS)
        return bytes(self._data)
