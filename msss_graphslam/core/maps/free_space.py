# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where a scan's beams passed before they met something."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import compose, transform_points, wrap
from msss_graphslam.core.types import Array, Keyframe

__all__ = ["Rays", "free_places", "rays_of"]


@dataclass(frozen=True, slots=True)
class Rays:
    """The beams of one scan that have a return, in ``map``.

    ``starts`` (b, 2) [m], ``bearings`` (b,) ascending [rad] and ``lengths`` (b,) up to the first
    return [m].
    """

    starts: Array
    bearings: Array
    lengths: Array


def rays_of(keyframe: Keyframe, sonar_position: Array) -> Rays:
    """Return the rays of a keyframe's scan; ``sonar_position`` (2,) is in ``base_link`` [m]."""
    scan = keyframe.scan
    vectors = scan.body_points - sonar_position
    ranges = np.hypot(vectors[:, 0], vectors[:, 1])
    nearest_first = np.lexsort((ranges, scan.beam_index))
    beams, first = np.unique(scan.beam_index[nearest_first], return_index=True)
    nearest = nearest_first[first]
    poses = compose(keyframe.pose, scan.motion[beams])
    starts = transform_points(poses, np.broadcast_to(sonar_position, (len(beams), 2)))
    bearings = wrap(poses[:, 2] + np.arctan2(vectors[nearest, 1], vectors[nearest, 0]))
    order = np.argsort(bearings)
    return Rays(starts[order], bearings[order], ranges[nearest][order])


def free_places(rays: Rays, resolution: float, width: float) -> Array:
    """Return places (2, n) [m] in the sectors before the first returns, some in every cell there.

    ``resolution`` is the edge of a cell [m], ``width`` the angle of a sector [rad]. Off its axis a
    beam reaches as far as the neighbour on that side does too: walls at grazing incidence would
    otherwise be cut.
    """
    # A square lattice has a point in every cell, however it lies, if its spacing is at most the
    # cell's edge by the root of 2.
    spacing = resolution / np.sqrt(2.0)
    number, offsets, first = _fan(rays.lengths.max(initial=0.0), spacing, width)
    neighbours = np.stack([np.roll(rays.lengths, 1), rays.lengths, np.roll(rays.lengths, -1)])
    lengths = np.minimum(rays.lengths, neighbours[1 + np.sign(number)]).T
    counts = np.ceil((lengths - resolution) / spacing).astype(np.intp) - first
    counts = np.maximum(counts, 0).reshape(-1)
    line = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts)
    bearings = (rays.bearings[:, None] + offsets).reshape(-1)
    starts = np.repeat(rays.starts.T, len(first), axis=1)
    distances = spacing * (np.tile(first, len(rays.lengths))[line] + step)
    return np.stack(
        [
            starts[0, line] + distances * np.cos(bearings)[line],
            starts[1, line] + distances * np.sin(bearings)[line],
        ]
    )


def _fan(
    length: float, spacing: float, width: float
) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
    """Return the lines of a sector: their numbers from its axis, offsets [rad] and first samples.

    Every second line begins only where the others have diverged by a spacing, of the others again
    every second, and so on.
    """
    half = max(int(np.ceil(0.5 * length * width / spacing)), 1)
    angle = 0.5 * width / half
    number = np.arange(-half, half + 1)
    power_of_two = number & -number
    first = np.zeros(len(number), dtype=np.intp)
    with np.errstate(divide="ignore"):
        diverged = np.minimum(1.0 / (2.0 * angle * power_of_two), 1.0 + length / spacing)
    first[number != 0] = diverged[number != 0]
    return number, np.asarray(angle * number), first
