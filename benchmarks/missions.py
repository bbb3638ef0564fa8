# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is simulated, and how far off an estimate of it is."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.jumps import largest_jumps
from msss_graphslam.core.types import Estimate, SonarCalibration, Trajectory
from msss_graphslam.evaluation.errors import position_errors, start_end_gap
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.worlds import World, world_named

__all__ = ["Accuracy", "Changes", "Mission", "accuracy", "keep_silent", "spelt"]

Changes = tuple[tuple[str, Any], ...]
"""Names and what they are set to."""


@dataclass(frozen=True, slots=True)
class Mission:
    """What is simulated; everything else of a simulation keeps its default.

    ``sonar`` changes settings of the world's sonar; ``dvl`` adds a DVL.
    """

    world: str
    echo: EchoKind
    seed: int
    noise: NoiseLevel = NoiseLevel.PAPER
    dvl: bool = False
    sonar: Changes = ()

    def __str__(self) -> str:
        words = [self.world, str(self.echo), str(self.seed)]
        if self.noise is not NoiseLevel.PAPER:
            words.append(str(self.noise))
        if self.dvl:
            words.append("dvl")
        return "_".join([*words, *spelt(self.sonar)])

    @property
    def place(self) -> World:
        """The world that is flown through."""
        return world_named(self.world)

    @property
    def head(self) -> SonarSettings:
        """The settings of the sonar."""
        return replace(self.place.sonar, **dict(self.sonar))


@dataclass(frozen=True, slots=True)
class Accuracy:
    """How far off a run is [m].

    Mean position errors: ``anchored`` at the start, ``aligned`` to the truth, ``online`` as
    published at the time, anchored; ``gap`` between start and end, and the vehicle's ``true_gap``;
    ``jump``, the largest of the pose known online, and ``plain_jump`` without those of a first far
    loop closure, which came after ``jump_turns`` whole turns. ``turned`` is by how much the whole
    trajectory is turned [deg]. By ``yaw`` [deg] the head is turned against the DVL, and ranges are
    ``scale`` times as long, as the estimator sees it, both with their stated deviations, infinite
    where it says nothing of them.
    """

    anchored: float
    aligned: float
    online: float
    gap: float
    true_gap: float
    jump: float = 0.0
    plain_jump: float = 0.0
    jump_turns: int = 0
    turned: float = 0.0
    yaw: float = 0.0
    yaw_deviation: float = np.inf
    scale: float = 1.0
    scale_deviation: float = np.inf


def accuracy(estimate: Estimate, truth: Trajectory) -> Accuracy:
    """Measure an estimate against the truth."""
    final = position_errors(estimate.trajectory, truth)
    online = position_errors(estimate.online, truth, estimate.trajectory)
    jumps = largest_jumps(estimate)
    return Accuracy(
        anchored=float(np.mean(final.anchored)),
        aligned=float(np.mean(final.aligned)),
        online=float(np.mean(online.anchored)),
        gap=start_end_gap(estimate.trajectory),
        true_gap=start_end_gap(truth),
        jump=jumps.largest,
        plain_jump=jumps.plain,
        jump_turns=jumps.turns,
        turned=float(np.degrees(np.abs(np.mean(final.heading)))),
        **_calibration(estimate.sonar_calibration),
    )


def _calibration(found: SonarCalibration | None) -> dict[str, float]:
    if found is None:
        return {}
    yaw, scale = found.deviations
    return {
        "yaw": float(np.degrees(found.yaw)),
        "yaw_deviation": float(np.degrees(yaw)),
        "scale": found.scale,
        "scale_deviation": scale,
    }


def spelt(changes: Changes) -> list[str]:
    """Return the changes as words that a file may be called by."""
    return [
        f"{name}={value:.6g}" if isinstance(value, float) else f"{name}={value}"
        for name, value in changes
    ]


def keep_silent(fraction: float, what: str) -> None:
    """Show no progress."""
    del fraction, what
