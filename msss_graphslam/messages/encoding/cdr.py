# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of a message written field by field, as the middleware sends them."""

from struct import calcsize, pack

import numpy as np
from numpy.typing import NDArray

__all__ = ["CdrWriter"]

_ENCAPSULATION = b"\x00\x01\x00\x00"  # plain CDR, little-endian
_NANOSECONDS = 1_000_000_000


class CdrWriter:
    """Writes plain CDR, little-endian: each number at a multiple of its size.

    Source: Common Object Request Broker Architecture 3.4 part 2, section 9.3.
    """

    def __init__(self) -> None:
        self._data = bytearray(_ENCAPSULATION)

    @property
    def data(self) -> bytes:
        """What has been written, ready to be published."""
        return bytes(self._data)

    def numbers(self, code: str, *values: float) -> None:
        """Write numbers of one kind, a letter of the module ``struct``."""
        self.align(calcsize(f"<{code}"))
        self._data += pack(f"<{len(values)}{code}", *values)

    def text(self, *texts: str) -> None:
        """Write strings."""
        for text in texts:
            encoded = text.encode() + b"\x00"
            self.numbers("I", len(encoded))
            self._data += encoded

    def header(self, stamp_ns: int, frame_id: str) -> None:
        """Write a std_msgs/Header."""
        self.numbers("I", *divmod(int(stamp_ns), _NANOSECONDS))
        self.text(frame_id)

    def rows(self, rows: NDArray[np.generic], left_out: int = 0) -> None:
        """Write an array as it lies in memory, without its last ``left_out`` bytes.

        It begins at a multiple of 8 bytes, as is due where a row begins with a 64-bit number.
        """
        if rows.size:
            self.align(8)
            self._data += memoryview(rows.tobytes())[: rows.nbytes - left_out]

    def align(self, size: int) -> None:
        """Go on at a multiple of ``size`` bytes."""
        self._data += bytes((len(_ENCAPSULATION) - len(self._data)) % size)
