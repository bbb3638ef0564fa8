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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Reading

__all__ = ["reject_ghosts"]

Indices = NDArray[np.intp]

_LARGEST_GAP = 2.5


@dataclass(frozen=True, slots=True)
class _Echoes:
    """The echoes of a turn by beam, (n, k) with NaN where a beam has fewer than k.

    ``ranges`` [m], ``levels`` [dB], ``spreads`` the ranges' standard deviations [m]; ``bearings``
    (n,) [rad].
    """

    ranges: Array
    levels: Array
    spreads: Array
    bearings: Array


def reject_ghosts(readings: Sequence[Reading], config: Segmentation) -> list[Reading]:
    """Return the readings of one turn, in their order, without the candidates that are ghosts.

    A surface stays if enough beams see it, and if most of its echoes come near the strongest one
    that the turn has at their range.
    """
    if not any(reading.ranges.size for reading in readings):
        return list(readings)
    echoes = _Echoes(
        ranges=_table([reading.ranges for reading in readings]),
        levels=_table([reading.levels for reading in readings]),
        spreads=np.sqrt(_table([reading.variances for reading in readings])),
        bearings=np.array([reading.bearing for reading in readings]),
    )
    surfaces = _surfaces(echoes, config)
    deficits = _strongest_at_range(echoes, config.ghost_window) - echoes.levels
    beams, _ = there = np.nonzero(surfaces >= 0)
    kept = np.ones(surfaces.shape, dtype=bool)
    kept[there] = _stays(surfaces[there], beams, deficits[there], config)
    whole = np.asarray(kept.all(axis=1)).tolist()
    return [
        reading if is_whole else _select(reading, mask[: reading.ranges.size])
        for reading, mask, is_whole in zip(readings, kept, whole, strict=True)
    ]


def _stays(
    surfaces: Indices, beams: Indices, deficits: Array, config: Segmentation
) -> NDArray[np.bool_]:
    """Return which echoes (m,) stay, by their surfaces, beams and deficits [dB]."""
    _, numbers, counts = np.unique(surfaces, return_inverse=True, return_counts=True)
    ascending = deficits[np.lexsort((deficits, numbers))]
    ends = np.cumsum(counts)
    first, second = ends - counts + (counts - 1) // 2, ends - counts + counts // 2
    medians = 0.5 * (ascending[first] + ascending[second])
    pairs = np.unique(np.stack([numbers, beams]), axis=1)  # a beam may see a surface twice
    seen = np.bincount(pairs[0]) >= config.surface_beams
    return np.asarray((seen & (medians < config.ghost_contrast))[numbers])


def _table(rows: Sequence[Array]) -> Array:
    """Return the rows as one (n, k) array, filled up with NaN."""
    sizes = np.array([row.size for row in rows])
    table = np.full((len(rows), sizes.max()), np.nan)
    table[np.arange(sizes.max()) < sizes[:, None]] = np.concatenate(rows)
    return table


def _surfaces(echoes: _Echoes, config: Segmentation) -> Indices:
    """Return the echoes' surfaces by number (n, k), -1 where there is no echo.

    Echoes are linked to those of the next beam and, as one may be missing, of the next but one.
    """
    first, second = np.concatenate([_links(echoes, step, config) for step in (1, 2)], axis=1)
    size = echoes.ranges.size
    numbers = _connected(size, first, second).reshape(echoes.ranges.shape)
    return np.where(np.isfinite(echoes.ranges), numbers, -1)


def _connected(size: int, first: Indices, second: Indices) -> Indices:
    """Return for each of ``size`` echoes the lowest of those that links (m,) join it to."""
    roots = np.arange(size)
    while True:
        ends = roots[first], roots[second]
        lower = roots.copy()
        np.minimum.at(lower, np.maximum(*ends), np.minimum(*ends))
        lower = lower[lower]
        if np.array_equal(lower, roots):
            return roots
        roots = lower


def _links(echoes: _Echoes, step: int, config: Segmentation) -> Indices:
    """Return the pairs (2, m) of flat indices that continue each other over ``step`` beams."""
    turned = np.abs(wrap(np.roll(echoes.bearings, -step) - echoes.bearings))
    usual = np.median(np.abs(wrap(np.diff(echoes.bearings, append=echoes.bearings[:1]))))
    steepest = turned[:, None, None] * np.tan(config.steepest_incidence)
    reach = np.maximum(*_pairs(echoes.ranges, step)) * steepest
    reach += 2.0 * np.hypot(*_pairs(echoes.spreads, step))
    apart = np.abs(np.subtract(*_pairs(echoes.ranges, step))) / reach
    unlike = np.abs(np.subtract(*_pairs(echoes.levels, step))) / config.level_step
    linked = (apart <= 1.0) & (unlike <= 1.0)
    linked &= (turned <= _LARGEST_GAP * usual)[:, None, None]
    beam, own, other = np.nonzero(_mutually_nearest(np.where(linked, apart + unlike, np.inf)))
    beams, count = echoes.ranges.shape
    return np.stack([beam * count + own, (beam + step) % beams * count + other])


def _pairs(values: Array, step: int) -> tuple[Array, Array]:
    """Return the echoes (n, k, 1) of every beam and those (n, 1, k) of the beam ``step`` on."""
    return values[:, :, None], np.roll(values, -step, axis=0)[:, None, :]


def _mutually_nearest(distances: Array) -> NDArray[np.bool_]:
    """Return which pairs (n, k, k) are each other's nearest, at a finite distance."""
    nearest = np.isfinite(distances)
    nearest &= distances == distances.min(axis=2, keepdims=True)
    nearest &= distances == distances.min(axis=1, keepdims=True)
    return nearest


def _strongest_at_range(echoes: _Echoes, window: float) -> Array:
    """Return for every echo (n, k) the highest level within ``window`` [m] of its range."""
    order = np.argsort(echoes.ranges, axis=None)[: np.isfinite(echoes.ranges).sum()]
    ranges, levels = echoes.ranges.ravel()[order], echoes.levels.ravel()[order]
    begin = np.searchsorted(ranges, ranges - window)
    end = np.searchsorted(ranges, ranges + window, side="right")
    strongest = np.full(echoes.ranges.size, np.nan)
    windows = np.column_stack([begin, end]).ravel()  # every second one lies between two windows
    strongest[order] = np.maximum.reduceat(np.append(levels, -np.inf), windows)[::2]
    return strongest.reshape(echoes.ranges.shape)


def _select(reading: Reading, mask: NDArray[np.bool_]) -> Reading:
    return replace(
        reading,
        ranges=reading.ranges[mask],
        variances=reading.variances[mask],
        levels=reading.levels[mask],
    )
