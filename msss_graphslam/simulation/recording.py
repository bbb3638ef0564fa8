# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From a world and a seed to a bag and its truth."""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation as Attitude

from msss_graphslam.core.types import Array, Beam, BodyVelocity, Inertial
from msss_graphslam.messages import encoding, topics
from msss_graphslam.recordings.typestore import make
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import DVL_DEVIATION, NoiseLevel, VelocitySamples
from msss_graphslam.simulation.mission import Mission, fly
from msss_graphslam.simulation.raw_output import head_settings, packets
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.sonar import SonarRecord
from msss_graphslam.simulation.worlds import World

__all__ = ["SimulatedBag", "simulate"]

_LAUNCH_NS = 1_750_000_000_000_000_000
_TRUTH_PERIOD = 0.1
_SIMULATING_SHARE = 0.7
_MESSAGES_PER_REPORT = 2000

_Stamped = tuple[int, topics.Topic, Any]


@dataclass(frozen=True, slots=True)
class SimulatedBag:
    """Where a simulation was written: the ``bag``'s folder and the true trajectory (TUM)."""

    bag: Path
    ground_truth: Path


def simulate(
    world: World,
    seed: int,
    output_directory: Path,
    *,
    noise: NoiseLevel = NoiseLevel.PAPER,
    echo: EchoKind = EchoKind.REAL,
    sonar: SonarSettings | None = None,
    dvl: bool = False,
    raw: bool = False,
    progress: Callable[[float], None] = lambda _: None,
) -> SimulatedBag:
    """Write the bag ``<world>_<seed>`` of a simulated mission, and its truth beside it.

    The same arguments give the same bytes. ``sonar`` replaces the world's settings. With ``raw``
    the bag holds the bytes that the head sends, not the beams, and the settings are rounded to
    what a head can do. ``progress`` is called with the fraction done. Raises UserError where the
    bag exists already, or no head takes such settings.
    """
    name = f"{world.name}_{seed}"
    sonar = sonar or world.sonar
    paths = SimulatedBag(output_directory / name, output_directory / f"{name}_ground_truth.tum")
    with BagWriter(paths.bag) as bag:
        mission = fly(
            world,
            seed,
            noise=noise,
            echo=echo,
            sonar=head_settings(sonar) if raw else sonar,
            dvl=dvl,
            progress=lambda fraction: progress(_SIMULATING_SHARE * fraction),
        )
        for count, (stamp_ns, topic, message) in enumerate(_messages(mission, raw)):
            bag.write(topic.absolute, message, stamp_ns)
            if count % _MESSAGES_PER_REPORT == 0:
                flown = (stamp_ns - _LAUNCH_NS) * 1e-9 / mission.motion.duration
                progress(_SIMULATING_SHARE + (1.0 - _SIMULATING_SHARE) * min(flown, 1.0))
    _write_truth(paths.ground_truth, mission)
    progress(1.0)
    return paths


def _messages(mission: Mission, raw: bool) -> Iterator[_Stamped]:
    """Return all messages in the order of their stamps."""
    sonar = _raw_bytes(mission.sonar) if raw else _beams(mission.sonar)
    sources = [_truth(mission), _inertial(mission), _pressure(mission), sonar]
    if mission.velocity is not None:
        sources.append(_velocity(mission.velocity))
    return heapq.merge(*sources, key=lambda stamped: stamped[0])


def _truth(mission: Mission) -> Iterator[_Stamped]:
    stamps, poses = _true_poses(mission)
    for stamp, pose in zip(stamps, poses, strict=True):
        yield stamp, topics.GROUND_TRUTH, encoding.ground_truth(make, stamp, pose)


def _inertial(mission: Mission) -> Iterator[_Stamped]:
    samples = mission.inertial
    stamps = _stamps(samples.times)
    rows = zip(stamps, samples.orientations, samples.angular_velocities, strict=True)
    for stamp, orientation, rates in rows:
        sample = Inertial(stamp, orientation, rates)
        yield stamp, topics.IMU, encoding.imu(make, sample, "imu_link")


def _pressure(mission: Mission) -> Iterator[_Stamped]:
    samples = mission.pressure
    for stamp, value in zip(_stamps(samples.times), samples.pressures, strict=True):
        yield stamp, topics.PRESSURE, encoding.fluid_pressure(make, stamp, value, "base_link")


def _velocity(samples: VelocitySamples) -> Iterator[_Stamped]:
    covariance = DVL_DEVIATION**2 * np.eye(3)
    for stamp, velocity in zip(_stamps(samples.times), samples.velocities, strict=True):
        sample = BodyVelocity(stamp, velocity, covariance)
        yield stamp, topics.DVL, encoding.twist(make, sample, "base_link")


def _beams(record: SonarRecord) -> Iterator[_Stamped]:
    settings = record.settings
    ranges = settings.ranges
    stamps = _stamps(record.times)
    for stamp, bearing, codes in zip(stamps, record.bearings, record.codes, strict=True):
        beam = Beam(stamp, float(bearing), ranges, codes)
        message = encoding.laser_scan(make, beam, "sonar_link", settings.beam_period)
        yield stamp, topics.SONAR_PING, message


def _raw_bytes(record: SonarRecord) -> Iterator[_Stamped]:
    for time, data in packets(record):
        received_ns = _LAUNCH_NS + round(time * 1e9)
        yield received_ns, topics.SONAR_RAW, encoding.raw_bytes(make, data, received_ns)


def _stamps(times: Array) -> list[int]:
    return [_LAUNCH_NS + int(nanoseconds) for nanoseconds in np.rint(times * 1e9)]


def _true_poses(mission: Mission) -> tuple[list[int], Array]:
    times = np.arange(0.0, mission.motion.duration, _TRUTH_PERIOD)
    return _stamps(times), mission.motion.at(times)


def _write_truth(path: Path, mission: Mission) -> None:
    """Write ``t x y z qx qy qz qw``, the format of the TUM RGB-D benchmark."""
    stamps, poses = _true_poses(mission)
    quaternions = Attitude.from_euler("ZYX", poses[:, :2:-1]).as_quat(canonical=True)
    with path.open("w", encoding="ascii") as file:
        for stamp, position, quaternion in zip(stamps, poses[:, :3], quaternions, strict=True):
            numbers = " ".join(f"{value:.9f}" for value in (*position, *quaternion))
            file.write(f"{stamp // 10**9}.{stamp % 10**9:09d} {numbers}\n")
