# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A long basin with equal bays on both sides: a scan in one looks like a scan in the next."""

from functools import cache

import numpy as np
import pytest
from small_mission import Recorded, measured, position_errors, run

from msss_graphslam.core.compounding import between
from msss_graphslam.core.types import Array, ConstraintKind, Estimate
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.mission import fly
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.worlds import World

LENGTH, WIDTH, BAY = 42.0, 9.0, 6.0
PIER_HALF, PIER_DEPTH = 0.4, 1.2
REACH = 12.0
"""Of the sonar [m]: from most places neither end of the basin is seen."""


def comb() -> World:
    """There along one side and back along the other, through piers 6 m apart."""
    piers = np.arange(BAY, LENGTH - 1.0, BAY)
    corners = np.array([(-1, 0), (-1, 1), (1, 1), (1, 0)]) * [PIER_HALF, PIER_DEPTH]
    south = [corner + np.array([x, 0.0]) for x in piers for corner in corners]
    north = [[LENGTH, WIDTH] - corner for corner in south]
    outline = np.array([[0.0, 0.0], *south, [LENGTH, 0.0], [LENGTH, WIDTH], *north, [0.0, WIDTH]])
    there = [(5.0, 3.2), (13.0, 3.0), (21.0, 3.0), (29.0, 3.0), (36.0, 3.2), (38.0, 4.5)]
    back = [(36.0, 5.8), (29.0, 6.0), (21.0, 6.0), (13.0, 6.0), (5.0, 5.8), (3.5, 4.5)]
    way = np.array(there + back)
    sonar = SonarSettings(REACH, 300, np.radians(1.8), 0.0427)
    path = Path.through(way - way[0])
    return World("comb", (outline - way[0],), path, 1, 2.0, rough=False, sonar=sonar)


@cache
def flown(seed: int) -> tuple[Recorded, Estimate]:
    world = comb()
    mission = fly(
        world,
        seed,
        noise=NoiseLevel.PAPER,
        echo=EchoKind.IDEAL,
        sonar=world.sonar,
        dvl=False,
        progress=lambda _: None,
    )
    recorded = measured(mission)
    return recorded, run(recorded.measurements)[0]


def closures_off(recorded: Recorded, estimate: Estimate) -> Array:
    """How far each accepted closure is off [m]."""
    stamps = [keyframe.scan.stamp_ns for keyframe in estimate.keyframes]
    truth = recorded.truth.planar[np.searchsorted(recorded.truth.stamps_ns, stamps)]
    return np.array(
        [
            np.hypot(*(between(truth[edge.first], truth[edge.second]) - edge.relative_pose)[:2])
            for edge in estimate.constraints
            if edge.kind is ConstraintKind.LOOP and edge.accepted
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_bays_that_look_alike_do_not_fold_the_map(seed: int) -> None:
    recorded, estimate = flown(seed)
    drifted = position_errors(estimate.dead_reckoning, recorded.truth)
    assert drifted.max() > 0.6 * BAY  # nearer to the wrong bay than to its own
    assert position_errors(estimate.trajectory, recorded.truth).max() < 0.1 * BAY
    off = closures_off(recorded, estimate)
    assert len(off) > 100
    assert off.max() < 0.5 * BAY
