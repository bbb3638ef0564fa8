# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated missions, kept until the simulator changes."""

import heapq
import os
from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from benchmarks.missions import Mission
from msss_graphslam.config.groups import Sensors
from msss_graphslam.core.types import (
    Array,
    Beam,
    BodyVelocity,
    Depth,
    Inertial,
    Measurement,
    Stamps,
    Trajectory,
)
from msss_graphslam.messages.hydrostatics import height_of
from msss_graphslam.simulation.inertial import DVL_DEVIATION
from msss_graphslam.simulation.mission import fly

__all__ = ["Flight", "FlightCache", "flown"]

_LAUNCH_NS = 1_750_000_000_000_000_000
_TRUTH_PERIOD = 0.1
_NO_SAMPLES = np.empty((0, 3))


@dataclass(frozen=True, slots=True)
class Flight:
    """The arrays of a simulated mission, by name."""

    arrays: dict[str, Any]

    @property
    def truth(self) -> Trajectory:
        """The true trajectory, as a bag has it."""
        return Trajectory(_stamps(self.arrays["truth_times"]), self.arrays["truth"])

    def measurements(self) -> Iterator[Measurement]:
        """Yield what the sensors measured, in the order of stamps: what a bag of it would say."""
        sources = [self._inertial(), self._depths(), self._beams(), self._velocities()]
        return heapq.merge(*sources, key=attrgetter("stamp_ns"))

    def _inertial(self) -> Iterator[Measurement]:
        stamps = _stamps(self.arrays["imu_times"]).tolist()
        rows = zip(stamps, self.arrays["orientations"], self.arrays["rates"], strict=True)
        return (Inertial(*row) for row in rows)

    def _depths(self) -> Iterator[Measurement]:
        stamps, sensors = _stamps(self.arrays["pressure_times"]).tolist(), Sensors()
        for stamp_ns, pressure in zip(stamps, self.arrays["pressures"].tolist(), strict=True):
            yield Depth(stamp_ns, height_of(pressure, sensors))

    def _beams(self) -> Iterator[Measurement]:
        # A LaserScan has 32 bits for its numbers.
        ranges = self.arrays["ranges"].astype(np.float32).astype(float)
        bearings = self.arrays["bearings"].astype(np.float32).tolist()
        stamps = _stamps(self.arrays["beam_times"]).tolist()
        for stamp_ns, bearing, codes in zip(stamps, bearings, self.arrays["codes"], strict=True):
            yield Beam(stamp_ns, bearing, ranges, codes.astype(float))

    def _velocities(self) -> Iterator[Measurement]:
        covariance = DVL_DEVIATION**2 * np.eye(3)
        stamps = _stamps(self.arrays["dvl_times"]).tolist()
        for stamp_ns, velocity in zip(stamps, self.arrays["velocities"], strict=True):
            yield BodyVelocity(stamp_ns, velocity, covariance)


@dataclass(frozen=True, slots=True)
class FlightCache:
    """A file for each mission in ``folder``; one made by another simulator counts as missing."""

    folder: Path
    fingerprint: str

    def get(self, mission: Mission) -> Flight:
        """Return the mission's flight; what is missing is simulated and kept."""
        path = self.folder / f"{mission}.npz"
        kept = self._load(path)
        if kept is None:
            kept = flown(mission)
            self._store(path, kept)
        return kept

    def _load(self, path: Path) -> Flight | None:
        if not path.exists():
            return None
        try:
            with np.load(path) as file:
                if str(file["sources"]) == self.fingerprint:
                    return Flight({name: file[name] for name in file.files if name != "sources"})
        except (BadZipFile, EOFError, KeyError, OSError, ValueError):
            pass
        path.unlink()
        return None

    def _store(self, path: Path, flight: Flight) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(f".{os.getpid()}.part")
        with unfinished.open("wb") as file:
            np.savez_compressed(file, sources=np.array(self.fingerprint), **flight.arrays)
        unfinished.replace(path)


def flown(mission: Mission) -> Flight:
    """Simulate the mission."""
    result = fly(
        mission.place,
        mission.seed,
        noise=mission.noise,
        echo=mission.echo,
        sonar=mission.head,
        dvl=mission.dvl,
        progress=lambda _: None,
    )
    truth_times = np.arange(0.0, result.motion.duration, _TRUTH_PERIOD)
    velocity = result.velocity
    return Flight(
        {
            "truth_times": truth_times,
            "truth": result.motion.at(truth_times),
            "imu_times": result.inertial.times,
            "orientations": result.inertial.orientations,
            "rates": result.inertial.angular_velocities,
            "pressure_times": result.pressure.times,
            "pressures": result.pressure.pressures,
            "beam_times": result.sonar.times,
            "bearings": result.sonar.bearings,
            "codes": result.sonar.codes,
            "ranges": result.sonar.settings.ranges,
            "dvl_times": velocity.times if velocity else np.empty(0),
            "velocities": velocity.velocities if velocity else _NO_SAMPLES,
        }
    )


def _stamps(times: Array) -> Stamps:
    return np.asarray(_LAUNCH_NS + np.rint(times * 1e9).astype(np.int64))
