# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sidelobes hear: the nearest wall's ring at all bearings, filled in behind."""

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.decibels import power_from_level
from msss_graphslam.simulation.hull import Hull
from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.ripple import Ripple
from msss_graphslam.simulation.scene import Pings, Scatterers
from msss_graphslam.simulation.streams import stream

__all__ = ["Sidelobes"]

_RAYS = 120
_PINGS_PER_CAST = 12
_FAR_LEVEL = -44.0
_NEAR_RISE = 14.0
_NEAR_WIDTH = np.radians(15.0)
_RIPPLE = 3.0
_BEAM_EQUIVALENT = 0.753


class Sidelobes:
    """The two-way sidelobe pattern over the whole turn.

    The vehicle hardly moves from beam to beam: one cast round serves a few of them.
    """

    def __init__(self, walls: Walls, beam_width: float, hull: Hull, seed: int) -> None:
        self._walls = walls
        self._hull = hull
        self._ripple = Ripple(stream(seed, "sidelobes"))
        self._rays = np.linspace(-np.pi, np.pi, _RAYS + 1)
        self._share = 2.0 * np.pi / (4 * _RAYS) / (_BEAM_EQUIVALENT * beam_width)

    def hear(self, pings: Pings) -> tuple[Scatterers, Array]:
        """Return all walls around (b, k), and the share (b, k) of the power in each."""
        origins = pings.origins[::_PINGS_PER_CAST]
        hits = self._walls.cast(origins[:, None], self._rays)
        around = Scatterers.between_rays(hits)
        group = np.arange(len(pings.origins)) // _PINGS_PER_CAST
        count = around.ranges.shape[1]
        azimuths = -np.pi + 2.0 * np.pi * (np.arange(count) + 0.5) / count
        bearings = azimuths - (pings.azimuths - pings.bearings)[:, None]
        shares = self._share * _pattern(bearings - pings.bearings[:, None])
        shares *= power_from_level(_RIPPLE * self._ripple(pings.bearings))[:, None]
        shares[self._hull.hides(bearings)] = 0.0
        return Scatterers(around.ranges[group], around.incidence[group]), shares


def _pattern(offsets: Array) -> Array:
    """Return the two-way power of a direction ``offsets`` [rad] away from the beam's axis."""
    offsets = np.abs(np.mod(offsets + np.pi, 2.0 * np.pi) - np.pi)
    return power_from_level(_FAR_LEVEL + _NEAR_RISE * np.exp(-offsets / _NEAR_WIDTH))
