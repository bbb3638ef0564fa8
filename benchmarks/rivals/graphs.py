# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The incremental back end beside a batch solution of the same graph, keyframe by keyframe."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import gtsam
import numpy as np

from benchmarks.tables import Table
from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.factors import between_factor, launch_prior
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Estimate
from msss_graphslam.offline.estimation import Progress

__all__ = ["GraphCosts", "compare_back_ends", "graph_table"]

PARTS = 4
"""Parts of the mission that the table shows."""


@dataclass(frozen=True, slots=True)
class GraphCosts:
    """CPU time a keyframe (n,) [s] of both, and how far apart their last poses are [m]."""

    incremental: Array
    batch: Array
    difference: float


def compare_back_ends(estimate: Estimate, progress: Progress) -> GraphCosts:
    """Give the run's constraints to both, keyframe by keyframe, as they came up in the mission."""
    accepted = [edge for edge in estimate.constraints if edge.accepted]
    count = len(estimate.keyframes)
    back_end, batch = BackEnd(BackEndConfig()), _Batch(BackEndConfig())
    back_end.add_keyframe(np.zeros(3))
    times = []
    for keyframe in range(1, count):
        progress(keyframe / count, "back ends")
        new = [edge for edge in accepted if max(edge.first, edge.second) == keyframe]
        new.sort(key=lambda edge: edge.kind is ConstraintKind.LOOP)
        clock = [time.process_time()]
        poses = back_end.update(new)
        clock.append(time.process_time())
        solution = batch.solve(new)
        clock.append(time.process_time())
        times.append(np.diff(clock))
    apart = np.hypot(*(poses - solution)[:, :2].T)
    incremental, whole = np.array(times).T
    return GraphCosts(incremental, whole, float(apart.max()))


class _Batch:
    """The whole graph by Levenberg and Marquardt, begun at the last solution."""

    def __init__(self, config: BackEndConfig) -> None:
        self._config = config
        self._graph = gtsam.NonlinearFactorGraph()
        self._poses = [np.zeros(3)]
        self._graph.add(launch_prior(self._poses[0]))

    def solve(self, constraints: Sequence[Constraint]) -> Array:
        for constraint in constraints:
            if constraint.second == len(self._poses):
                first = self._poses[constraint.first]
                self._poses.append(compose(first, constraint.relative_pose))
            self._graph.add(between_factor(constraint, self._config))
        values = gtsam.Values()
        for number, pose in enumerate(self._poses):
            values.insert(number, gtsam.Pose2(*pose))
        solution = gtsam.LevenbergMarquardtOptimizer(self._graph, values).optimize()
        self._poses = list(gtsam.utilities.extractPose2(solution))
        return np.array(self._poses)


def graph_table(world: str, costs: GraphCosts) -> Table:
    """Return a row a part of the mission."""
    rows = []
    ends = np.linspace(0, len(costs.batch), PARTS + 1).astype(int)
    for start, end in pairwise(ends):
        rows.append([f"{start + 1} to {end}", *_cells(costs, slice(start, end))])
    rows.append(["all", *_cells(costs, slice(None))])
    header = ["keyframes", "iSAM2 (ours) [ms]", "batch LM [ms]", "batch over ours"]
    title = f"back end, {world}, a keyframe; solutions {1e3 * costs.difference:.1f} mm apart"
    return Table(title, header, rows)


def _cells(costs: GraphCosts, part: slice) -> list[str]:
    ours, batch = (float(times[part].mean()) for times in (costs.incremental, costs.batch))
    return [f"{1e3 * ours:.2f}", f"{1e3 * batch:.2f}", f"{batch / ours:.1f}"]
