# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Small bags for tests, made message by message."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from msss_graphslam.core.types import Beam, BodyVelocity, Inertial
from msss_graphslam.messages import encoding
from msss_graphslam.recordings.typestore import make
from msss_graphslam.recordings.writer import BagWriter

__all__ = ["BEAM_PERIOD_NS", "START_NS", "beam_message", "sensor_messages", "write_bag"]

START_NS = 1_700_000_000_000_000_000
BEAM_PERIOD_NS = 40_000_000
STEP = np.radians(1.8)


def beam_message(index: int, *, step: float = STEP, bins: int = 20) -> Any:
    """Return the LaserScan of the index-th beam of a head that turns steadily."""
    codes = np.random.default_rng(index).integers(0, 256, bins).astype(float)
    bearing = float(np.remainder(index * step + np.pi, 2 * np.pi) - np.pi)
    stamp_ns = START_NS + index * BEAM_PERIOD_NS
    beam = Beam(stamp_ns, bearing, (np.arange(bins) + 0.5) * 0.05, codes)
    return encoding.laser_scan(make, beam, "sonar_link", BEAM_PERIOD_NS * 1e-9)


def sensor_messages(beams: int = 50) -> Iterator[tuple[str, Any, int]]:
    """Yield topic, message and log time of every sensor, one of each a beam."""
    for index in range(beams):
        now = START_NS + index * BEAM_PERIOD_NS
        sample = Inertial(now, np.array([0.0, 0.0, 0.01 * index]), np.array([0.0, 0.0, 0.25]))
        velocity = BodyVelocity(now, np.array([0.1, 0.0, 0.0]), np.eye(3) * 1e-4)
        truth = np.array([0.1 * index, 0.0, -2.0, 0.0, 0.0, 0.01 * index])
        yield "/sonar/ping", beam_message(index), now
        yield "/imu/data", encoding.imu(make, sample, "imu_link"), now
        yield "/pressure", encoding.fluid_pressure(make, now, 120_938.3, "base_link"), now
        yield "/dvl/twist", encoding.twist(make, velocity, "base_link"), now
        yield "/ground_truth", encoding.ground_truth(make, now, truth), now


def write_bag(path: Path, messages: Any = None) -> Path:
    """Write the messages (topic, message, log time) and return the path."""
    with BagWriter(path) as bag:
        for topic, message, log_ns in sensor_messages() if messages is None else messages:
            bag.write(topic, message, log_ns)
    return path
