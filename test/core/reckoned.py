# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Made-up measurements for dead reckoning, and a run of it."""

from collections import Counter
from collections.abc import Iterable

import numpy as np

from msss_graphslam.config.groups import DeadReckoning as Config
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.types import (
    Array,
    Beam,
    Depth,
    Inertial,
    Measurement,
    Odometry,
)

CONFIG = Config()
LEVEL = np.zeros(3)
PERIOD = 0.04
START_NS = 1_700_000_000_000_000_000


def nanoseconds(seconds: float) -> int:
    return START_NS + round(seconds * 1e9)


def heading(yaw: float) -> Array:
    return np.array([0.0, 0.0, float(wrap(yaw))])


def imu(seconds: float, yaw: float = 0.0, rate: float = 0.0) -> Inertial:
    return Inertial(nanoseconds(seconds), heading(yaw), np.array([0.0, 0.0, rate]))


def beam(seconds: float) -> Beam:
    return Beam(nanoseconds(seconds), 0.0, np.array([1.0]), np.array([0.0]))


def depth(seconds: float, z: float) -> Depth:
    return Depth(nanoseconds(seconds), z)


def times(start: float, stop: float, period: float = PERIOD) -> list[float]:
    return [float(time) for time in np.arange(start, stop + 1e-9, period)]


def turning(duration: float, rate: float, start: float = 0.0) -> list[Measurement]:
    return [imu(time, start + rate * time, rate) for time in times(0.0, duration)]


class Run:
    """Dead reckoning, what it gave and what it refused."""

    def __init__(self, config: Config = CONFIG) -> None:
        self.refused: Counter[str] = Counter()
        self.odometry: list[Odometry] = []
        self._dead_reckoning = DeadReckoning(config, self.refused)

    def feed(self, measurements: Iterable[Measurement]) -> "Run":
        for measurement in sorted(measurements, key=lambda entry: entry.stamp_ns):
            self.feed_late(measurement)
        return self

    def feed_late(self, measurement: Measurement) -> list[Odometry]:
        brought = self._dead_reckoning.process(measurement)
        self.odometry += brought
        return brought

    def start(self) -> "Run":
        self.odometry += self._dead_reckoning.start()
        return self

    @property
    def last(self) -> Odometry:
        return self.odometry[-1]


def seconds_of(entry: Measurement | Odometry) -> float:
    return (entry.stamp_ns - START_NS) * 1e-9
