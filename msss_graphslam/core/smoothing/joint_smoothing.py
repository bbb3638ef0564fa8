# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Joint smoothing: all keyframes and the motion within all scans in one least-squares problem."""

# Deviation: the paper matches scans as rigid bodies. Where the motion in a turn is badly known,
# most of all without an IMU, the answer is wrong by what the scans are bent, and its covariance
# does not say so. Here a scan hangs between its keyframe and the next, a constant twist error
# takes it from one to the other, and what dead reckoning doubts of that twist is the prior.

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import compose
from msss_graphslam.core.graph.factors import LAUNCH_VARIANCE
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.scans.scan_generation import reckoned_motion
from msss_graphslam.core.smoothing.joint_problem import JointProblem
from msss_graphslam.core.types import Array, Scan, SonarCalibration

__all__ = ["Reach", "Smoothed", "smooth"]

ROUNDS = 45
"""Most steps: narrowing the reach from metres takes thirty of them."""

NARROWING = 0.93
"""From step to step; with more haste, scans settle on a face beside the face."""

SETTLED = 2e-3
"""A step in which no keyframe moves farther than this is the last [m, rad]."""


@dataclass(frozen=True, slots=True)
class Reach:
    """How far from a line a point is still paired with it [m]: in the first step, in the last."""

    first: float
    last: float

    def at(self, step: int) -> float:
        """Return the reach in a step, counted from 0."""
        return max(self.last, self.first * NARROWING**step)


@dataclass(frozen=True, slots=True)
class Smoothed:
    """The keyframes' ``poses`` (n, 3) in ``map``, their ``covariances`` (n, 3, 3).

    ``twist`` (3,) is the last scan's twist error, ``twist_covariance`` (3, 3) its covariance.
    """

    poses: Array
    covariances: Array
    twist: Array
    twist_covariance: Array
    sonar_calibration: SonarCalibration | None = None


def smooth(
    scans: Sequence[Scan],
    poses: Array,
    last_twist: Array,
    pairs: Sequence[tuple[int, int]],
    persistence: Persistence,
    reach: Reach,
    progress: Callable[[float], None] = lambda _: None,
) -> Smoothed:
    """Align the scans of all ``pairs`` at once, from the ``poses`` (n, 3) on.

    ``scans`` are as dead reckoning laid them out, of whose last one ``last_twist`` (3,) is the
    twist error as far as it is known. The first pose stays.
    """
    problem = JointProblem(scans, pairs, persistence)
    states = np.vstack([poses, _end(scans[-1], poses[-1], last_twist)])
    for number in range(ROUNDS):
        step = problem.linearised(states, reach.at(number)).solution()
        states[1:] += step
        progress((number + 1) / ROUNDS)
        narrow = reach.at(number) <= reach.last
        if narrow and np.abs(step).max() < SETTLED:
            break
    found = _found(problem, states, reach.last)
    progress(1.0)
    return found


def _found(problem: JointProblem, states: Array, reach: float) -> Smoothed:
    equations = problem.linearised(states, reach)
    problem.forget()
    twists, by_keyframes = problem.twists(states)
    spread = by_keyframes[-1] @ equations.covariance_of_last(2) @ by_keyframes[-1].T
    calibration = problem.sonar_calibration(equations, states)
    # Last, as it does without what the others need.
    covariances = equations.covariances()
    covariances[0] = LAUNCH_VARIANCE * np.eye(3)
    return Smoothed(states[:-1], covariances[:-1], twists[-1], spread, calibration)


def _end(scan: Scan, pose: Array, twist: Array) -> Array:
    motion = offset_motion(reckoned_motion(scan.reckoned), scan.beam_times, twist)
    return compose(pose, motion[-1])
