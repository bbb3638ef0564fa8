# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A mission of many laps through one basin, simulated up to the echoes' ranges.

A day of echo profiles takes half an hour to synthesise and as long to segment, and says nothing
of what grows. So motion, IMU and pressure are those of the simulator, and of the sonar the one
range that segmentation would leave: the wall on the beam's axis, with the same faults as there.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import measure_inertial, measure_pressure
from msss_graphslam.simulation.scene import Pings
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.sonar import pings_from, scan
from msss_graphslam.simulation.streams import stream
from msss_graphslam.simulation.vehicle import Motion, drive
from msss_graphslam.simulation.worlds import World

__all__ = ["LAUNCH_NS", "LongMission", "simulate"]

LAUNCH_NS = 1_750_000_000_000_000_000
SLICE_S = 600.0
"""A file holds this much of the mission [s], so that a run never has all of it in memory."""

SPEED = 0.1
"""Of the simulated vehicle, in the mean [m/s]."""

RANGE_NOISE = 0.04
"""Jitter of the wall and of what segmentation adds [m]."""

MISSES, OUTLIERS = 0.02, 0.03
HALF_LOST, LOSS_WIDTH = np.radians(72.0), np.radians(3.0)
ARCS_PER_TURN, ARC_BEAMS = 0.4, (4, 14)
AT_ONCE = 4096


@dataclass(frozen=True, slots=True)
class LongMission:
    """What is simulated: ``scans`` turns of the head in the ``world``; with ``echoes`` or not."""

    world: World
    seed: int
    scans: int
    echoes: bool = False

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        sonar = self.world.sonar
        beams = np.ceil(2.0 * np.pi / sonar.step - 1e-9)
        return float((self.scans + 0.5) * beams * sonar.beam_period)


def simulate(mission: LongMission, folder: Path) -> None:
    """Write the mission's measurements and truth into numbered files in the ``folder``."""
    motion = _motion(mission)
    times, bearings, measured = _sonar(mission, motion)
    inertial, pressure = (
        measure_inertial(motion, mission.seed, 1.0),
        measure_pressure(motion, mission.seed),
    )
    rows: dict[str, tuple[NDArray[Any], ...]] = {
        "inertial": (inertial.times, inertial.orientations, inertial.angular_velocities),
        "pressure": (pressure.times, pressure.pressures),
        "beam": (times, bearings, measured, motion.at(times)),
    }
    for number, start in enumerate(np.arange(0.0, motion.duration, SLICE_S)):
        columns = {
            f"{name}_{place}": column
            for name, arrays in rows.items()
            for place, column in enumerate(_between(arrays, start, start + SLICE_S))
        }
        np.savez(folder / f"{number:04d}.npz", allow_pickle=False, **columns)


def _motion(mission: LongMission) -> Motion:
    world = mission.world
    laps = int(np.ceil(1.1 * SPEED * mission.duration / world.path.lap_length)) + 1
    whole = drive(world.path, laps, world.depth, mission.seed, 1.0)
    count = int(np.searchsorted(whole.times, mission.duration))
    return replace(whole, times=whole.times[:count], poses=whole.poses[:count])


def _between(arrays: tuple[NDArray[Any], ...], start: float, end: float) -> Iterator[NDArray[Any]]:
    first, last = np.searchsorted(arrays[0], (start, end))
    return (array[first:last] for array in arrays)


def _sonar(mission: LongMission, motion: Motion) -> tuple[Array, Array, NDArray[Any]]:
    """Return times (n,) [s], bearings (n,) [rad], and codes (n, bins) or ranges (n,) [m]."""
    world, settings = mission.world, mission.world.sonar
    if mission.echoes:
        record = scan(world, motion, settings, EchoKind.IDEAL, mission.seed, lambda _: None)
        return record.times, record.bearings, record.codes
    times = np.arange(0.0, motion.duration, settings.beam_period)
    first = int(stream(mission.seed, "first bearing").integers(int(2.0 * np.pi / settings.step)))
    bearings = settings.bearings(len(times), first)
    pings = pings_from(motion.at(times), bearings, settings.mount_yaw)
    return times, bearings, _ranges(world, settings, pings, mission.seed)


def _ranges(world: World, settings: SonarSettings, pings: Pings, seed: int) -> Array:
    """Return the nearest range (n,) of each beam [m], NaN where there is none."""
    count = len(pings.bearings)
    axis, incidence = np.empty(count), np.empty(count)
    for start in range(0, count, AT_ONCE):
        part = slice(start, start + AT_ONCE)
        hits = world.walls.cast(pings.origins[part], pings.azimuths[part])
        axis[part], incidence[part] = hits.ranges, hits.incidence
    generator = stream(seed, "long mission")
    kept = (1.0 - MISSES) / (1.0 + np.exp((incidence - HALF_LOST) / LOSS_WIDTH))
    wall = axis + RANGE_NOISE * generator.standard_normal(count)
    wall[generator.random(count) >= kept] = np.inf
    false = generator.uniform(0.0, settings.maximum_range, count)
    false[generator.random(count) >= OUTLIERS] = np.inf
    nearest = np.minimum(wall, np.minimum(false, _arcs(settings, generator, count)))
    return np.where(nearest < settings.maximum_range, np.maximum(nearest, 0.0), np.nan)


def _arcs(settings: SonarSettings, generator: np.random.Generator, count: int) -> Array:
    """Return the ranges (n,) of another sonar's pulses, alike for some beams; inf is none."""
    ranges = np.full(count, np.inf)
    per_beam = ARCS_PER_TURN * settings.step / (2.0 * np.pi)
    for start in np.flatnonzero(generator.random(count) < per_beam):
        beams = int(generator.integers(*ARC_BEAMS, endpoint=True))
        ranges[start : start + beams] = generator.uniform(0.0, settings.maximum_range)
    return ranges
