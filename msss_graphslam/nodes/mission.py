# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end between its links: the graph of a mission, and all that is made of it."""

from collections import Counter
from contextlib import nullcontext

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.beam_log import BeamLog
from msss_graphslam.core.graph.guarded_back_end import GuardedBackEnd
from msss_graphslam.core.logbook import Logbook
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.types import (
    Array,
    Constraint,
    GraphPoses,
    Keyframe,
    KeyframeReport,
    Scan,
    Stage,
    Trajectory,
)
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.nodes.mission_scans import brought_together

__all__ = ["Mission"]


class Mission:
    """Keyframes, scans and published poses as they come; a Logbook of them at any time.

    Scans and keyframes come by different ways, in any order against each other; they are brought
    together by stamp. ``last_jump`` and ``largest_jump`` [m] are by how much an update has moved
    the newest keyframe. What is refused is counted in ``refused``.
    """

    def __init__(
        self,
        configuration: Configuration,
        recipe: Recipe,
        refused: Counter[str],
        stage: Stage = lambda _: nullcontext(),
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._refused = refused
        self._stage = stage
        self._back_end = self._new_back_end()
        self._reports: list[KeyframeReport] = []
        self._covariances: list[Array] = []
        self._scans: dict[int, Scan] = {}
        self._online: list[StampedPose] = []
        self.poses: Array = np.empty((0, 3))
        self.last_jump = self.largest_jump = 0.0

    @property
    def constraints(self) -> list[Constraint]:
        """All constraints tried, in order, refused as they stand now."""
        return self._back_end.tried

    @property
    def withdrawals(self) -> int:
        """How many loop closures have been taken out of the graph again."""
        return self._back_end.withdrawals

    @property
    def beams(self) -> int:
        """How many beams the scans hold."""
        return sum(len(scan.beam_stamps_ns) for scan in self._scans.values())

    @property
    def scans(self) -> int:
        """How many scans have come, those that make no keyframe among them."""
        return len(self._scans)

    @property
    def is_whole(self) -> bool:
        """Whether there are scans, and keyframes of exactly those that make one."""
        usable = {stamp for stamp, scan in self._scans.items() if scan.usable}
        return bool(self._scans) and usable == {report.stamp_ns for report in self._reports}

    @property
    def newest_ns(self) -> int:
        """Stamp of the newest keyframe, 0 without any."""
        return self._reports[-1].stamp_ns if self._reports else 0

    def add_scan(self, scan: Scan) -> None:
        """Note a scan, once."""
        self._scans.setdefault(scan.stamp_ns, scan)

    def add_online(self, published: StampedPose) -> None:
        """Note a pose as a subscriber got it."""
        self._online.append(published)

    def take(self, report: KeyframeReport) -> bool:
        """Take in a keyframe; return whether there is a new one."""
        reason = self._objection(report)
        if reason is None:
            return False
        if not reason:
            reason = self._optimise(report)
        if reason:
            self._refused[reason] += 1
            return False
        return True

    def answer(self) -> GraphPoses:
        """Return what the front end is told."""
        return GraphPoses(
            stamps_ns=self._stamps,
            poses=self.poses,
            odometry=np.array([report.odometry for report in self._reports]).reshape(-1, 3),
            covariances=np.array(self._covariances).reshape(-1, 3, 3),
        )

    def keyframe_path(self) -> Trajectory:
        """Return the keyframes' poses, level, at the heights of their scans where these came."""
        poses = np.zeros((len(self.poses), 6))
        poses[:, [0, 1, 5]] = self.poses
        for row, report in zip(poses, self._reports, strict=True):
            scan = self._scans.get(report.stamp_ns)
            row[2] = scan.heights[0] if scan is not None else 0.0
        return Trajectory(self._stamps, poses)

    def logbook(self) -> Logbook:
        """Return a Logbook of its own: what is done to it does not touch the running graph."""
        logbook = Logbook(self._configuration, self._recipe, self._stage)
        for scan in brought_together(self._scans, self._reports):
            logbook.add_scan(scan)
        for published in self._online:
            logbook.add_online(published.stamp_ns, published.pose)
        logbook.constraints = list(self.constraints)
        logbook.poses = self.poses.copy()
        logbook.twist_error = self._reports[-1].twist_error if self._reports else None
        return logbook

    def trajectory(self) -> Trajectory:
        """Return the corrected trajectory as it stands."""
        beams = BeamLog()
        scans = brought_together(self._scans, self._reports)
        for scan in scans:
            beams.add_scan(scan)
        error = np.zeros(3)
        if self._recipe.goes_beyond and self._reports:
            error = self._reports[-1].twist_error.mean
        keyframes = [scan for scan in scans if scan.usable]
        return beams.corrected(keyframes, self.poses, self._recipe.solver, error)

    def keyframes(self) -> list[Keyframe]:
        """Return the keyframes with their scans as the trajectory lays them out."""
        rows = zip(self.logbook().keyframe_scans(), self.poses, self._covariances, strict=True)
        return [Keyframe(*row) for row in rows]

    @property
    def _stamps(self) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        return np.array([report.stamp_ns for report in self._reports], dtype=np.int64)

    def _objection(self, report: KeyframeReport) -> str | None:
        """Say why a keyframe cannot be the next, '' if it can; None for one that is known."""
        count = len(self._reports)
        if report.number > count:
            return "keyframe_out_of_order"
        if report.number < count:
            known = self._reports[report.number].stamp_ns == report.stamp_ns
            return None if known else "keyframe_of_another_mission"
        if count and report.stamp_ns <= self.newest_ns:
            return "keyframe_of_another_mission"
        if not np.isfinite(report.pose).all():
            return "keyframe_not_finite"
        if count and not any(entry.accepted for entry in report.constraints):
            return "keyframe_without_constraint"
        return ""

    def _optimise(self, report: KeyframeReport) -> str:
        """Take the keyframe into the graph; return why that cannot be, or ''."""
        try:
            with self._stage("back_end"):
                poses, covariance = self._back_end.take(report.pose, report.constraints)
        except ValueError as error:
            return str(error).rpartition(": ")[2]
        except RuntimeError:
            self._rebuild()
            return "graph_not_solvable"
        self.last_jump = float(np.linalg.norm(poses[-1, :2] - report.pose[:2]))
        self.largest_jump = max(self.largest_jump, self.last_jump)
        self.poses = poses
        self._covariances.append(covariance)
        self._reports.append(report)
        return ""

    def _new_back_end(self) -> GuardedBackEnd:
        return GuardedBackEnd(self._configuration.back_end, guards=self._recipe.goes_beyond)

    def _rebuild(self) -> None:
        self._back_end = self._new_back_end()
        for report in self._reports:
            self._back_end.take(report.pose, report.constraints)
