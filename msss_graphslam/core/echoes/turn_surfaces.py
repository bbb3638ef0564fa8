# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces in a turn of readings: chains of echoes over neighbouring beams, and those of chance.

That chance alone makes too few of what is taken for real to matter is how A. Desolneux, L. Moisan
and J.-M. Morel decide what is seen in a picture: Meaningful alignments, IJCV 40, 2000.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Reading

__all__ = ["Indices", "TurnEchoes", "beams_by_chance", "surfaces_of"]

Indices = NDArray[np.intp]

_LARGEST_GAP = 2.5

_UNRELATED = 0.382
"""Share of a turn between beams that see different things; twice as far they do, too."""


@dataclass(frozen=True, slots=True)
class TurnEchoes:
    """The echoes of a turn by beam, (n, k) with NaN where a beam has fewer than k.

    ``ranges`` [m], ``levels`` [dB], ``spreads`` the ranges' standard deviations [m]; ``bearings``
    (n,) [rad].
    """

    ranges: Array
    levels: Array
    spreads: Array
    bearings: Array

    @staticmethod
    def of(readings: Sequence[Reading]) -> "TurnEchoes":
        """Return the echoes of readings, of which at least one has some."""
        sizes = np.array([reading.ranges.size for reading in readings])
        there = np.arange(sizes.max()) < sizes[:, None]
        return TurnEchoes(
            ranges=_table(there, [reading.ranges for reading in readings]),
            levels=_table(there, [reading.levels for reading in readings]),
            spreads=np.sqrt(_table(there, [reading.variances for reading in readings])),
            bearings=np.array([reading.bearing for reading in readings]),
        )

    @property
    def step(self) -> float:
        """The usual angle between two beams [rad]."""
        return float(np.median(_turned(self.bearings, 1)))


def surfaces_of(echoes: TurnEchoes, config: Segmentation) -> Indices:
    """Return the echoes' surfaces by number (n, k), -1 where there is no echo.

    Echoes are linked to those of the next beam and, as one may be missing, of the next but one.
    """
    first, second = np.concatenate([_links(echoes, step, config) for step in (1, 2)], axis=1)
    size = echoes.ranges.size
    numbers = _connected(size, first, second).reshape(echoes.ranges.shape)
    return np.where(np.isfinite(echoes.ranges), numbers, -1)


def beams_by_chance(
    echoes: TurnEchoes, surfaces: Indices, config: Segmentation, beam_width: float
) -> float:
    """Return of how many beams chance makes no more than one surface in such a turn.

    Echoes that have nothing to do with each other continue each other, too, the more often the
    more there are and the farther off they are: a share p of N echoes does with those of beams far
    apart, unless both are of one of the ``surfaces`` (n, k). So chance makes N p^(b - 1) chains of
    b looks. Beams closer than ``beam_width`` [rad] hear the same specks: they are one look.
    """
    count = int(np.isfinite(echoes.ranges).sum())
    by_chance = np.zeros(echoes.ranges.size, dtype=bool)
    far, step = round(_UNRELATED * len(echoes.bearings)), echoes.step
    for number in (1, 2):
        first, second = _alike(echoes, number * far, np.array([number * step]), config)
        by_chance[first[surfaces.flat[first] != surfaces.flat[second]]] = True
    share = (np.count_nonzero(by_chance) + 1) / (count + 2)
    looks = max(beam_width / step, 1.0) if step > 0.0 else 1.0
    return float(1.0 - looks * np.log(count) / np.log(share))


def _links(echoes: TurnEchoes, step: int, config: Segmentation) -> Indices:
    """Return the pairs (2, m) of flat indices that continue each other over ``step`` beams."""
    turned = _turned(echoes.bearings, step)
    near = turned <= _LARGEST_GAP * echoes.step
    return _alike(echoes, step, np.where(near, turned, np.nan), config)


def _alike(echoes: TurnEchoes, apart: int, turned: Array, config: Segmentation) -> Indices:
    """Return the pairs (2, m) of echoes ``apart`` beams that one surface may have.

    ``turned`` (n,) or (1,) [rad] is by how much the head has turned between them; NaN is too far.
    """
    there = np.isfinite(echoes.ranges)
    beams, count = there.shape
    beam, own, other = np.nonzero(there[:, :, None] & np.roll(there, -apart, axis=0)[:, None, :])
    first, second = beam * count + own, (beam + apart) % beams * count + other
    one, two = (echoes.ranges.ravel()[ends] for ends in (first, second))
    steepest = np.broadcast_to(turned, beams)[beam] * np.tan(config.steepest_incidence)
    spreads = echoes.spreads.ravel()
    reach = np.maximum(one, two) * steepest + 2.0 * np.hypot(spreads[first], spreads[second])
    away = np.abs(one - two) / reach
    levels = echoes.levels.ravel()
    unlike = np.abs(levels[first] - levels[second]) / config.level_step
    linked = (away <= 1.0) & (unlike <= 1.0)
    ends, distances = np.stack([first[linked], second[linked]]), (away + unlike)[linked]
    return ends[:, _mutually_nearest(ends, distances, there.size)]


def _turned(bearings: Array, step: int) -> Array:
    """Return the angles (n,) [rad] from each beam to that ``step`` on."""
    return np.asarray(np.abs(wrap(np.roll(bearings, -step) - bearings)))


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


def _mutually_nearest(ends: Indices, distances: Array, size: int) -> NDArray[np.bool_]:
    """Return which links (2, m) between ``size`` echoes are the shortest of both their ends."""
    are_nearest = np.ones(len(distances), dtype=bool)
    for end in ends:
        shortest = np.full(size, np.inf)
        np.minimum.at(shortest, end, distances)
        are_nearest &= distances == shortest[end]
    return are_nearest


def _table(there: NDArray[np.bool_], rows: Sequence[Array]) -> Array:
    """Return the rows as one (n, k) array where they are ``there``, filled up with NaN."""
    table = np.full(there.shape, np.nan)
    table[there] = np.concatenate(rows)
    return table
