# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a foreign format has to say of itself, and the conventions that they share."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Beam
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.frames import SONAR_LINK
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.conversion.source import ForeignSource
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.typestore import make

__all__ = ["BeamEncoder", "ForeignFormat", "ForeignMessage", "seanet_bearing"]


class ForeignMessage(NamedTuple):
    """A converted message, its topic and when it was received [ns]."""

    topic: Topic
    message: Any
    log_ns: int


class ForeignFormat(ABC):
    """A kind of foreign recording; listed in ``FORMATS``.

    ``mounting`` is that of the vehicle whose recordings these are, where there is only one.
    """

    name: str
    description: str
    mounting: Mounting | None = None

    @abstractmethod
    def recognises(self, source: ForeignSource) -> bool:
        """Whether it is of this kind."""

    @abstractmethod
    def messages(
        self, source: ForeignSource, refusals: Counter[str], inverted: bool
    ) -> Iterator[ForeignMessage]:
        """Yield the converted messages as recorded; refused ones are counted by reason.

        ``inverted``: the head stood upside down, and the recording takes no account of it.
        """


class BeamEncoder:
    """Makes LaserScan messages of a head's beams, and refuses what no reader would take."""

    def __init__(self, inverted: bool = False) -> None:
        self._sense = -1.0 if inverted else 1.0
        self._last_ns: int | None = None

    def message(self, stamp_ns: int, bearing: float, ranges: Array, codes: Array) -> Any:
        """Return the beam; its period is the time since the last one, 0 [s] for the first."""
        if len(ranges) == 0:
            raise Refusal("beam_without_bins")
        period = 0.0 if self._last_ns is None else (stamp_ns - self._last_ns) * 1e-9
        beam = Beam(stamp_ns, self._sense * bearing, ranges, codes)
        message = encoding.laser_scan(make, beam, SONAR_LINK, max(period, 0.0))
        decoding.beam(message)
        self._last_ns = stamp_ns
        return message


def seanet_bearing(angle: float) -> float:
    """Return the bearing counter-clockwise from ahead [rad] of a SeaNet angle [rad].

    A SeaNet head counts 6400 steps a turn clockwise from above, 3200 straight ahead; several
    drivers publish them without that half turn. A Ping360 counts 400 in the same way.
    """
    return float(wrap(np.pi - angle))
