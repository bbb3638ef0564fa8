# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A short simulated mission in the pond, as the measurements that the pipeline takes."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import (
    Array,
    Beam,
    BodyVelocity,
    Depth,
    Estimate,
    Inertial,
    Measurement,
    Scan,
    Stamps,
    Trajectory,
)
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.mission import Mission, fly
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.worlds import World, world_named

LAUNCH_NS = 1_750_000_000_000_000_000
AIR, WEIGHT = 101_325.0, 9806.65


@dataclass(frozen=True)
class Recorded:
    """Measurements in the order of their stamps, and the truth at every beam."""

    measurements: tuple[Measurement, ...]
    truth: Trajectory

    @property
    def beams(self) -> list[Beam]:
        return [entry for entry in self.measurements if isinstance(entry, Beam)]


@cache
def recorded(
    seed: int = 1, *, echo: EchoKind = EchoKind.IDEAL, lap: float = 0.25, dvl: bool = False
) -> Recorded:
    """Fly once round a course like the pond's, ``lap`` times as long, in the pond."""
    world = _small_pond(lap)
    mission = fly(
        world,
        seed,
        noise=NoiseLevel.PAPER,
        echo=echo,
        sonar=world.sonar,
        dvl=dvl,
        progress=lambda _: None,
    )
    return measured(mission)


def measured(mission: Mission) -> Recorded:
    """What was measured in a simulated mission, and its truth."""
    stamps = _stamps(mission.sonar.times)
    measurements = sorted(_measurements(mission), key=lambda entry: entry.stamp_ns)
    return Recorded(
        tuple(measurements), Trajectory(stamps, mission.motion.at(mission.sonar.times))
    )


def until(seconds: float) -> list[Measurement]:
    """The first part of the mission."""
    end = LAUNCH_NS + round(seconds * 1e9)
    return [entry for entry in recorded().measurements if entry.stamp_ns < end]


def seconds_of(entry: Measurement) -> float:
    """Since launch."""
    return (entry.stamp_ns - LAUNCH_NS) * 1e-9


def run(
    measurements: Iterable[Measurement],
    estimator: str = "full",
    configuration: Configuration | None = None,
) -> tuple[Estimate, Counter[str]]:
    """The estimate of the measurements in their order of arrival, and what was refused."""
    refused: Counter[str] = Counter()
    pipeline = Pipeline(configuration or Configuration(), ESTIMATORS[estimator], refused)
    for measurement in measurements:
        pipeline.process(measurement)
    return pipeline.finish(), refused


@cache
def estimated(estimator: str, seed: int = 1) -> Estimate:
    """The estimate of a whole ``recorded`` mission."""
    return run(recorded(seed).measurements, estimator)[0]


@cache
def scans() -> tuple[Scan, ...]:
    """The mission's scans as dead reckoning lays them out."""
    return tuple(estimated("dead_reckoning").first_scans)


def position_errors(estimate: Trajectory, truth: Trajectory) -> Array:
    """The distances (n,) [m] at every pose of the estimate, both beginning at the origin."""
    at = np.searchsorted(truth.stamps_ns, estimate.stamps_ns)
    true = truth.planar[at, :2]
    away = (estimate.planar[:, :2] - estimate.planar[0, :2]) - (true - true[0])
    return np.asarray(np.linalg.norm(away, axis=1))


def _small_pond(lap: float) -> World:
    pond = world_named("pond")
    waypoints = lap * pond.path.points[::100]
    return replace(pond, path=Path.through(waypoints - waypoints[0]), laps=1)


def _measurements(mission: Mission) -> list[Measurement]:
    inertial, pressure, sonar = mission.inertial, mission.pressure, mission.sonar
    measurements: list[Measurement] = [
        Inertial(int(stamp), angles, rates)
        for stamp, angles, rates in zip(
            _stamps(inertial.times),
            inertial.orientations,
            inertial.angular_velocities,
            strict=True,
        )
    ]
    for stamp, pascal in zip(_stamps(pressure.times), pressure.pressures, strict=True):
        measurements.append(Depth(int(stamp), (AIR - float(pascal)) / WEIGHT))
    if mission.velocity is not None:
        velocity = mission.velocity
        for stamp, value in zip(_stamps(velocity.times), velocity.velocities, strict=True):
            measurements.append(BodyVelocity(int(stamp), value, 1e-4 * np.eye(3)))
    ranges = sonar.settings.ranges
    for stamp, bearing, codes in zip(
        _stamps(sonar.times), sonar.bearings, sonar.codes, strict=True
    ):
        measurements.append(Beam(int(stamp), float(bearing), ranges, codes))
    return measurements


def _stamps(times: Array) -> Stamps:
    return np.asarray(np.rint(times * 1e9), dtype=np.int64) + LAUNCH_NS
