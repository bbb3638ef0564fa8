# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""All that is known at the end of a run: what every file, figure and table is made from."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.core.types import Array, Beam, ConstraintKind, Estimate, Trajectory

__all__ = ["BagInfo", "Cost", "RunRecord", "example_scan"]


@dataclass(frozen=True, slots=True)
class BagInfo:
    """Where the data came from.

    ``messages`` counts the messages by topic; ``missing`` and ``damage`` are sentences on what the
    estimation had to do without, and on what could not be read.
    """

    name: str
    start_ns: int
    end_ns: int
    messages: dict[str, int]
    missing: tuple[str, ...] = ()
    damage: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Length of the recording [s]."""
        return (self.end_ns - self.start_ns) * 1e-9


@dataclass(frozen=True, slots=True)
class Cost:
    """What the run took: wall and CPU time [s], peak resident memory [MiB].

    ``stages`` holds for each stage of the pipeline the times of its calls [s].
    """

    wall: float
    cpu: float
    peak_rss_mib: float
    stages: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RunRecord:
    """One estimator's run over one recording.

    ``points`` (n, 2) or (n, 3) is the point map [m] in ``map``. ``truth`` is None where the
    recording has none; no figure of error is made then. ``example_beams`` are the beams of the
    scan that example_scan names, as the head sent them, where the runner kept them.
    """

    estimate: Estimate
    points: Array
    grid: OccupancyGrid
    truth: Trajectory | None
    beams: int
    refused: Counter[str]
    configuration: dict[str, dict[str, Any]]
    bag: BagInfo
    cost: Cost
    version: str
    command: str
    example_beams: tuple[Beam, ...] = ()

    @property
    def estimator(self) -> str:
        """The estimator's name."""
        return self.estimate.estimator

    @property
    def keyframe_trajectory(self) -> Trajectory:
        """The optimised keyframe poses, level, at the height of each scan's first beam."""
        keyframes = self.estimate.keyframes
        poses = np.zeros((len(keyframes), 6))
        for row, keyframe in zip(poses, keyframes, strict=True):
            row[[0, 1, 5]] = keyframe.pose
            row[2] = keyframe.scan.heights[0]
        stamps = np.array([keyframe.scan.stamp_ns for keyframe in keyframes], dtype=np.int64)
        return Trajectory(stamps, poses)

    @property
    def tried_loops(self) -> int:
        """How many loop closures were tried."""
        return sum(edge.kind is ConstraintKind.LOOP for edge in self.estimate.constraints)

    @property
    def accepted_loops(self) -> int:
        """How many loop closures are part of the graph."""
        return sum(
            edge.kind is ConstraintKind.LOOP and edge.accepted
            for edge in self.estimate.constraints
        )

    @property
    def realtime_factor(self) -> float:
        """Seconds of mission worked off in a second of wall time."""
        return self.bag.duration / self.cost.wall


def example_scan(estimate: Estimate) -> int | None:
    """Return the keyframe whose turn shows the motion best, or None without a complete scan.

    It is the complete scan during which the vehicle moved farthest.
    """
    complete = [
        (float((frame.scan.motion[-1, :2] ** 2).sum()), -number)
        for number, frame in enumerate(estimate.keyframes)
        if frame.scan.complete
    ]
    return -max(complete)[1] if complete else None
