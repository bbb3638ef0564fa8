# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the packets' definitions share: the error, and numbers laid out as bytes."""

import struct

__all__ = ["PacketError", "pack", "require"]


class PacketError(ValueError):
    """A packet that the protocol does not allow; ``reason`` in a few words, for counting."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


def require(holds: bool, reason: str) -> None:
    """Raise the error with this reason unless the condition holds."""
    if not holds:
        raise PacketError(reason)


def pack(layout: struct.Struct, *values: int) -> bytes:
    """Return the numbers as bytes.

    Raises
    ------
    PacketError
        If one does not fit into its field.
    """
    try:
        return layout.pack(*values)
    except struct.error as error:
        reason = f"a number does not fit into its field: {error}"
        raise PacketError(reason) from error
