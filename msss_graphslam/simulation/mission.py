# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One simulated mission in memory: the true motion, and what every sensor says of it."""

from collections.abc import Callable
from dataclasses import dataclass

from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import (
    InertialSamples,
    NoiseLevel,
    PressureSamples,
    VelocitySamples,
    measure_inertial,
    measure_pressure,
    measure_velocity,
)
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.sonar import SonarRecord, scan
from msss_graphslam.simulation.vehicle import Motion, drive
from msss_graphslam.simulation.worlds import World

__all__ = ["Mission", "fly"]


@dataclass(frozen=True, slots=True)
class Mission:
    """The truth and the measurements; times are seconds since launch."""

    motion: Motion
    inertial: InertialSamples
    pressure: PressureSamples
    velocity: VelocitySamples | None
    sonar: SonarRecord


def fly(
    world: World,
    seed: int,
    *,
    noise: NoiseLevel,
    echo: EchoKind,
    sonar: SonarSettings,
    dvl: bool,
    progress: Callable[[float], None],
) -> Mission:
    """Return the mission through the ``world``; ``progress`` gets the fraction done."""
    motion = drive(world.path, world.laps, world.depth, seed, noise.scale)
    return Mission(
        motion=motion,
        inertial=measure_inertial(motion, seed, noise.scale),
        pressure=measure_pressure(motion, seed),
        velocity=measure_velocity(motion, seed) if dvl else None,
        sonar=scan(world, motion, sonar, echo, seed, progress),
    )
