# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a sonar head, seen from its beams."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Beam

__all__ = ["SonarObserver", "SonarSettings"]

# Share of the steps that go one way in a continuous rotation; a sector's sweeps go either way.
_ONE_WAY = 0.95


@dataclass(frozen=True, slots=True)
class SonarSettings:
    """What a head was set to, as most of its beams say.

    ``step`` [rad] is without sign; ``direction`` is ``counter-clockwise``, ``clockwise``,
    ``sector`` or ``still``; ``turn_time`` [s] is a full turn's, None unless the head turns
    continuously.
    ``settings_changes`` counts the beams whose range or bins differ from their predecessor's.
    """

    beams: int
    maximum_range: float
    bins: int
    bin_length: float
    step: float
    beam_period: float
    direction: str
    turn_time: float | None
    turns: float
    largest_code: float
    settings_changes: int


class SonarObserver:
    """Takes beams one by one and keeps what the settings need."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._bearings: list[float] = []
        self._profiles: list[tuple[int, float, float]] = []
        self._largest_code = 0.0

    def take(self, beam: Beam) -> None:
        """Add the next beam."""
        ranges = beam.ranges
        bin_length = float(ranges[-1] - ranges[0]) / max(len(ranges) - 1, 1)
        self._stamps.append(beam.stamp_ns)
        self._bearings.append(beam.bearing)
        self._profiles.append((len(ranges), round(float(ranges[-1]), 3), round(bin_length, 5)))
        self._largest_code = max(self._largest_code, float(beam.intensities.max()))

    def settings(self) -> SonarSettings | None:
        """Return the settings, or None without a beam."""
        if not self._profiles:
            return None
        steps = wrap(np.diff(self._bearings))
        step = _median(np.abs(steps))
        period = _median(np.diff(self._stamps) * 1e-9)
        direction = _direction(steps)
        continuous = direction in ("clockwise", "counter-clockwise")
        bins, maximum_range, bin_length = Counter(self._profiles).most_common(1)[0][0]
        return SonarSettings(
            beams=len(self._profiles),
            maximum_range=maximum_range,
            bins=bins,
            bin_length=bin_length,
            step=step,
            beam_period=period,
            direction=direction,
            turn_time=2.0 * pi / step * period if continuous else None,
            turns=float(np.abs(steps).sum()) / (2.0 * pi),
            largest_code=self._largest_code,
            settings_changes=_changes(self._profiles),
        )


def _direction(steps: Array) -> str:
    moving = steps[steps != 0.0]
    if moving.size == 0:
        return "still"
    left = float((moving > 0.0).mean())
    if left > _ONE_WAY:
        return "counter-clockwise"
    return "clockwise" if left < 1.0 - _ONE_WAY else "sector"


def _median(values: NDArray[np.floating[Any]]) -> float:
    return float(np.median(values)) if len(values) else 0.0


def _changes(profiles: Sequence[tuple[int, float, float]]) -> int:
    return sum(a != b for a, b in pairwise(profiles))
