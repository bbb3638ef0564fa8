# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The attitude at the start, from the first samples of the IMU."""

from collections.abc import Sequence

import numpy as np

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.types import Array, Inertial, Measurement

__all__ = ["align"]


def align(pending: Sequence[Measurement], config: DeadReckoningConfig) -> tuple[Array, float]:
    """Return the attitude (3,) at the first IMU sample and the variance of its yaw [rad^2].

    Without any orientation both are 0.
    """
    samples = [entry for entry in pending if isinstance(entry, Inertial)]
    if all(sample.orientation is None for sample in samples):
        return np.zeros(3), 0.0
    elapsed, estimates = _estimates(samples)
    weights, variance = _yaw_weights(elapsed, config)
    shares = np.full((len(estimates), 3), 1.0 / len(estimates))
    shares[:, 2] = weights
    sines, cosines = (shares * np.sin(estimates)).sum(0), (shares * np.cos(estimates)).sum(0)
    return np.arctan2(sines, cosines), variance


def _estimates(samples: Sequence[Inertial]) -> tuple[Array, Array]:
    """Return what each orientation says of the first attitude (n, 3), and its time (n,) [s]."""
    turned, previous = np.zeros(3), samples[0]
    elapsed, estimates = [], []
    for sample in samples:
        if previous.angular_velocity is not None:
            since = (sample.stamp_ns - previous.stamp_ns) * 1e-9
            turned = turned + previous.angular_velocity * since
        if sample.orientation is not None:
            elapsed.append((sample.stamp_ns - samples[0].stamp_ns) * 1e-9)
            estimates.append(sample.orientation - turned)
        previous = sample
    return np.array(elapsed), np.array(estimates)


def _yaw_weights(elapsed: Array, config: DeadReckoningConfig) -> tuple[Array, float]:
    """Return the best weights (n,) of compass samples and the variance of their mean [rad^2].

    The compass is right at launch; white noise lies on each sample, and its bias walks away.
    """
    walked = 2.0 * config.compass_drift**2 / config.compass_correlation_time
    covariance = walked * np.minimum.outer(elapsed, elapsed)
    covariance += config.compass_noise**2 * np.eye(len(elapsed))
    weights = np.linalg.solve(covariance, np.ones(len(elapsed)))
    return weights / weights.sum(), float(1.0 / weights.sum())
