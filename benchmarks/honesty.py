# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One simulated mission: what the estimator stated at the time, and how far off it was."""

from collections import Counter
from collections.abc import Iterable

import numpy as np

from benchmarks.flights import Flight
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose, wrap
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Estimate, Scan, Trajectory
from msss_graphslam.evaluation.errors import interpolate

__all__ = ["KINDS", "STEPS", "Statements", "statements"]

KINDS = {
    "pose": "`pose` as a subscriber gets it, at a beam",
    "newest": "newest keyframe, when it was added",
    "consecutive": "constraint between consecutive scans, when it was made",
    "loop": "loop closure, when it was made",
    "final": "keyframes at the end",
}
STEPS = 40
"""Times at which a mission is looked at, evenly from a twentieth of it to its end."""

Statements = dict[str, Array]
"""By kind: errors (STEPS, 3) beside covariances (STEPS, 3, 3), flat in a row (STEPS, 12)."""


class _Watched(Pipeline):
    """Notes pose and covariance at every beam, and the constraints as they were made."""

    def __init__(self, configuration: Configuration) -> None:
        super().__init__(configuration, ESTIMATORS["full"], Counter())
        self.published: list[tuple[int, Array, Array]] = []
        self.tried: list[Constraint] = []
        self.newest: list[tuple[int, Array, Array]] = []
        self.first: tuple[int, Array] | None = None

    def _note_online(self, stamp_ns: int) -> None:
        super()._note_online(stamp_ns)
        if self._online is None or self._latest is None or len(self.newest) < 1:
            return
        pose = self._online.at(self._latest, stamp_ns)
        covariance = self._online.covariance(self._latest)
        planar = np.ix_([0, 1, 5], [0, 1, 5])
        self.published.append((stamp_ns, pose[[0, 1, 5]], covariance[planar]))

    def _add_keyframe(self, scan: Scan) -> None:
        before = len(self._logbook.constraints)
        super()._add_keyframe(scan)
        self.tried += self._logbook.constraints[before:]
        front_end = self._slam.front_end
        if self.first is None:
            self.first = scan.stamp_ns, front_end.poses[0].copy()
            return
        row = scan.stamp_ns, front_end.poses[-1].copy(), front_end.nodes[-1].covariance.copy()
        self.newest.append(row)


def statements(flight: Flight) -> Statements:
    """Run ``full`` over the mission and return what it stated beside its errors."""
    pipeline = _Watched(Configuration())
    for measurement in flight.measurements():
        pipeline.process(measurement)
    estimate = pipeline.finish()
    if pipeline.first is None:
        raise ValueError("the mission has no keyframe")
    truth = _Truth(flight.truth, *pipeline.first)
    stamps = [frame.scan.stamp_ns for frame in estimate.keyframes]
    rows = {
        "pose": truth.of_poses(pipeline.published),
        "newest": truth.of_poses(pipeline.newest),
        "final": truth.of_poses(_final(estimate)),
    }
    for kind in (ConstraintKind.CONSECUTIVE, ConstraintKind.LOOP):
        accepted = [edge for edge in pipeline.tried if edge.accepted and edge.kind is kind]
        rows[kind] = truth.of_constraints(accepted, stamps)
    return {kind: _sampled(*found, flight.truth) for kind, found in rows.items()}


class _Truth:
    """The true poses, with the first keyframe put upon its own: the map's gauge."""

    def __init__(self, truth: Trajectory, first_ns: int, first: Array) -> None:
        self._truth = truth
        self._at_first = self._at([first_ns])[0]
        self._first = first

    def of_poses(self, stated: Iterable[tuple[int, Array, Array]]) -> tuple[Array, Array]:
        """Return the stamps (n,) and, beside each other, errors and covariances (n, 12)."""
        stamps, poses, covariances = zip(*stated, strict=True)
        wanted = compose(self._first, between(self._at_first, self._at(stamps)))
        return np.array(stamps), _beside(np.array(poses) - wanted, np.array(covariances))

    def of_constraints(
        self, edges: Iterable[Constraint], stamps: list[int]
    ) -> tuple[Array, Array]:
        """Return the same for constraints between the keyframes of these stamps."""
        edges = list(edges)
        first = self._at([stamps[edge.first] for edge in edges])
        second = self._at([stamps[edge.second] for edge in edges])
        errors = np.array([edge.relative_pose for edge in edges]) - between(first, second)
        ends = np.array([stamps[edge.second] for edge in edges])
        return ends, _beside(errors, np.array([edge.covariance for edge in edges]))

    def _at(self, stamps: Iterable[int]) -> Array:
        return interpolate(self._truth, np.array(list(stamps), dtype=np.int64))[0]


def _final(estimate: Estimate) -> list[tuple[int, Array, Array]]:
    return [
        (frame.scan.stamp_ns, frame.pose, frame.covariance) for frame in estimate.keyframes[1:]
    ]


def _beside(errors: Array, covariances: Array) -> Array:
    errors[:, 2] = wrap(errors[:, 2])
    return np.hstack([errors, covariances.reshape(-1, 9)])


def _sampled(stamps: Array, rows: Array, truth: Trajectory) -> Array:
    """Return the rows nearest to the steps (STEPS, 12), which are the same for all missions."""
    begin, end = truth.stamps_ns[[0, -1]].astype(float)
    steps = begin + (end - begin) * np.linspace(0.05, 1.0, STEPS)
    nearest = np.abs(stamps.astype(float)[:, None] - steps).argmin(axis=0)
    return np.asarray(rows[nearest])
