# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The head's transmitter: one packet after the other, at the line's rate."""

from dataclasses import dataclass

from msss_graphslam.micron.timing import transfer_time

__all__ = ["Sender", "Transmission", "nanoseconds"]


@dataclass(frozen=True, slots=True)
class Transmission:
    """A packet, and when its last byte is there."""

    data: bytes
    ends_ns: int


class Sender:
    """Puts packets on a line of ``baudrate``."""

    def __init__(self, baudrate: int) -> None:
        self._baudrate = baudrate
        self._free_ns = 0
        self._sent: list[Transmission] = []

    def send(self, data: bytes, from_ns: int) -> int:
        """Send a packet from ``from_ns`` on, or when the line is free; return when it is there."""
        begins_ns = max(from_ns, self._free_ns)
        self._free_ns = begins_ns + nanoseconds(transfer_time(len(data), self._baudrate))
        self._sent.append(Transmission(data, self._free_ns))
        return self._free_ns

    def take(self) -> list[Transmission]:
        """Return what was sent since the last call."""
        sent, self._sent = self._sent, []
        return sent

    def stop(self) -> None:
        """Break off."""
        self._free_ns = 0
        self._sent = []


def nanoseconds(seconds: float) -> int:
    """Return a time [s] in nanoseconds."""
    return round(seconds * 1e9)
