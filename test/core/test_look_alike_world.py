# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Worlds that look alike: a comb of equal bays, and a basin with the same corner at both ends."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from small_mission import Recorded, measured, position_errors, run

from msss_graphslam.core.compounding import between, wrap
from msss_graphslam.core.graph.closure_review import LAYOUT
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Estimate
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


def twin_corners() -> World:
    """A basin that half a turn leaves as it is, in the middle nothing but two parallel walls.

    The face of a corner's step looks like the end wall behind it to one who is unsure by metres.
    """
    half = [(0, 0), (2, 0), (2, 1.5), (4, 1.5), (4, 0), (30, 0)]
    outline = np.array([*half, *(np.array([30.0, 10.0]) - half)])
    there = [(5, 3.5), (10, 3.2), (15, 3.2), (20, 3.2), (25.5, 3.5), (27, 5)]
    back = [(25, 6.5), (20, 6.8), (15, 6.8), (10, 6.8), (4.5, 6.5), (3, 5)]
    way = np.array(there + back, dtype=float)
    sonar = SonarSettings(8.0, 160, np.radians(1.8), 0.0427)
    path = Path.through(way - way[0])
    return World("twin corners", (outline - way[0],), path, 2, 2.0, rough=False, sonar=sonar)


@cache
def flown(
    world: Callable[[], World], seed: int, noise: NoiseLevel, echo: EchoKind
) -> tuple[Recorded, Estimate]:
    place = world()
    mission = fly(
        place,
        seed,
        noise=noise,
        echo=echo,
        sonar=place.sonar,
        dvl=False,
        progress=lambda _: None,
    )
    recorded = measured(mission)
    return recorded, run(recorded.measurements)[0]


def closures_off(recorded: Recorded, estimate: Estimate) -> list[tuple[Constraint, Array]]:
    """Return the accepted closures, and how far off each is [m, m, rad]."""
    stamps = [keyframe.scan.stamp_ns for keyframe in estimate.keyframes]
    truth = recorded.truth.planar[np.searchsorted(recorded.truth.stamps_ns, stamps)]
    accepted = [
        edge for edge in estimate.constraints if edge.kind is ConstraintKind.LOOP and edge.accepted
    ]
    off = [
        between(truth[edge.first], truth[edge.second]) - edge.relative_pose for edge in accepted
    ]
    return [
        (edge, np.append(error[:2], wrap(error[2])))
        for edge, error in zip(accepted, off, strict=True)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_bays_that_look_alike_do_not_fold_the_map(seed: int) -> None:
    recorded, estimate = flown(comb, seed, NoiseLevel.PAPER, EchoKind.IDEAL)
    drifted = position_errors(estimate.dead_reckoning, recorded.truth)
    assert drifted.max() > 0.6 * BAY  # nearer to the wrong bay than to its own
    assert position_errors(estimate.trajectory, recorded.truth).max() < 0.1 * BAY
    off = np.array([np.hypot(*error[:2]) for _, error in closures_off(recorded, estimate)])
    assert len(off) > 100
    assert off.max() < 0.5 * BAY


@pytest.mark.slow
def test_corners_that_look_alike_are_not_taken_for_each_other() -> None:
    """Of a closure along parallel walls the covariance says how little it knows."""
    recorded, estimate = flown(twin_corners, 1, NoiseLevel.HIGH, EchoKind.REAL)
    assert position_errors(estimate.dead_reckoning, recorded.truth).max() > 8.0
    closures = closures_off(recorded, estimate)
    assert len(closures) > 100
    surprises = [
        error @ np.linalg.solve(edge.covariance + LAYOUT, error) for edge, error in closures
    ]
    assert max(surprises) < 50.0
