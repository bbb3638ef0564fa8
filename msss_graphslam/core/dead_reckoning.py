# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning: the EKF of Section IV-A driven by the measurements as they come."""

import math
from collections import Counter
from copy import copy
from typing import Self

import numpy as np

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.compounding import wrap, wrap_angle
from msss_graphslam.core.kalman_filter import (
    ATTITUDE,
    COMPASS_BIAS,
    VELOCITY_ERROR,
    YAW,
    KalmanFilter,
    Z,
)
from msss_graphslam.core.types import (
    Array,
    BodyVelocity,
    Depth,
    Inertial,
    Measurement,
    Odometry,
)

__all__ = ["DeadReckoning"]

TURN_S = 10.0
"""A turn of the head, over which the published velocity's error is called slow [s]."""


class DeadReckoning:
    """Measurements in the order of their stamps in, odometry out.

    One odometry comes with every IMU sample, and with every beam while no IMU speaks. What is
    refused is counted in ``refused`` by reason.
    """

    def __init__(self, config: DeadReckoningConfig, refused: Counter[str]) -> None:
        self._config = config
        self._refused = refused
        self._pending: list[Measurement] = []
        self._filter: KalmanFilter | None = None
        self._stamp_ns = 0
        self._rates: Array | None = None
        self._inertial_ns: int | None = None
        self._compass_ns: int | None = None
        self._unsensed = 0.0
        self._measured = False
        self._refused_since: dict[str, int] = {}

    def process(self, measurement: Measurement) -> list[Odometry]:
        """Take in one measurement; return the odometry that it brings forth."""
        if self._filter is not None:
            return self._advance(self._filter, measurement)
        self._pending.append(measurement)
        span = measurement.stamp_ns - self._pending[0].stamp_ns
        return self.start() if span >= self._config.alignment_time * 1e9 else []

    def start(self) -> list[Odometry]:
        """Align with what has come so far, and work it off."""
        pending, self._pending = self._pending, []
        if not pending:
            return []
        attitude, variance = _align(pending, self._config.compass_noise)
        depth = next((entry.z for entry in pending if isinstance(entry, Depth)), 0.0)
        self._filter = KalmanFilter(self._config, depth, attitude, variance)
        self._stamp_ns = pending[0].stamp_ns
        self._measured = any(isinstance(entry, Inertial | BodyVelocity) for entry in pending)
        return [odometry for entry in pending for odometry in self._advance(self._filter, entry)]

    def resume(self, stamp_ns: int, pose: Array) -> None:
        """Go on from an earlier ``pose`` (6,) in ``odom`` instead of aligning anew.

        What happened since is bridged at the assumed speed; the compass is heard afresh.
        """
        config = self._config
        ekf = KalmanFilter(config, float(pose[2]), pose[3:], config.compass_noise**2)
        ekf.state[:2] = pose[:2]
        ekf.covariance[COMPASS_BIAS, COMPASS_BIAS] = config.compass_drift**2
        self._filter, self._stamp_ns = ekf, stamp_ns
        self._unsensed = config.sensor_timeout

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters; what has been estimated stays."""
        self._config = config
        if self._filter is not None:
            self._filter.configure(config)

    def fork(self, refused: Counter[str]) -> Self:
        """Return one that has taken in the same and goes its own way, counting elsewhere."""
        clone = copy(self)
        clone._refused = refused
        clone._pending = self._pending.copy()
        clone._refused_since = self._refused_since.copy()
        clone._filter = self._filter.copy() if self._filter else None
        return clone

    def _advance(self, ekf: KalmanFilter, measurement: Measurement) -> list[Odometry]:
        if measurement.stamp_ns < self._stamp_ns:
            self._refused["dead_reckoning_late"] += 1
            return []
        of_motion = isinstance(measurement, Inertial | BodyVelocity)
        self._measured |= of_motion
        if of_motion or not self._has_inertial(measurement):
            self._predict(ekf, measurement)
        match measurement:
            case Inertial():
                self._inertial_ns = measurement.stamp_ns
                self._update_orientation(ekf, measurement)
                return [self._odometry(ekf)]
            case Depth():
                self._update_depth(ekf, measurement)
            case BodyVelocity():
                self._update_velocity(ekf, measurement)
            case _ if not self._has_inertial(measurement):
                return [self._odometry(ekf)]
        return []

    def _predict(self, ekf: KalmanFilter, measurement: Measurement) -> None:
        interval = (measurement.stamp_ns - self._stamp_ns) * 1e-9
        rates = self._rates if self._has_inertial(measurement) else None
        self._stamp_ns, self._rates = measurement.stamp_ns, rates
        if isinstance(measurement, Inertial):
            self._rates = measurement.angular_velocity
            if rates is not None and self._rates is not None:
                rates = 0.5 * (rates + self._rates)
        if rates is None:
            self._unsensed += interval
            ekf.predict(interval, np.zeros(3), self._config.turn_rate_noise, self._drift_noise)
        else:
            ekf.predict(interval, rates, self._config.gyro_noise)

    @property
    def _drift_noise(self) -> float:
        # Deviation: a speed is assumed for a vehicle that keeps its course. Of one that no sensor
        # of motion has been heard of, nothing is known.
        return 0.0 if self._measured else self._config.drift_noise

    def _has_inertial(self, now: Measurement) -> bool:
        return self._recent(self._inertial_ns, now.stamp_ns)

    def _recent(self, last_ns: int | None, now_ns: int) -> bool:
        timeout_ns = self._config.sensor_timeout * 1e9
        return last_ns is not None and now_ns - last_ns <= timeout_ns

    def _update_orientation(self, ekf: KalmanFilter, inertial: Inertial) -> None:
        if inertial.orientation is None:
            return
        variance = self._config.compass_noise**2
        for offset, name in enumerate(("roll", "pitch")):
            index = ATTITUDE.start + offset
            difference = wrap_angle(float(inertial.orientation[offset] - ekf.state[index]))
            if self._admits(ekf, name, index, difference, variance):
                ekf.update(index, difference, variance)
        difference = wrap_angle(float(inertial.orientation[2] - ekf.state[YAW]))
        if self._admits(ekf, "yaw", YAW, difference, variance):
            ekf.update_heading(difference, variance, self._heading_gain(ekf, variance))

    def _heading_gain(self, ekf: KalmanFilter, variance: float) -> float:
        # Deviation: with equation 10 the compass, whose bias wanders by degrees, would shake the
        # heading within a turn, where a scan needs it steady. The gyro gives the short term.
        last, self._compass_ns = self._compass_ns, self._stamp_ns
        unsensed, self._unsensed = self._unsensed, 0.0
        if self._rates is None or unsensed > self._config.sensor_timeout:
            return ekf.heading_gain(variance)
        interval = 0.0 if last is None else (self._stamp_ns - last) * 1e-9
        return -math.expm1(-interval / self._config.heading_time_constant)

    def _update_velocity(self, ekf: KalmanFilter, measurement: BodyVelocity) -> None:
        # Deviation: the DVL corrects the velocity's error instead of being the control u_k, so
        # that a silent DVL leaves its last word behind, with growing uncertainty.
        for offset, axis in enumerate("xyz"):
            index = VELOCITY_ERROR.start + offset
            difference = float(measurement.velocity[offset] - ekf.velocity[offset])
            variance = float(measurement.covariance[offset, offset])
            if self._admits(ekf, f"dvl_{axis}", index, difference, variance):
                ekf.update(index, difference, variance)

    def _update_depth(self, ekf: KalmanFilter, depth: Depth) -> None:
        difference = depth.z - float(ekf.state[Z])
        variance = self._config.depth_noise**2
        if self._admits(ekf, "depth", Z, difference, variance):
            ekf.update(Z, difference, variance)

    def _admits(
        self, ekf: KalmanFilter, name: str, index: int, difference: float, variance: float
    ) -> bool:
        """Gate an innovation; a sensor that is refused for too long opens its state instead."""
        gate = self._config.innovation_gate**2 * (ekf.spread(index) + variance)
        if difference**2 > gate:
            self._refused[f"{name}_innovation"] += 1
            since = self._refused_since.setdefault(name, self._stamp_ns)
            if self._stamp_ns - since < self._config.patience * 1e9:
                return False
            self._refused[f"{name}_reset"] += 1
            ekf.open(index, difference)
        self._refused_since.pop(name, None)
        return True

    def _odometry(self, ekf: KalmanFilter) -> Odometry:
        pose = ekf.state[:6].copy()
        pose[3:] = wrap(pose[3:])
        rates = np.zeros(3) if self._rates is None else self._rates.copy()
        twist_covariance = np.zeros((6, 6))
        twist_covariance[:3, :3] = ekf.covariance[VELOCITY_ERROR, VELOCITY_ERROR]
        twist_covariance[[0, 1], [0, 1]] += self._drift_noise**2 / TURN_S
        twist_covariance[5, 5] = self._yaw_rate_variance()
        return Odometry(
            stamp_ns=self._stamp_ns,
            pose=pose,
            covariance=ekf.covariance[:6, :6].copy(),
            twist=np.concatenate([ekf.velocity, rates]),
            twist_covariance=twist_covariance,
        )

    def _yaw_rate_variance(self) -> float:
        config = self._config
        if self._rates is not None:
            return config.gyro_noise**2 / TURN_S + config.gyro_bias**2
        turned = config.turn_rate_noise**2 / TURN_S
        if not self._recent(self._compass_ns, self._stamp_ns):
            return turned
        drift = 2.0 * config.compass_drift**2 * TURN_S / config.compass_correlation_time
        return min(turned, (2.0 * config.compass_noise**2 + drift) / TURN_S**2)


def _align(pending: list[Measurement], noise: float) -> tuple[Array, float]:
    """Return the attitude (3,) at the first stamp and its variance from the samples so far."""
    samples = [entry for entry in pending if isinstance(entry, Inertial)]
    orientations = [entry.orientation for entry in samples if entry.orientation is not None]
    if not orientations:
        return np.zeros(3), 0.0
    turned, estimates, previous = np.zeros(3), [], samples[0]
    for sample in samples:
        if previous.angular_velocity is not None:
            turned = turned + previous.angular_velocity * (
                (sample.stamp_ns - previous.stamp_ns) * 1e-9
            )
        if sample.orientation is not None:
            estimates.append(sample.orientation - turned)
        previous = sample
    stacked = np.array(estimates)
    mean = np.arctan2(np.sin(stacked).mean(axis=0), np.cos(stacked).mean(axis=0))
    return mean, noise**2 / len(estimates)
