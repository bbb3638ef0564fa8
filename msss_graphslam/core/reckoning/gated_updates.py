# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Equations 9 and 10: the filter's updates by measurements that lie near their prediction."""

from collections import Counter
from collections.abc import Callable
from copy import copy
from typing import Self

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.reckoning.innovation_gate import InnovationGate
from msss_graphslam.core.reckoning.kalman_filter import (
    ATTITUDE,
    VELOCITY_ERROR,
    YAW,
    KalmanFilter,
    Z,
)
from msss_graphslam.core.types import BodyVelocity, Depth

__all__ = ["GatedUpdates"]


class GatedUpdates:
    """Updates of a filter that stands at ``now_ns``; what is refused is counted in ``refused``."""

    def __init__(self, config: DeadReckoningConfig, refused: Counter[str]) -> None:
        self._config = config
        self._gate = InnovationGate(config, refused)

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters."""
        self._config = config
        self._gate.configure(config)

    def fork(self, refused: Counter[str]) -> Self:
        """Return one that has refused the same and goes its own way, counting elsewhere."""
        clone = copy(self)
        clone._gate = self._gate.fork(refused)
        return clone

    def tilt(self, ekf: KalmanFilter, roll: float, pitch: float, now_ns: int) -> None:
        """Take in roll and pitch [rad]."""
        variance = self._config.compass_noise**2
        for name, index, angle in (
            ("roll", ATTITUDE.start, roll),
            ("pitch", ATTITUDE.start + 1, pitch),
        ):
            difference = wrap_angle(angle - ekf.state[index])
            if self._gate.admits(ekf, name, index, difference, variance, now_ns):
                ekf.update(index, difference, variance)

    def heading(
        self,
        ekf: KalmanFilter,
        yaw: float,
        now_ns: int,
        gain: Callable[[KalmanFilter, float], float],
    ) -> None:
        """Take in a heading [rad]; ``gain`` says how much of it, given filter and variance."""
        variance = self._config.compass_noise**2
        difference = wrap_angle(yaw - ekf.state[YAW])
        if self._gate.admits(ekf, "yaw", YAW, difference, variance, now_ns):
            ekf.update_heading(difference, variance, gain(ekf, variance))

    def velocity(self, ekf: KalmanFilter, measurement: BodyVelocity, now_ns: int) -> None:
        """Take in the velocity of the body."""
        # Deviation: the DVL corrects the velocity's error instead of being the control u_k, so
        # that a silent DVL leaves its last word behind, with growing uncertainty.
        measured, variances = measurement.velocity.tolist(), measurement.covariance.diagonal()
        for offset, axis in enumerate("xyz"):
            index = VELOCITY_ERROR.start + offset
            difference, variance = (
                measured[offset] - ekf.velocity[offset],
                float(variances[offset]),
            )
            if self._gate.admits(ekf, f"dvl_{axis}", index, difference, variance, now_ns):
                ekf.update(index, difference, variance)

    def depth(self, ekf: KalmanFilter, measurement: Depth, now_ns: int) -> None:
        """Take in a depth."""
        difference = measurement.z - ekf.state[Z]
        variance = self._config.depth_noise**2
        if self._gate.admits(ekf, "depth", Z, difference, variance, now_ns):
            ekf.update(Z, difference, variance)
