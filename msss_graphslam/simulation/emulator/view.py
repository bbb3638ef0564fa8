# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the emulated head sees: a world, from a vehicle that moves through it."""

from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.simulation.echo_model import EchoKind, EchoModel
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.settings import SOUND_SPEED
from msss_graphslam.simulation.sonar import echo_model_of, pings_from
from msss_graphslam.simulation.vehicle import drive
from msss_graphslam.simulation.worlds import World

__all__ = ["Look", "View"]

_REST = 0.01


class Look(Protocol):
    """What a head looks at."""

    def tune(self, listening: float, bins: int, step: float) -> None:
        """Hear for ``listening`` [s] after each ping, in ``bins`` parts; ``step`` [rad] a beam."""

    def codes(self, bearing: float, time: float) -> NDArray[np.uint8]:
        """Return the codes (bins,) of a beam along ``bearing`` [rad], ``time`` [s] after launch.

        The bearing is counter-clockwise from ahead. Called after ``tune``, with rising times.
        """


class View:
    """The world as the simulator shows it.

    The vehicle moves as in the simulation of the same ``world``, ``seed`` and ``noise``, and rests
    at the end of its way.
    """

    def __init__(
        self, world: World, seed: int, echo: EchoKind, noise: NoiseLevel = NoiseLevel.PAPER
    ) -> None:
        self._world = world
        self._seed = seed
        self._echo = echo
        self.motion = drive(world.path, world.laps, world.depth, seed, noise.scale)
        self._model: EchoModel = echo_model_of(world, world.sonar, echo, seed)

    def tune(self, listening: float, bins: int, step: float) -> None:
        """Hear for ``listening`` [s] after each ping, in ``bins`` parts; ``step`` [rad] a beam."""
        settings = replace(
            self._world.sonar,
            maximum_range=0.5 * listening * SOUND_SPEED,
            bins=bins,
            step=step,
            beam_period=listening + _REST,
        )
        self._model = echo_model_of(self._world, settings, self._echo, self._seed)

    def codes(self, bearing: float, time: float) -> NDArray[np.uint8]:
        """Return the codes (bins,) of a beam along ``bearing`` [rad], ``time`` [s] on the way."""
        pose = self.motion.at(np.array([time]))
        pings = pings_from(pose, np.array([bearing]), self._world.sonar.mount_yaw)
        return np.asarray(self._model.codes(pings)[0])
