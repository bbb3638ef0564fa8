# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Ghosts in a turn of readings, found by comparing with other bearings at the same range.

A strong surface shows again at its own range: through the sidelobes over all bearings, and in the
mirror that the vehicle's hull is. Such images move with the vehicle, so they look like walls to a
filter of neighbours; but they are far weaker than their origin. An oblique wall, or one end of a
small tank, may be just as weak in some beams, so it is not an echo that is judged but the surface
that it belongs to: a chain of echoes over neighbouring beams.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.echoes.turn_surfaces import (
    Indices,
    TurnEchoes,
    beams_by_chance,
    surfaces_of,
)
from msss_graphslam.core.types import Array, Reading

__all__ = ["reject_ghosts"]


def reject_ghosts(
    readings: Sequence[Reading], config: Segmentation, beam_width: float
) -> list[Reading]:
    """Return the readings of one turn, in their order, without the candidates that are ghosts.

    A surface stays if more beams see it than chance explains, ``beam_width`` [rad] wide each, and
    if most of its echoes come near the strongest one that the turn has at their range.
    """
    if not any(reading.ranges.size for reading in readings):
        return list(readings)
    echoes = TurnEchoes.of(readings)
    surfaces = surfaces_of(echoes, config)
    fewest = beams_by_chance(echoes, surfaces, config, beam_width)
    deficits = _strongest_at_range(echoes, config.ghost_window) - echoes.levels
    beams, _ = there = np.nonzero(surfaces >= 0)
    kept = np.ones(surfaces.shape, dtype=bool)
    kept[there] = _stays(surfaces[there], beams, deficits[there], fewest, config.ghost_contrast)
    whole = np.asarray(kept.all(axis=1)).tolist()
    return [
        reading if is_whole else reading.having(mask[: reading.ranges.size])
        for reading, mask, is_whole in zip(readings, kept, whole, strict=True)
    ]


def _stays(
    surfaces: Indices, beams: Indices, deficits: Array, fewest: float, contrast: float
) -> NDArray[np.bool_]:
    """Return which echoes (m,) stay, by their surfaces, beams and deficits [dB]."""
    _, numbers, counts = np.unique(surfaces, return_inverse=True, return_counts=True)
    ascending = deficits[np.lexsort((deficits, numbers))]
    ends = np.cumsum(counts)
    first, second = ends - counts + (counts - 1) // 2, ends - counts + counts // 2
    medians = 0.5 * (ascending[first] + ascending[second])
    looks = np.unique(numbers * (beams.max() + 1) + beams)  # a beam may see a surface twice
    seen = np.bincount(looks // (beams.max() + 1)) >= fewest
    return np.asarray((seen & (medians < contrast))[numbers])


def _strongest_at_range(echoes: TurnEchoes, window: float) -> Array:
    """Return for every echo (n, k) the highest level within ``window`` [m] of its range."""
    order = np.argsort(echoes.ranges, axis=None)[: np.isfinite(echoes.ranges).sum()]
    ranges, levels = echoes.ranges.ravel()[order], echoes.levels.ravel()[order]
    begin = np.searchsorted(ranges, ranges - window)
    end = np.searchsorted(ranges, ranges + window, side="right")
    strongest = np.full(echoes.ranges.size, np.nan)
    windows = np.column_stack([begin, end]).ravel()  # every second one lies between two windows
    strongest[order] = np.maximum.reduceat(np.append(levels, -np.inf), windows)[::2]
    return strongest.reshape(echoes.ranges.shape)
