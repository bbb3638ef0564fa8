# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The scanning sonar: when it sends, where to, and what comes back."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.echo_ideal import IdealEchoes
from msss_graphslam.simulation.echo_model import EchoKind, EchoModel
from msss_graphslam.simulation.echo_real import RealEchoes
from msss_graphslam.simulation.scene import Pings
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.streams import stream
from msss_graphslam.simulation.vehicle import Motion
from msss_graphslam.simulation.worlds import World

__all__ = ["SonarRecord", "echo_model_of", "pings_from", "scan"]

_STAMP_JITTER = 0.001
_CHUNK = 48


@dataclass(frozen=True, slots=True)
class SonarRecord:
    """All beams: stamps ``times`` (n,) [s], ``bearings`` (n,) [rad], ``codes`` (n, bins)."""

    settings: SonarSettings
    times: Array
    bearings: Array
    codes: NDArray[np.uint8]


def scan(
    world: World,
    motion: Motion,
    settings: SonarSettings,
    echo: EchoKind,
    seed: int,
    progress: Callable[[float], None],
) -> SonarRecord:
    """Return what the turning head records on the way; ``progress`` gets the fraction done."""
    transmitted = np.arange(0.0, motion.duration, settings.beam_period)
    first_step = int(stream(seed, "first bearing").integers(int(2.0 * np.pi / settings.step)))
    bearings = settings.bearings(len(transmitted), first_step)
    pings = pings_from(motion.at(transmitted), bearings, settings.mount_yaw)
    model = echo_model_of(world, settings, echo, seed)
    codes = np.empty((len(bearings), settings.bins), dtype=np.uint8)
    for start in range(0, len(bearings), _CHUNK):
        part = slice(start, start + _CHUNK)
        codes[part] = model.codes(
            Pings(pings.origins[part], pings.bearings[part], pings.azimuths[part])
        )
        progress(min(start + _CHUNK, len(bearings)) / len(bearings))
    jitter = _STAMP_JITTER * np.abs(stream(seed, "stamps").standard_normal(len(transmitted)))
    late = np.minimum(jitter, 0.5 * settings.beam_period)
    return SonarRecord(settings, transmitted + late, bearings, codes)


def echo_model_of(world: World, settings: SonarSettings, echo: EchoKind, seed: int) -> EchoModel:
    """Return the echo model of that kind for a head with ``settings`` in the ``world``."""
    if echo is EchoKind.REAL:
        return RealEchoes(world.walls, settings, world.rough, seed)
    return IdealEchoes(world.walls, settings, seed)


def pings_from(poses: Array, bearings: Array, mount_yaw: float) -> Pings:
    """Return where the beams go: along the level line in each beam's tilted upright plane."""
    body = bearings + mount_yaw
    roll, pitch, yaw = poses[:, 3], poses[:, 4], poses[:, 5]
    # The plane's normal (-sin, cos, 0) of the body, levelled by roll, then pitch.
    forward = -np.sin(body) * np.cos(pitch) + np.cos(body) * np.sin(roll) * np.sin(pitch)
    port = np.cos(body) * np.cos(roll)
    azimuths = yaw + np.arctan2(-forward, port)
    return Pings(poses[:, :2], bearings, azimuths)
