# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sonar's beams meet: the geometry that every echo model starts from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.ray_casting import Hits, Walls

__all__ = ["Fan", "Pings", "Scatterers"]

_RAYS = 11
_WIDTHS = 2.0
_FRACTIONS = np.array([0.125, 0.375, 0.625, 0.875])
_CONTINUOUS = 0.1
_CLEAR_OF_WALL = 1e-6


@dataclass(frozen=True, slots=True)
class Pings:
    """Consecutive transmissions.

    ``origins`` (b, 2) [m] in ``map``, ``bearings`` (b,) [rad] in ``sonar_link`` and ``azimuths``
    (b,) [rad] in ``map``, each at its transmit time.
    """

    origins: Array
    bearings: Array
    azimuths: Array


@dataclass(frozen=True, slots=True)
class Scatterers:
    """Pieces of wall in a beam: ``ranges`` (b, k) [m] and ``incidence`` (b, k) [rad]."""

    ranges: Array
    incidence: Array

    @classmethod
    def between_rays(cls, hits: Hits) -> "Scatterers":
        """Return the pieces between neighbouring rays (b, r); there are 4 (r - 1).

        Where a wall goes on they lie on the line between two hits; where the range jumps, at the
        nearer ray's.
        """
        ranges = hits.ranges
        with np.errstate(invalid="ignore"):
            jumps = np.abs(np.diff(ranges, axis=1))
            goes_on = jumps <= _CONTINUOUS * np.minimum(ranges[:, :-1], ranges[:, 1:])
            goes_on &= np.isfinite(jumps)
            return cls(_between(ranges, goes_on), _between(hits.incidence, goes_on))


class Fan:
    """The rays that stand for a beam of finite width.

    ``shares`` (4 (r - 1),) of the two-way power lie between neighbouring rays; they sum to 1.
    """

    def __init__(self, walls: Walls, beam_width: float) -> None:
        self._walls = walls
        half = 0.5 * _WIDTHS * beam_width
        self._offsets = np.linspace(-half, half, _RAYS)
        between = self._offsets[:-1, None] + _FRACTIONS * np.diff(self._offsets)[:, None]
        pattern = _gaussian(between.ravel() / beam_width) ** 2
        self.shares = pattern / pattern.sum()

    def cast(self, origins: Array, azimuths: Array) -> Hits:
        """Return the hits (b, r) of the beams from ``origins`` (b, 2) along ``azimuths`` (b,)."""
        return self._walls.cast(origins[:, None], azimuths[:, None] + self._offsets)

    def cast_on(self, origins: Array, azimuths: Array, first: Hits) -> Hits:
        """Return the second hits (b, r) after a mirror reflection; ranges are of both ways."""
        rays = azimuths[:, None] + self._offsets
        directions = np.stack([np.cos(rays), np.sin(rays)], axis=-1)
        met = np.isfinite(first.ranges)
        legs = np.where(met, first.ranges - _CLEAR_OF_WALL, 0.0)
        points = origins[:, None] + legs[..., None] * directions
        across = np.sum(directions * first.normals, axis=-1, keepdims=True)
        mirrored = directions - 2.0 * across * first.normals
        second = self._walls.cast(points, np.arctan2(mirrored[..., 1], mirrored[..., 0]))
        return Hits(np.where(met, legs + second.ranges, np.inf), second.incidence, second.normals)


def _gaussian(offsets: Array) -> Array:
    """Return a bell curve that has fallen to a half at offsets of -0.5 and 0.5."""
    return np.asarray(np.exp(-4.0 * np.log(2.0) * offsets**2))


def _between(values: Array, goes_on: NDArray[np.bool_]) -> Array:
    left, right = values[:, :-1, None], values[:, 1:, None]
    stepped = np.where(_FRACTIONS < 0.5, left, right)
    linear = left + _FRACTIONS * (right - left)
    between = np.where(goes_on[..., None], linear, stepped)
    return between.reshape(len(values), len(_FRACTIONS) * left.shape[1])
