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

from msss_graphslam.core.back_end import LAUNCH_VARIANCE
from msss_graphslam.core.bent_pair import Pairing, pairing
from msss_graphslam.core.bent_scan import BentScan, bend, reckoned_ends
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.motion_feedback import Persistence, offset_motion
from msss_graphslam.core.normal_equations import NormalEquations
from msss_graphslam.core.scan_generation import reckoned_motion
from msss_graphslam.core.types import Array, Scan

__all__ = ["Reach", "Smoothed", "smooth"]

ROUNDS = 45
"""Most steps: narrowing the reach from metres takes thirty of them."""

NARROWING = 0.93
"""From step to step; with more haste, scans settle on a face beside the face."""

SETTLED = 2e-3
"""A step in which no keyframe moves farther than this is the last [m, rad]."""

LEAST_VARIANCE = 1e-12
"""Of a twist error that dead reckoning excludes [m^2/s^2, rad^2/s^2]."""


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
    problem = _Problem(scans, pairs, persistence)
    states = np.vstack([poses, _end(scans[-1], poses[-1], last_twist)])
    for number in range(ROUNDS):
        equations, _ = problem.linearised(states, reach.at(number))
        step = equations.solution()
        states[1:] += step
        progress((number + 1) / ROUNDS)
        narrow = reach.at(number) <= reach.last
        if narrow and np.abs(step).max() < SETTLED:
            break
    equations, bent = problem.linearised(states, reach.last)
    covariances = equations.covariances()
    covariances[0] = LAUNCH_VARIANCE * np.eye(3)
    last = equations.covariance_of_last(2)
    by_keyframes = bent[-1].twist_by_keyframes
    progress(1.0)
    return Smoothed(
        states[:-1], covariances[:-1], bent[-1].twist, by_keyframes @ last @ by_keyframes.T
    )


class _Problem:
    """What does not change from step to step."""

    def __init__(
        self,
        scans: Sequence[Scan],
        pairs: Sequence[tuple[int, int]],
        persistence: Persistence,
    ) -> None:
        self._scans = scans
        self._pairs = pairs
        self._weights = _weights(pairs, len(scans))
        self._persistence = persistence
        self._widest = max((scan.twist_covariance for scan in scans), key=_trace)
        self._ends = reckoned_ends(scans)
        stamps = [scan.stamp_ns for scan in scans] + [scans[-1].end_stamp_ns]
        self._durations = np.maximum(np.diff(stamps) * 1e-9, 1e-3)

    def linearised(self, states: Array, reach: float) -> tuple[NormalEquations, list[BentScan]]:
        """Return the normal equations at the states (n + 1, 3), and the scans laid out by them."""
        rows = zip(self._scans, self._ends, states[:-1], states[1:], self._durations, strict=True)
        bent = [bend(scan, end, first, last, seconds) for scan, end, first, last, seconds in rows]
        equations = NormalEquations(len(states))
        self._add_priors(equations, bent)
        for (first, second), weight in zip(self._pairs, self._weights, strict=True):
            for moving, lines in ((first, second), (second, first)):
                found = pairing(bent[moving], bent[lines], reach)
                if found is not None:
                    # Both ways make one measurement.
                    _add_pairing(equations, found, moving, lines, 0.5 * weight)
        return equations, bent

    def _doubt(self, scan: Scan) -> Array:
        # Of a scan that was lost on its way only the pose is left.
        known = scan.twist_covariance
        return known if known.any() else self._widest

    def _add_priors(self, equations: NormalEquations, bent: Sequence[BentScan]) -> None:
        """Twist errors are a Gauss-Markov chain, scan by scan."""
        before: BentScan | None = None
        for number, (scan, now) in enumerate(zip(self._scans, bent, strict=True)):
            spread = self._doubt(scan) + LEAST_VARIANCE * np.eye(3)
            error, jacobian, nodes = now.twist, now.twist_by_keyframes, [number, number + 1]
            if before is not None:
                kept = self._persistence.over(before.duration, spread)
                error = error - kept * before.twist
                spread = spread - np.outer(kept, kept) * spread
                jacobian = _side_by_side(kept, before, now)
                nodes = [number - 1, *nodes]
            information = jacobian.T @ np.linalg.inv(spread)
            equations.add(nodes, information @ jacobian, information @ error)
            before = now


def _end(scan: Scan, pose: Array, twist: Array) -> Array:
    motion = offset_motion(reckoned_motion(scan.reckoned), scan.beam_times, twist)
    return compose(pose, motion[-1])


def _side_by_side(kept: Array, before: BentScan, now: BentScan) -> Array:
    """Return the derivative (3, 9) of a step of the chain by the three keyframes it spans."""
    jacobian = np.zeros((3, 9))
    jacobian[:, :6] -= kept[:, None] * before.twist_by_keyframes
    jacobian[:, 3:] += now.twist_by_keyframes
    return jacobian


def _add_pairing(
    equations: NormalEquations, found: Pairing, moving: int, lines: int, weight: float
) -> None:
    nodes = [moving, moving + 1, lines, lines + 1]
    equations.add(nodes, weight * found.information, weight * found.gradient)


def _trace(matrix: Array) -> float:
    return float(np.trace(matrix))


def _weights(pairs: Sequence[tuple[int, int]], count: int) -> Array:
    """Return what a pair counts (p,): its scans' noise is in all their other pairs as well.

    K scans of one wall make K (K - 1) / 2 pairs; at 2 / K each they say of a scan's place what its
    own noise and a wall known by the others allow, and no more.
    """
    ends = np.asarray(pairs, dtype=np.intp).reshape(-1, 2)
    partners = np.bincount(ends.ravel(), minlength=count)
    return np.asarray(2.0 / (1.0 + 0.5 * partners[ends].sum(axis=1)))
