# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beam segmentation by a dynamic threshold (Section III-C): an echo profile becomes ranges."""

from collections.abc import Iterator, Sequence

import numpy as np

from msss_graphslam.config.groups import Segmentation, Sonar
from msss_graphslam.core.echoes.echo_background import NoiseFloor, Ringing
from msss_graphslam.core.echoes.echo_extraction import (
    FULL_SCALE,
    Echoes,
    find_echoes,
    smooth,
    smoothing_kernel,
    to_decibels,
)
from msss_graphslam.core.echoes.ghost_rejection import reject_ghosts
from msss_graphslam.core.types import Array, Beam, Reading

__all__ = ["BeamSegmenter", "reject_ghosts"]


class BeamSegmenter:
    """Turns beams into candidate echoes; learns the background from the beams that it has seen.

    An echo must exceed what noise and ringing hold at its range, and come near the strongest echo
    of its beam.
    """

    # Deviation: the paper takes the one point that thresholding leaves; here every significant
    # echo is a candidate and the nearest comes first, as multipath may be stronger than the wall.

    def __init__(self, sonar: Sonar, config: Segmentation) -> None:
        self._scale = sonar.intensity_scale
        self._config = config
        self._ranges = np.zeros(0)

    def segment(self, beam: Beam) -> Reading:
        """Return the nearest echoes of ``beam``.

        It is ``empty`` when the head heard nothing: fewer than two bins, or no code but 0.
        """
        return self.segment_all([beam])[0]

    def segment_all(self, beams: Sequence[Beam]) -> list[Reading]:
        """Return the readings of the ``beams``: the same as of one by one, in half the time."""
        return [reading for alike in _runs(beams) for reading in self._segment_alike(alike)]

    def _segment_alike(self, beams: Sequence[Beam]) -> list[Reading]:
        """Return the readings of beams of the same bins."""
        codes = np.array([beam.intensities for beam in beams], dtype=float)
        bearings = np.array([beam.bearing for beam in beams])
        audible = (codes > 0.0).any(axis=1) & np.isfinite(bearings)
        ranges = beams[0].ranges
        if ranges.shape != codes.shape[1:] or not audible.any() or not self._takes(ranges):
            return [_empty(beam) for beam in beams]
        if audible.all():
            return self._read(beams, codes, bearings)
        flags = audible.tolist()
        heard = [beam for beam, is_audible in zip(beams, flags, strict=True) if is_audible]
        read = iter(self._read(heard, codes[audible], bearings[audible]))
        return [
            next(read) if is_audible else _empty(beam)
            for beam, is_audible in zip(beams, flags, strict=True)
        ]

    def _read(self, beams: Sequence[Beam], codes: Array, bearings: Array) -> list[Reading]:
        """Return the readings of beams with echoes, learning from them; ``codes`` are (b, n)."""
        config = self._config
        levels = smooth(to_decibels(codes, self._scale), self._kernel) / self._coverage
        thresholds = self._thresholds(levels, bearings)
        echoes = find_echoes(levels, thresholds, config.echo_drop, config.dynamic_range)
        return self._readings(beams, codes, echoes.first(config.candidates))

    def _takes(self, ranges: Array) -> bool:
        """Whether the bins can be read; new ones, if they can, start the learning anew."""
        if np.array_equal(ranges, self._ranges):
            return True
        if ranges.size < 2 or ranges[0] < 0.0 or not np.isfinite(ranges[-1]):
            return False
        if not np.all(ranges[1:] > ranges[:-1]):
            return False
        self._start(ranges)
        return True

    def _start(self, ranges: Array) -> None:
        """Forget what was learned with other settings of the head."""
        self._ranges = ranges.copy()
        self._bins = np.arange(ranges.size)
        self._bin_size = float(np.median(np.diff(ranges)))
        self._smallest_variance = self._bin_size**2 / 12.0 + self._config.surface_roughness**2
        self._kernel = smoothing_kernel(self._config.echo_length, self._bin_size, ranges.size)
        self._coverage = smooth(np.ones((1, ranges.size)), self._kernel)
        self._floor = NoiseFloor(ranges.size)
        self._ringing = Ringing(ranges, self._config)

    def _thresholds(self, levels: Array, bearings: Array) -> Array:
        thresholds = self._floor.update(levels) + self._config.echo_contrast
        ringing = self._ringing.update(levels, bearings)
        near = thresholds[:, : ringing.shape[1]]
        np.maximum(near, ringing, out=near)
        return thresholds

    def _readings(self, beams: Sequence[Beam], codes: Array, echoes: Echoes) -> list[Reading]:
        """Place an echo midway between its edges, where the beam's axis meets the surface."""
        # The leading edge alone comes early: by half the pulse, and where the incidence is
        # oblique by half the spread of the beam's footprint, which bends walls inwards.
        middle = 0.5 * (echoes.leading + echoes.trailing)
        ranges = np.interp(middle, self._bins, self._ranges)
        variances = self._variances(echoes)
        saturated = codes[echoes.profiles, echoes.peaks] >= FULL_SCALE
        flags = np.bincount(echoes.profiles[saturated], minlength=len(beams)) > 0
        ends = np.searchsorted(echoes.profiles, np.arange(len(beams) + 1)).tolist()
        maximum_range = float(self._ranges[-1])
        return [
            Reading(
                beam.stamp_ns,
                beam.bearing,
                ranges[begin:end],
                variances[begin:end],
                echoes.levels[begin:end],
                maximum_range,
                flag,
            )
            for beam, begin, end, flag in zip(
                beams, ends[:-1], ends[1:], flags.tolist(), strict=True
            )
        ]

    def _variances(self, echoes: Echoes) -> Array:
        """Return the variances (k,) [m^2] that quantisation, relief and speckle make together.

        Speckle, half of whose power the smoothing takes, moves each of the two edges by its level
        over the edge's slope.
        """
        half_length = 0.5 * (echoes.trailing - echoes.leading) * self._bin_size
        jitter = half_length * self._config.speckle / self._config.echo_drop
        return self._smallest_variance + 0.25 * jitter**2


def _runs(beams: Sequence[Beam]) -> Iterator[Sequence[Beam]]:
    """Cut the beams where their bins change."""
    start = 0
    for place in range(1, len(beams)):
        if not _are_alike(beams[place - 1], beams[place]):
            yield beams[start:place]
            start = place
    if beams:
        yield beams[start:]


def _are_alike(first: Beam, second: Beam) -> bool:
    return first.intensities.shape == second.intensities.shape and (
        first.ranges is second.ranges or np.array_equal(first.ranges, second.ranges)
    )


def _empty(beam: Beam) -> Reading:
    last = float(beam.ranges[-1]) if beam.ranges.size else 0.0
    return Reading(
        stamp_ns=beam.stamp_ns,
        bearing=beam.bearing,
        ranges=np.zeros(0),
        variances=np.zeros(0),
        levels=np.zeros(0),
        maximum_range=last if np.isfinite(last) else 0.0,
        empty=True,
    )
