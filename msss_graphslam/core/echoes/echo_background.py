# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a beam holds without any surface: noise and ringing, learned while the head turns.

Both are running quantiles by stochastic approximation (H. Robbins and S. Monro, 1951): the
estimate goes up by a fixed step where the data lie above it and down where they lie below, so an
echo moves it no further than noise does, however strong it is.
"""

import numpy as np

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.types import Array

__all__ = ["NoiseFloor", "Ringing"]


class NoiseFloor:
    """Median level of the noise as a function of range [dB].

    Time-varied gain raises the noise with the range, so the floor is made non-decreasing: a wall
    that stays at one range cannot lift it, because behind the wall it is low again.
    """

    _FIRST_STEP = 5.0
    _LAST_STEP = 0.1

    def __init__(self, bins: int) -> None:
        self._median = np.zeros(bins)
        self._beams = 0

    def update(self, levels: Array) -> Array:
        """Take the ``levels`` (b, n) [dB] of beams in, one by one; return their floors (b, n)."""
        medians, step = np.empty(levels.shape), np.empty(levels.shape[1])
        for beam, median in zip(levels, medians, strict=True):
            self._beams += 1
            np.sign(np.subtract(beam, self._median, out=step), out=step)
            step *= max(self._FIRST_STEP / self._beams, self._LAST_STEP)
            self._median += step
            median[:] = self._median
        return np.minimum.accumulate(medians[:, ::-1], axis=1)[:, ::-1]


class Ringing:
    """Level under which a near echo may be the transducer's or the hull's, by range and bearing.

    The hull is fixed in the sensor frame, hence the bearing. A wall before a vehicle at rest is
    so, too, therefore what is learned never exceeds the ringing that the configuration admits;
    that is also what the first turn starts with.
    """

    _SECTORS = 50
    _RISE = 3.0
    _FALL = 0.1
    _MARGIN = 6.0

    def __init__(self, ranges: Array, config: Segmentation) -> None:
        near = ranges[ranges < config.ringing_range]
        fade = 3.0 * (1.0 - near / config.ringing_range)
        self._highest = np.where(
            near < config.hull_distance,
            config.transducer_ringing,
            config.hull_ringing * np.minimum(fade, 1.0),
        )
        self._levels = np.tile(self._highest, (self._SECTORS, 1))

    def update(self, levels: Array, bearings: Array) -> Array:
        """Take beams in, one by one; return the ringing (b, m) of their first bins [dB].

        Their ``levels`` are (b, n) [dB], their ``bearings`` (b,) [rad].
        """
        near = levels[:, : self._highest.size] + self._MARGIN
        learned = np.empty(near.shape)
        turns = bearings / (2.0 * np.pi) % 1.0
        sectors = (turns * self._SECTORS).astype(np.intp) % self._SECTORS
        for number, sector in enumerate(sectors.tolist()):
            ringing = self._levels[sector]
            ringing += np.where(near[number] > ringing, self._RISE, -self._FALL)
            np.minimum(ringing, self._highest, out=ringing)
            learned[number] = ringing
        return learned
