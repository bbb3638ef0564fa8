# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning: the EKF of Section IV-A driven by the measurements as they come."""

import math
from collections import Counter
from copy import copy
from typing import Self

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.reckoning.alignment import align
from msss_graphslam.core.reckoning.gated_updates import GatedUpdates
from msss_graphslam.core.reckoning.kalman_filter import (
    COMPASS_BIAS,
    KalmanFilter,
)
from msss_graphslam.core.reckoning.reckoned_odometry import odometry_of, yaw_rate_variance
from msss_graphslam.core.types import (
    Array,
    BodyVelocity,
    Depth,
    Inertial,
    Measurement,
    Odometry,
)

__all__ = ["DeadReckoning"]

_AT_REST = [0.0, 0.0, 0.0]


class DeadReckoning:
    """Measurements in the order of their stamps in, odometry out.

    One odometry comes with every IMU sample, and with every beam while no IMU speaks. What is
    refused is counted in ``refused`` by reason.
    """

    def __init__(self, config: DeadReckoningConfig, refused: Counter[str]) -> None:
        self._config = config
        self._refused = refused
        self._updates = GatedUpdates(config, refused)
        self._pending: list[Measurement] = []
        self._filter: KalmanFilter | None = None
        self._stamp_ns = 0
        self._rates: list[float] | None = None
        self._inertial_ns: int | None = None
        self._compass_ns: int | None = None
        self._unsensed = 0.0
        self._measured = False

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
        attitude, variance = align(pending, self._config)
        depth = next((entry.z for entry in pending if isinstance(entry, Depth)), 0.0)
        self._filter = KalmanFilter(self._config, depth, attitude.tolist(), variance)
        self._stamp_ns = pending[0].stamp_ns
        self._measured = any(isinstance(entry, Inertial | BodyVelocity) for entry in pending)
        return [odometry for entry in pending for odometry in self._advance(self._filter, entry)]

    def resume(self, stamp_ns: int, pose: Array) -> None:
        """Go on from an earlier ``pose`` (6,) in ``odom`` instead of aligning anew.

        What happened since is bridged at the assumed speed; the compass is heard afresh.
        """
        config = self._config
        x, y, z, *attitude = pose.tolist()
        ekf = KalmanFilter(config, z, attitude, config.compass_noise**2)
        ekf.state[:2] = x, y
        ekf.open(COMPASS_BIAS, config.compass_drift)
        self._filter, self._stamp_ns = ekf, stamp_ns
        self._unsensed = config.sensor_timeout

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters; what has been estimated stays."""
        self._config = config
        self._updates.configure(config)
        if self._filter is not None:
            self._filter.configure(config)

    def fork(self, refused: Counter[str]) -> Self:
        """Return one that has taken in the same and goes its own way, counting elsewhere."""
        clone = copy(self)
        clone._refused = refused
        clone._updates = self._updates.fork(refused)
        clone._pending = self._pending.copy()
        clone._filter = self._filter.copy() if self._filter else None
        return clone

    def _advance(self, ekf: KalmanFilter, measurement: Measurement) -> list[Odometry]:
        stamp_ns = measurement.stamp_ns
        if stamp_ns < self._stamp_ns:
            self._refused["dead_reckoning_late"] += 1
            return []
        has_inertial = self._recent(self._inertial_ns, stamp_ns)
        if isinstance(measurement, Inertial):
            self._measured = True
            self._predict(ekf, stamp_ns, has_inertial, measurement)
            self._inertial_ns = stamp_ns
            self._update_orientation(ekf, measurement)
            return [self._odometry(ekf)]
        self._measured |= isinstance(measurement, BodyVelocity)
        if not has_inertial:
            # While the IMU speaks it alone predicts: it knows how the rates have changed.
            self._predict(ekf, stamp_ns, has_inertial)
        if isinstance(measurement, BodyVelocity):
            self._updates.velocity(ekf, measurement, self._stamp_ns)
            return []
        if isinstance(measurement, Depth):
            self._updates.depth(ekf, measurement, self._stamp_ns)
            return []
        return [] if has_inertial else [self._odometry(ekf)]

    def _predict(
        self,
        ekf: KalmanFilter,
        stamp_ns: int,
        has_inertial: bool,
        inertial: Inertial | None = None,
    ) -> None:
        interval = (stamp_ns - self._stamp_ns) * 1e-9
        before = self._rates if has_inertial else None
        now = before if inertial is None else _rates_of(inertial)
        self._stamp_ns, self._rates = stamp_ns, now
        if before is None:
            self._unsensed += interval
            ekf.predict(interval, _AT_REST, self._config.turn_rate_noise, self._drift_noise)
        elif now is None:
            ekf.predict(interval, before, self._config.gyro_noise)
        else:
            rates = [0.5 * (a + b) for a, b in zip(before, now, strict=True)]
            ekf.predict(interval, rates, self._config.gyro_noise)

    @property
    def _drift_noise(self) -> float:
        # Deviation: a speed is assumed for a vehicle that keeps its course. Of one that no sensor
        # of motion has been heard of, nothing is known.
        return 0.0 if self._measured else self._config.drift_noise

    def _recent(self, last_ns: int | None, now_ns: int) -> bool:
        return last_ns is not None and now_ns - last_ns <= self._config.sensor_timeout * 1e9

    def _update_orientation(self, ekf: KalmanFilter, inertial: Inertial) -> None:
        if inertial.orientation is None:
            return
        roll, pitch, yaw = inertial.orientation.tolist()
        self._updates.tilt(ekf, roll, pitch, self._stamp_ns)
        self._updates.heading(ekf, yaw, self._stamp_ns, self._heading_gain)

    def _heading_gain(self, ekf: KalmanFilter, variance: float) -> float:
        # Deviation: with equation 10 the compass, whose bias wanders by degrees, would shake the
        # heading within a turn, where a scan needs it steady. The gyro gives the short term.
        last, self._compass_ns = self._compass_ns, self._stamp_ns
        unsensed, self._unsensed = self._unsensed, 0.0
        if self._rates is None or unsensed > self._config.sensor_timeout:
            return ekf.heading_gain(variance)
        interval = 0.0 if last is None else (self._stamp_ns - last) * 1e-9
        return -math.expm1(-interval / self._config.heading_time_constant)

    def _odometry(self, ekf: KalmanFilter) -> Odometry:
        has_compass = self._recent(self._compass_ns, self._stamp_ns)
        variance = yaw_rate_variance(self._config, self._rates is not None, has_compass)
        rates = self._rates or _AT_REST
        return odometry_of(ekf, self._stamp_ns, rates, variance, self._drift_noise)


def _rates_of(inertial: Inertial) -> list[float] | None:
    rates = inertial.angular_velocity
    return None if rates is None else rates.tolist()
