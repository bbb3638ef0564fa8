# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front ends that have seen the first scans of a short simulated mission."""

from dataclasses import dataclass

import numpy as np
from small_mission import recorded, scans

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.graph_slam import GraphSlam
from msss_graphslam.core.recipes import ESTIMATORS, Recipe
from msss_graphslam.core.types import Array, Constraint

CONFIGURATION = Configuration()
FULL, CHEN = ESTIMATORS["full"], ESTIMATORS["chen2015"]


def true_poses() -> Array:
    """The truth (n, 3) at every keyframe."""
    truth = recorded().truth
    at = np.searchsorted(truth.stamps_ns, [scan.stamp_ns for scan in scans()])
    return truth.planar[at]


@dataclass(frozen=True)
class Slam:
    """A front end that has seen scans, and the constraints tried."""

    front_end: FrontEnd
    constraints: list[Constraint]


def slam_of(recipe: Recipe, count: int = 99) -> Slam:
    slam = GraphSlam(CONFIGURATION, recipe)
    tried = [entry for scan in scans()[:count] for entry in slam.add_scan(scan)]
    return Slam(slam.front_end, tried)


def pose_errors(poses: Array) -> Array:
    """The position errors (n,) of poses that begin at the first true one."""
    found, true = between(poses[0], poses), between(true_poses()[0], true_poses())
    return np.asarray(np.linalg.norm(found[:, :2] - true[: len(found), :2], axis=1))


def kinds(constraints: list[Constraint]) -> list[str]:
    return [str(constraint.kind) for constraint in constraints]
