# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of the ping360_sonar driver: one ``SonarEcho`` a beam."""

from collections import Counter
from collections.abc import Callable
from math import isfinite, pi
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.messages import Refusal
from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.recordings.conversion.bags import BeamBags, convert_beams
from msss_graphslam.recordings.conversion.foreign import BeamEncoder, seanet_bearing
from msss_graphslam.recordings.conversion.source import ForeignSource

__all__ = ["Ping360"]

_TICK = 25e-9  # s, of the time between two samples
_TURN = 400.0  # gradians
# No angle in radians lies beyond a turn; the margin is for 32-bit floats.
_LARGEST_RADIANS = 2.0 * pi + 1e-3


class Ping360(BeamBags):
    """A Ping360 counts as a SeaNet head does: clockwise from above, half a turn is ahead.

    That is how the maker's own viewer draws it; the driver passes the head's angle on. In radians,
    as its message says; the first versions wrote gradians all the same, and a bag is taken for
    one of those if any angle in it is too large for radians.
    """

    name = "ping360"
    description = "ROS 2 or ROS 1 bag with SonarEcho (ping360_sonar)"
    type_name = "/SonarEcho"

    def decoder(self, source: ForeignSource, encoder: BeamEncoder) -> Callable[[Any], Any]:
        """Return what encodes the beam of a message of this bag."""
        unit = self._unit(source)

        def beam(echo: Any) -> Any:
            codes = np.array(echo.intensities, dtype=float)
            if not isfinite(echo.angle):
                raise Refusal("beam_bearing_not_finite")
            bearing = seanet_bearing(echo.angle * unit)
            return encoder.message(stamp_of(echo, "beam"), bearing, _ranges(echo), codes)

        return beam

    def _unit(self, source: ForeignSource) -> float:
        """Return the unit of the angles [rad]."""

        def angle(echo: Any) -> float:
            return abs(float(echo.angle))

        found = convert_beams(source, self.type_name, angle, Counter())
        largest = max((entry.message for entry in found if isfinite(entry.message)), default=0.0)
        return 1.0 if largest <= _LARGEST_RADIANS else 2.0 * pi / _TURN


def _ranges(echo: Any) -> Array:
    """Return the centres of the bins [m].

    The driver asks for ``range``, but the head samples at whole ticks: the driver rounds down to
    them, which makes the bins up to 1 % shorter.
    """
    samples, sound_speed = int(echo.number_of_samples), float(echo.speed_of_sound)
    if samples != len(echo.intensities):
        raise Refusal("beam_lengths_differ")
    if samples == 0:
        raise Refusal("beam_without_bins")
    if sound_speed <= 0.0:
        raise Refusal("beam_without_sound_speed")
    ticks = int(2.0 * float(echo.range) / (samples * sound_speed * _TICK))
    centres = (np.arange(samples) + 0.5) * (ticks * _TICK * sound_speed / 2.0)
    return np.asarray(centres, dtype=float)
