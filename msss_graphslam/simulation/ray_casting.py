# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where rays meet the walls of a planar world."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["Hits", "Walls"]

_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Hits:
    """First meetings of rays (...,) with a wall.

    ``ranges`` [m] are inf where a ray meets none; ``incidence`` [rad] is the angle to the wall's
    normal; ``normals`` (..., 2) are unit vectors.
    """

    ranges: Array
    incidence: Array
    normals: Array


@dataclass(frozen=True, slots=True)
class Walls:
    """Straight walls: ``starts`` (m, 2) and ``edges`` (m, 2), vectors from start to end [m]."""

    starts: Array
    edges: Array

    @classmethod
    def of(cls, outlines: Iterable[Array]) -> "Walls":
        """Return the edges of closed polygons (k, 2) [m]."""
        polygons = list(outlines)
        return cls(
            np.vstack(polygons),
            np.vstack([np.roll(polygon, -1, axis=0) - polygon for polygon in polygons]),
        )

    def cast(self, origins: Array, azimuths: Array) -> Hits:
        """Return where rays from ``origins`` (..., 2) [m] in direction ``azimuths`` (...) go.

        The two broadcast against each other; azimuths [rad] are counter-clockwise from x.
        """
        origins, directions = np.broadcast_arrays(origins, _units(azimuths))
        shape = directions.shape[:-1]
        origins, directions = origins.reshape(-1, 2), directions.reshape(-1, 2)
        ranges = self._distances(origins, directions)
        nearest = np.argmin(ranges, axis=1)
        ranges = np.take_along_axis(ranges, nearest[:, None], axis=1)[:, 0]
        normals = _across(self.edges / np.linalg.norm(self.edges, axis=1, keepdims=True))[nearest]
        cosines = np.abs(np.sum(normals * directions, axis=1))
        incidence = np.arccos(np.minimum(cosines, 1.0))
        return Hits(ranges.reshape(shape), incidence.reshape(shape), normals.reshape(*shape, 2))

    def _distances(self, origins: Array, directions: Array) -> Array:
        """Return distances (n, m) to every wall: o + t d = a + u e, solved by cross products."""
        across_edges, across_directions = _across(self.edges), _across(directions)
        determinant = -directions @ across_edges.T
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            along_edge = across_directions @ self.starts.T
            along_edge -= np.sum(across_directions * origins, axis=1)[:, None]
            along_edge /= -determinant
            distance = origins @ across_edges.T
            distance -= np.sum(self.starts * across_edges, axis=1)
            distance /= determinant
            misses = ~((np.abs(along_edge - 0.5) <= 0.5 + _TOLERANCE) & (distance > _TOLERANCE))
        distance[misses] = np.inf
        return distance


def _across(vectors: Array) -> Array:
    """Return the vectors (n, 2) turned by 90 degrees."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def _units(azimuths: Array) -> Array:
    return np.stack([np.cos(azimuths), np.sin(azimuths)], axis=-1)
