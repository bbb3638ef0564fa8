# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How the vehicle really moves: along its path, at an unsteady speed, slipping sideways."""

from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.processes import GaussMarkov
from msss_graphslam.simulation.streams import stream

__all__ = ["Motion", "drive"]

_PERIOD = 0.02
_MEAN_SPEED, _LEAST_SPEED = 0.10, 0.02
_SPEED = GaussMarkov(0.02, 100.0, lag=3.0)
_DISTURBANCES = {
    "side slip": GaussMarkov(np.radians(4.0), 60.0, lag=3.0),
    "heave": GaussMarkov(0.1, 60.0, lag=5.0),
    "roll": GaussMarkov(np.radians(2.0), 4.0, lag=1.0),
    "pitch": GaussMarkov(np.radians(1.5), 4.0, lag=1.0),
}
_WANDER_DEVIATION = 0.15
_WANDER_WAVELENGTHS = (10.0, 40.0)
_WANDER_WAVES = 6
_WANDER_TAPER = 5.0


@dataclass(frozen=True, slots=True)
class Motion:
    """The true motion at ``times`` (n,) [s]: ``poses`` (n, 6) as x, y, z, roll, pitch, yaw.

    The yaw is continuous, not wrapped. ``period`` is the step [s].
    """

    times: Array
    poses: Array
    period: float

    @property
    def duration(self) -> float:
        """The time from the first to the last pose [s]."""
        return float(self.times[-1])

    def at(self, times: Array) -> Array:
        """Return the poses (k, 6) at ``times`` (k,) [s] by linear interpolation."""
        return self._interpolate(self.poses, times)

    def velocities_at(self, times: Array) -> Array:
        """Return the linear velocities (k, 3) in the levelled body frame [m/s]."""
        rates = self._interpolate(np.gradient(self.poses, self.period, axis=0), times)
        yaw = self.at(times)[:, 5]
        cosine, sine = np.cos(yaw), np.sin(yaw)
        surge = cosine * rates[:, 0] + sine * rates[:, 1]
        sway = cosine * rates[:, 1] - sine * rates[:, 0]
        return np.stack([surge, sway, rates[:, 2]], axis=1)

    def angular_velocities_at(self, times: Array) -> Array:
        """Return the angular velocities (k, 3) in the body frame [rad/s]."""
        rates = self._interpolate(np.gradient(self.poses[:, 3:], self.period, axis=0), times)
        roll, pitch = self.at(times)[:, 3:5].T
        return np.stack(
            [
                rates[:, 0] - np.sin(pitch) * rates[:, 2],
                np.cos(roll) * rates[:, 1] + np.sin(roll) * np.cos(pitch) * rates[:, 2],
                np.cos(roll) * np.cos(pitch) * rates[:, 2] - np.sin(roll) * rates[:, 1],
            ],
            axis=1,
        )

    def _interpolate(self, values: Array, times: Array) -> Array:
        return np.stack([np.interp(times, self.times, column) for column in values.T], axis=1)


def drive(path: Path, laps: int, depth: float, seed: int, scale: float) -> Motion:
    """Return the motion of a vehicle that a pilot steers along ``laps`` of the ``path``.

    The speed and the side slip are Gauss-Markov processes, ``scale`` times as large as those
    that give the dead reckoning of the paper's Section VIII-A. The pilot holds the track, so
    the slip shows in the heading; it ends where it began, ``depth`` [m] under the surface.
    """
    length = laps * path.lap_length
    distances = _travelled(length, seed, scale)
    count = len(distances)
    positions = _track(path, distances, length, seed)
    velocities = np.gradient(positions, _PERIOD, axis=0)
    course = np.unwrap(np.arctan2(velocities[:, 1], velocities[:, 0]))
    slip, heave, roll, pitch = (
        process.sample(stream(seed, source), count, _PERIOD)
        for source, process in _DISTURBANCES.items()
    )
    poses = np.column_stack([positions, heave - depth, roll, pitch, course - scale * slip])
    return Motion(_PERIOD * np.arange(count, dtype=float), poses, _PERIOD)


def _travelled(length: float, seed: int, scale: float) -> Array:
    """Return the distance [m] travelled at every step, until ``length`` is reached."""
    longest = int(np.ceil(length / (_LEAST_SPEED * _PERIOD)))
    speed = _MEAN_SPEED + scale * _SPEED.sample(stream(seed, "speed"), longest, _PERIOD)
    distances = np.cumsum(_PERIOD * np.maximum(speed, _LEAST_SPEED))
    distances -= distances[0]
    return distances[: np.searchsorted(distances, length)]


def _track(path: Path, distances: Array, length: float, seed: int) -> Array:
    """Return positions (n, 2): the path, and the pilot's wandering about it between its ends."""
    generator = stream(seed, "pilot")
    shortest, longest = _WANDER_WAVELENGTHS
    wavelengths = generator.uniform(shortest, longest, _WANDER_WAVES)
    phases = generator.uniform(0.0, 2.0 * np.pi, _WANDER_WAVES)
    waves = np.sin(2.0 * np.pi * distances[:, None] / wavelengths + phases)
    wander = _WANDER_DEVIATION * np.sqrt(2.0 / _WANDER_WAVES) * waves.sum(axis=1)
    to_ends = np.minimum(distances, length - distances)
    taper = np.sin(0.5 * np.pi * np.minimum(to_ends / _WANDER_TAPER, 1.0)) ** 2
    positions, normals = path.at(distances)
    return np.asarray(positions + (taper * wander)[:, None] * normals)
