# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a mechanical scanning sonar."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.errors import UserError

__all__ = ["SOUND_SPEED", "Rotation", "SonarSettings"]

SOUND_SPEED = 1500.0
"""In the simulated water [m/s]."""
_TURN_DECIMALS = 10


class Rotation(StrEnum):
    """The sense in which the head turns, seen from above."""

    COUNTER_CLOCKWISE = "ccw"
    CLOCKWISE = "cw"


@dataclass(frozen=True, slots=True)
class SonarSettings:
    """What the head is told to do, and how it sits on the vehicle.

    Angles in rad, bearings counter-clockwise from ahead; ``maximum_range`` in m,
    ``beam_period`` in s. A ``sector`` below a full turn is swept to and fro about
    ``sector_centre``. ``hull_sector`` is the part of the turn, about astern, in which the hull
    rings and mirrors the scene; ``hull_shadow`` that in which it hides it, too. ``mount_yaw`` is
    the head's true misalignment.

    Raises UserError where a value makes no sense.
    """

    maximum_range: float
    bins: int
    step: float
    beam_period: float
    rotation: Rotation = Rotation.COUNTER_CLOCKWISE
    beam_width: float = np.radians(3.0)
    sector: float = 2.0 * np.pi
    sector_centre: float = 0.0
    hull_sector: float = np.radians(60.0)
    hull_shadow: float = 0.0
    mount_yaw: float = 0.0

    def __post_init__(self) -> None:
        for name in ("maximum_range", "bins", "step", "beam_period", "beam_width", "sector"):
            if not getattr(self, name) > 0.0:
                raise UserError(f"sonar {name} = {getattr(self, name)!r}: must be positive")
        if self.step > self.sector or self.sector > 2.0 * np.pi:
            raise UserError("sonar sector: must be at least one step and at most a full turn")
        if 2.0 * self.maximum_range / SOUND_SPEED > self.beam_period:
            raise UserError(
                f"sonar beam_period = {self.beam_period:g} s: too short for echoes from"
                f" {self.maximum_range:g} m"
            )

    @property
    def bin_length(self) -> float:
        """The length of a bin [m]."""
        return self.maximum_range / self.bins

    @property
    def ranges(self) -> Array:
        """The bins' centres (bins,) [m]."""
        return np.asarray(self.bin_length * (np.arange(self.bins) + 0.5), dtype=float)

    def bearings(self, count: int, first_step: int = 0) -> Array:
        """Return the bearings (count,) [rad] in [-pi, pi) of consecutive beams.

        ``first_step`` is the number of steps already done when the first beam is sent.
        """
        sign = 1.0 if self.rotation is Rotation.COUNTER_CLOCKWISE else -1.0
        steps = np.arange(first_step, first_step + count)
        if self.sector < 2.0 * np.pi:
            last = int(self.sector / self.step)
            swept = last - np.abs(np.mod(steps, 2 * last) - last)
            angles = self.sector_centre + sign * (swept * self.step - 0.5 * self.sector)
        else:
            angles = sign * steps * self.step
        turns = np.round(angles / (2.0 * np.pi), _TURN_DECIMALS)
        return np.asarray(2.0 * np.pi * (turns - np.floor(turns + 0.5)))
