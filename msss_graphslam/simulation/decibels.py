# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The levels that a Micron sends: half decibels, packed into a byte."""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array

__all__ = ["codes_from_power", "power_from_level"]

_STEPS = 160
_STEPS_PER_DECIBEL = 2.0
_LEAST_POWER = 1e-9


def power_from_level(level: Array | float) -> Array:
    """Return the power of a level [dB]."""
    return np.asarray(10.0 ** (np.asarray(level) / 10.0))


def codes_from_power(power: Array) -> NDArray[np.uint8]:
    """Return the codes 0..255 of echo powers: floor(k 255 / 160) for k half decibels, 0..80 dB."""
    level = 10.0 * np.log10(np.maximum(power, _LEAST_POWER))
    steps = np.clip(np.floor(_STEPS_PER_DECIBEL * level), 0, _STEPS).astype(np.int64)
    return (steps * 255 // _STEPS).astype(np.uint8)
