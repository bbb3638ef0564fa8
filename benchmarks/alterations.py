# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is done to a mission's measurements before an estimator gets them."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from enum import StrEnum

import numpy as np

from msss_graphslam.core.types import Array, Beam, Inertial, Measurement

__all__ = ["Alteration", "altered"]

_HIGHEST_LEVEL, _HIGHEST_CODE = 15, 255
_SOUND_SPEED_RATIO = 1.01


class Alteration(StrEnum):
    """The alterations by name."""

    NONE = ""
    NO_IMU = "no_imu"
    FOUR_BITS = "four_bits"
    SOUND_SPEED = "sound_speed"


def altered(measurements: Iterable[Measurement], alteration: Alteration) -> Iterator[Measurement]:
    """Return the measurements without the IMU's, with beams of 16 levels, or a wrong scale.

    The scale is that of a head which takes the speed of sound for 1 % less than it is.
    """
    match alteration:
        case Alteration.NO_IMU:
            return (entry for entry in measurements if not isinstance(entry, Inertial))
        case Alteration.FOUR_BITS:
            return (_coarse(entry) if isinstance(entry, Beam) else entry for entry in measurements)
        case Alteration.SOUND_SPEED:
            return _rescaled(measurements)
        case _:
            return iter(measurements)


def _coarse(beam: Beam) -> Beam:
    """Return the beam as a head sends it in four bits: the levels that the driver makes of it."""
    levels = np.floor(beam.intensities * (_HIGHEST_LEVEL + 1) / _HIGHEST_CODE)
    levels = np.minimum(levels, _HIGHEST_LEVEL)
    return replace(beam, intensities=levels * _HIGHEST_CODE / _HIGHEST_LEVEL)


def _rescaled(measurements: Iterable[Measurement]) -> Iterator[Measurement]:
    ranges: Array | None = None
    for entry in measurements:
        if not isinstance(entry, Beam):
            yield entry
            continue
        if ranges is None:
            ranges = entry.ranges / _SOUND_SPEED_RATIO
        yield replace(entry, ranges=ranges)
