# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Recorded bytes of a head to beams: nobody to talk to, stamps from the recording."""

from collections import Counter

from msss_graphslam.core.types import Beam
from msss_graphslam.micron.reception import Reception

__all__ = ["RawBeams"]


class RawBeams:
    """Bytes as they were read from the head's port, in their order; beams out.

    A live head's beams come through the same :class:`Reception`, so that a recording of its bytes
    and their receipts gives the same beams again.
    """

    def __init__(self, sound_speed: float, inverted: bool, baudrate: int) -> None:
        self._reception = Reception(sound_speed, inverted, baudrate)

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""
        return self._reception.refused

    @property
    def skipped_bytes(self) -> int:
        """Bytes so far that belong to no packet."""
        return self._reception.skipped_bytes

    @property
    def period(self) -> float:
        """The time [s] between two beams as observed; 0 before the first."""
        return self._reception.period

    def feed(self, data: bytes, received_ns: int) -> list[Beam]:
        """Return the beams that these bytes, read at ``received_ns``, complete."""
        return self._reception.beams(self._reception.packets(data), received_ns)
