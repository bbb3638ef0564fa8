# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sidelobe ring: at what range the nearest wall shows over all bearings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter, reject_ghosts
from msss_graphslam.core.echoes.echo_extraction import to_decibels
from msss_graphslam.core.types import Array, Beam
from msss_graphslam.simulation.ray_casting import Walls

__all__ = ["WINDOW", "Windows", "nearest_wall", "ring_range", "windows_of"]

WINDOW = 25
"""Beams that are looked at together: an eighth of a turn, about a second."""

BLANK = 1.4
"""So far the hull may ring [m]."""

RISE = 8.0
"""By how much the ring stands out of what is before it [dB]."""

EDGE = 6.0
"""How far below its crest the leading edge counts [dB]."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Windows of beams: middle ``stamps_ns`` (n,), ``bearings`` (n,) [rad], ``rings`` (n,) [m].

    A ring is NaN where none stands out. ``echoes`` (n,) [m] are the nearest echoes of the turns
    that the windows are in, ghosts left out: heard up to a turn before or after.
    """

    stamps_ns: NDArray[np.int64]
    bearings: Array
    rings: Array
    echoes: Array


def windows_of(beams: Sequence[Beam]) -> Windows:
    """Look for the ring in one window of beams after the other."""
    half = WINDOW // 2
    middles = range(half, len(beams) - half, WINDOW)
    rings = [_ring_of(beams[middle - half : middle + half + 1]) for middle in middles]
    return Windows(
        stamps_ns=np.array([beams[middle].stamp_ns for middle in middles], dtype=np.int64),
        bearings=np.array([beams[middle].bearing for middle in middles]),
        rings=np.array(rings),
        echoes=_nearest_echoes(beams)[np.array(middles, dtype=np.intp)],
    )


def _ring_of(beams: Sequence[Beam]) -> float:
    """Return the ring's range [m] in beams of a Micron."""
    levels = to_decibels(np.array([beam.intensities for beam in beams]), "db80")
    return ring_range(levels, beams[0].ranges)


def ring_range(levels: Array, ranges: Array) -> float:
    """Return where the first rise begins that most of the beams share [m], NaN if there is none.

    ``levels`` (w, k) [dB] of beams next to each other, ``ranges`` (k,) [m] of their bins. A main
    beam that meets a wall does so behind the ring, or where it looks at the nearest wall in it.
    """
    common = np.median(levels, axis=0)
    heard = ranges > BLANK
    lowest = np.minimum.accumulate(np.where(heard, common, np.inf))
    risen = np.flatnonzero(heard & (common - np.where(heard, lowest, 0.0) > RISE))
    if not len(risen):
        return float("nan")
    crest = int(risen[0])
    while crest + 1 < len(common) and common[crest + 1] > common[crest]:
        crest += 1
    wanted = common[crest] - EDGE
    edge = crest
    while edge > 0 and common[edge - 1] > wanted:
        edge -= 1
    if edge == 0:
        return float(ranges[0])
    return float(np.interp(wanted, common[edge - 1 : edge + 1], ranges[edge - 1 : edge + 1]))


def nearest_wall(positions: Array, walls: Walls) -> tuple[Array, Array]:
    """Return distances (n,) [m] and directions (n,) of the walls nearest to positions (n, 2)."""
    offsets = positions[:, None] - walls.starts
    lengths = np.sum(walls.edges**2, axis=1)
    along = np.clip(np.sum(offsets * walls.edges, axis=2) / lengths, 0.0, 1.0)
    towards = along[..., None] * walls.edges - offsets
    distances = np.hypot(towards[..., 0], towards[..., 1])
    chosen = np.arange(len(positions)), distances.argmin(axis=1)
    nearest = towards[chosen]
    return distances[chosen], np.arctan2(nearest[:, 1], nearest[:, 0])


def _nearest_echoes(beams: Sequence[Beam]) -> Array:
    """Return for each beam (n,) the nearest echo of its turn [m], NaN where there is none."""
    config = Configuration()
    readings = BeamSegmenter(config.sonar, config.segmentation).segment_all(beams)
    steps = np.abs(wrap(np.diff([beam.bearing for beam in beams])))
    turn = round(2.0 * np.pi / float(np.median(steps)))
    nearest = np.full(len(beams), np.nan)
    for begin in range(0, len(beams), turn):
        kept = reject_ghosts(
            readings[begin : begin + turn], config.segmentation, config.sonar.beam_width
        )
        ranges = [reading.ranges.min() for reading in kept if reading.ranges.size]
        nearest[begin : begin + turn] = min(ranges, default=np.nan)
    return nearest
