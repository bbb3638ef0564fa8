# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beam segmentation by a dynamic threshold (Section III-C): an echo profile becomes ranges."""

import math

import numpy as np

from msss_graphslam.config.groups import Segmentation, Sonar
from msss_graphslam.core.echo_background import NoiseFloor, Ringing
from msss_graphslam.core.echo_extraction import (
    FULL_SCALE,
    Echoes,
    find_echoes,
    smoothing_kernel,
    to_decibels,
)
from msss_graphslam.core.ghost_rejection import reject_ghosts
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
        if not _is_audible(beam) or not self._takes(beam.ranges):
            return _empty(beam)
        levels = to_decibels(beam.intensities, self._scale)
        levels = np.convolve(levels, self._kernel, "same") / self._coverage
        config = self._config
        echoes = find_echoes(
            levels, self._thresholds(levels, beam.bearing), config.echo_drop, config.dynamic_range
        )
        return self._reading(beam, echoes.first(config.candidates))

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
        self._coverage = np.convolve(np.ones(ranges.size), self._kernel, "same")
        self._floor = NoiseFloor(ranges.size)
        self._ringing = Ringing(ranges, self._config)

    def _thresholds(self, levels: Array, bearing: float) -> Array:
        thresholds = self._floor.update(levels) + self._config.echo_contrast
        ringing = self._ringing.update(levels, bearing)
        near = thresholds[: ringing.size]
        np.maximum(near, ringing, out=near)
        return thresholds

    def _reading(self, beam: Beam, echoes: Echoes) -> Reading:
        """Place an echo midway between its edges, where the beam's axis meets the surface."""
        # The leading edge alone comes early: by half the pulse, and where the incidence is
        # oblique by half the spread of the beam's footprint, which bends walls inwards.
        middle = 0.5 * (echoes.leading + echoes.trailing)
        codes = beam.intensities[echoes.peaks]
        return Reading(
            stamp_ns=beam.stamp_ns,
            bearing=beam.bearing,
            ranges=np.interp(middle, self._bins, self._ranges),
            variances=self._variances(echoes),
            levels=echoes.levels,
            maximum_range=float(self._ranges[-1]),
            saturated=bool((codes >= FULL_SCALE).any()),
        )

    def _variances(self, echoes: Echoes) -> Array:
        """Return the variances (k,) [m^2] that quantisation, relief and speckle make together.

        Speckle, half of whose power the smoothing takes, moves each of the two edges by its level
        over the edge's slope.
        """
        half_length = 0.5 * (echoes.trailing - echoes.leading) * self._bin_size
        jitter = half_length * self._config.speckle / self._config.echo_drop
        return self._smallest_variance + 0.25 * jitter**2


def _is_audible(beam: Beam) -> bool:
    return bool(
        beam.ranges.shape == beam.intensities.shape
        and math.isfinite(beam.bearing)
        and (beam.intensities > 0.0).any()
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
