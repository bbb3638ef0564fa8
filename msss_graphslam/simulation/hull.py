# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle's own hull in the sonar's picture: ringing, shadow and mirror image.

Levels as measured with a Micron on a moving vehicle; they are fixed in the sensor's frame.
"""

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import power_from_level
from msss_graphslam.simulation.ripple import Ripple
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.streams import stream

__all__ = ["Hull"]

_FREE_RANGES = (0.0, 0.12, 0.2, 0.25, 0.33, 0.42, 0.52, 0.62, 0.8, 1.0, 1.2, 1.5, 2.0)
_FREE_LEVELS = (-20.0, 3.0, 26.0, 28.0, 25.5, 17.5, 13.5, 10.5, 6.5, 4.0, 1.5, -3.0, -20.0)
_HULL_RANGES = (0.0, 0.12, 0.2, 0.3, 0.42, 0.55, 0.65, 0.75, 0.85, 0.95, 1.05, 1.2, 1.5)
_HULL_LEVELS = (-20.0, 3.0, 22.0, 31.0, 35.0, 33.0, 29.0, 22.0, 17.0, 11.0, 6.0, 0.0, -20.0)
_LEVEL_RIPPLE = 3.0
_RANGE_RIPPLE = 0.14
_MIRROR_AXIS = np.radians(180.0 - 14.0)
_MIRROR_LEVEL = -18.5
_MIRROR_RIPPLE = 2.0


class Hull:
    """What lies astern of the head."""

    def __init__(self, settings: SonarSettings, seed: int) -> None:
        self._settings = settings
        self._level_ripple = Ripple(stream(seed, "hull ringing level"))
        self._range_ripple = Ripple(stream(seed, "hull ringing range"))
        self._mirror_ripple = Ripple(stream(seed, "hull mirror"))

    def ringing(self, bearings: Array) -> Array:
        """Return the power (b, bins) of the near field: stronger and longer at the hull."""
        stretch = np.exp(_RANGE_RIPPLE * self._range_ripple(bearings))[:, None]
        ranges = self._settings.ranges / stretch
        free = np.interp(self._settings.ranges, _FREE_RANGES, _FREE_LEVELS)
        hull = np.interp(ranges, _HULL_RANGES, _HULL_LEVELS)
        hull += _LEVEL_RIPPLE * self._level_ripple(bearings)[:, None]
        return power_from_level(np.where(self.near(bearings)[:, None], hull, free))

    def near(self, bearings: Array) -> NDArray[np.bool_]:
        """Whether the hull rings and mirrors at ``bearings`` [rad]."""
        settings = self._settings
        return _astern(bearings, max(settings.hull_sector, settings.hull_shadow))

    def hides(self, bearings: Array) -> NDArray[np.bool_]:
        """Whether the hull stands before the scene at ``bearings`` [rad]."""
        return _astern(bearings, self._settings.hull_shadow)

    def mirrored(self, bearings: Array) -> Array:
        """Return the bearings [rad] that the hull's mirror image at ``bearings`` comes from."""
        return np.asarray(_MIRROR_AXIS - bearings)

    def mirror_power(self, bearings: Array) -> Array:
        """Return the power (b,) of the mirror image against the scene; 0 away from the hull."""
        level = _MIRROR_LEVEL + _MIRROR_RIPPLE * self._mirror_ripple(bearings)
        return np.where(self.near(bearings), power_from_level(level), 0.0)


def _astern(bearings: Array, sector: float) -> NDArray[np.bool_]:
    return np.asarray(np.pi - np.abs(np.mod(bearings + np.pi, 2 * np.pi) - np.pi) < 0.5 * sector)
