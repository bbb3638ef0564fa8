# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of dead reckoning's states, in the blocks into which it falls."""

from collections.abc import Sequence
from copy import copy
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.reckoning.attitude import Matrix
from msss_graphslam.core.reckoning.error_pairs import (
    CERTAIN,
    Four,
    conditioned,
    followed,
    propagated,
    widened,
)
from msss_graphslam.core.types import Array

__all__ = ["SIZE", "Derivatives", "PairedCovariance"]

SIZE = 10
X, Y, Z, ROLL, PITCH, YAW, SURGE, SWAY, HEAVE, COMPASS_BIAS = range(SIZE)
HEADING = 1
MEMBERS = ((ROLL, PITCH), (YAW, COMPASS_BIAS), (SURGE, SWAY), (Z, HEAVE))
"""The states a and b of each pair."""

PLACES = {
    index: (number, index == members[1])
    for number, members in enumerate(MEMBERS)
    for index in members
}
"""The pair of each state, and whether it is its b."""

_NONE: Four = (0.0, 0.0, 0.0, 0.0)


class Derivatives(NamedTuple):
    """The parts of F, equation 8, over an ``interval`` [s].

    Its blocks are ``interval`` times those named here, rows by columns, beside 1 on the diagonal.
    ``velocity_decay`` and ``compass_decay`` are the Gauss-Markov factors of the slow errors and
    stand on the diagonal themselves.
    """

    interval: float
    position_by_attitude: Matrix
    position_by_velocity: Matrix
    attitude_by_attitude: Matrix
    velocity_decay: float
    compass_decay: float


class PairedCovariance:
    """Covariance (10, 10) of position, attitude, velocity's error and compass' bias.

    It begins with 0; ``widen`` says how well each state is known.
    """

    def __init__(self) -> None:
        self._pairs = [CERTAIN] * len(MEMBERS)

    def copy(self) -> Self:
        """Return one that goes its own way."""
        clone = copy(self)
        clone._pairs = self._pairs.copy()
        return clone

    def widen(self, index: int, variance: float) -> None:
        """Add to the variance of one state other than x and y."""
        number, second = PLACES[index]
        self._pairs[number] = widened(self._pairs[number], second, variance)

    def predict(self, by: Derivatives, noise: Sequence[float]) -> None:
        """Propagate by F, with ``noise`` (10,) on the diagonal of Q: equation 8."""
        # Deviation: depth is tied to heave alone and yaw to itself. Through a degree of roll or
        # pitch that the AHRS has wrong, the full F lets the pressure sensor speak of the forward
        # speed and the inclinometers of the heading, both wrongly.
        time, attitude, velocity, turning, decay, compass_decay = by
        (x_roll, x_pitch, x_yaw), (y_roll, y_pitch, y_yaw), _ = attitude
        (x_surge, x_sway, _), (y_surge, y_sway, _), (_, _, z_heave) = velocity
        (roll, roll_pitch, _), (pitch_roll, pitch, _), _ = turning
        on_x, on_y, on_z, on_roll, on_pitch, on_yaw, on_surge, on_sway, on_heave, on_bias = noise
        tilt, heading, drift, vertical = self._pairs
        self._pairs = [
            propagated(
                tilt,
                (time * x_roll, time * x_pitch, time * y_roll, time * y_pitch),
                (1.0 + time * roll, time * roll_pitch, time * pitch_roll, 1.0 + time * pitch),
                (0.0, 0.0, on_roll, on_pitch),
            ),
            propagated(
                heading,
                (time * x_yaw, 0.0, time * y_yaw, 0.0),
                (1.0, 0.0, 0.0, compass_decay),
                (0.0, 0.0, on_yaw, on_bias),
            ),
            propagated(
                drift,
                (time * x_surge, time * x_sway, time * y_surge, time * y_sway),
                (decay, 0.0, 0.0, decay),
                (on_x, on_y, on_surge, on_sway),
            ),
            propagated(
                vertical, _NONE, (1.0, time * z_heave, 0.0, decay), (0.0, 0.0, on_z, on_heave)
            ),
        ]

    def condition(self, index: int, variance: float) -> tuple[tuple[int, ...], Four]:
        """Take in a measurement of one state; return the states that it moves and their gains."""
        number, second = PLACES[index]
        gains, self._pairs[number] = conditioned(self._pairs[number], second, variance)
        return (X, Y, *MEMBERS[number]), gains

    def follow_heading(self, gain: float, variance: float) -> None:
        """Take in that the yaw alone follows a compass, its bias included, by ``gain``."""
        self._pairs[HEADING] = followed(self._pairs[HEADING], gain, variance)

    def variance(self, index: int) -> float:
        """Return the variance of one state other than x and y."""
        number, second = PLACES[index]
        return self._pairs[number][9 if second else 7]

    @property
    def of_heading(self) -> tuple[float, float, float]:
        """Variance of the yaw, its covariance with the compass' bias, variance of the bias."""
        return self._pairs[HEADING][7:]

    @property
    def matrix(self) -> Array:
        """The whole (10, 10)."""
        tilt, heading, drift, vertical = self._pairs
        of_x = tilt[0] + heading[0] + drift[0] + vertical[0]
        shared = tilt[1] + heading[1] + drift[1] + vertical[1]
        of_y = tilt[2] + heading[2] + drift[2] + vertical[2]
        numbers = np.array([*tilt, *heading, *drift, *vertical, of_x, shared, of_y, 0.0])
        return np.asarray(numbers[_LAID_OUT])


def _laid_out() -> NDArray[np.intp]:
    """Return by entry (10, 10) which of four pairs' numbers it is, behind them x and y, and 0."""
    size = len(CERTAIN)
    of_x, shared, of_y, nothing = range(len(MEMBERS) * size, len(MEMBERS) * size + 4)
    places = np.full((SIZE, SIZE), nothing)
    places[X, X], places[X, Y], places[Y, Y] = of_x, shared, of_y
    for number, (a, b) in enumerate(MEMBERS):
        entries = ((X, a), (Y, a), (X, b), (Y, b), (a, a), (a, b), (b, b))
        for place, (row, column) in enumerate(entries, start=number * size + 3):
            places[row, column] = places[column, row] = place
    places[Y, X] = shared
    return places


_LAID_OUT = _laid_out()
