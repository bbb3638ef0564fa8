# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The whole algorithm: Algorithm 1 and Figure 4 of the paper."""

from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.beam_log import BeamLog
from msss_graphslam.core.beam_segmentation import BeamSegmenter, reject_ghosts
from msss_graphslam.core.dead_reckoning import DeadReckoning
from msss_graphslam.core.graph_slam import GraphSlam
from msss_graphslam.core.history import DeadReckoningHistory, Turn, TurnDetector
from msss_graphslam.core.online_pose import OnlinePose
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.scan_generation import generate_scan
from msss_graphslam.core.sequencing import Sequencer
from msss_graphslam.core.types import Array, Beam, Estimate, Measurement, Odometry, Stage

__all__ = ["Pipeline"]


class Pipeline:
    """Measurements in, an Estimate out; what is refused is counted in ``refused``."""

    def __init__(
        self,
        configuration: Configuration,
        recipe: Recipe,
        refused: Counter[str],
        stage: Stage = lambda _: nullcontext(),
    ) -> None:
        self._configuration = configuration
        self._recipe = recipe
        self._stage = stage
        self._sequencer = Sequencer(configuration.sensors.reorder_window, refused)
        self._dead_reckoning = DeadReckoning(configuration.dead_reckoning, refused)
        self._segmenter = BeamSegmenter(configuration.sonar, configuration.segmentation)
        self._turns = TurnDetector(configuration.scanning, refused)
        self._waiting: list[Turn] = []
        self._history = DeadReckoningHistory()
        self._slam = GraphSlam(configuration, recipe, stage)
        self._online: OnlinePose | None = None
        self._log = BeamLog()

    def process(self, measurement: Measurement) -> None:
        """Take in the next measurement in the order of arrival."""
        for ordered in self._sequencer.push(measurement):
            self._process_in_order(ordered)

    def finish(self, progress: Callable[[float], None] = lambda _: None) -> Estimate:
        """Work off what is still held, refine if the recipe says so, and return everything."""
        for ordered in self._sequencer.flush():
            self._process_in_order(ordered)
        self._reckon(self._dead_reckoning.start())
        self._finish_last_turn()
        self._log.resolve(self._history)
        self._slam.refine(progress)
        return self._estimate()

    def _process_in_order(self, measurement: Measurement) -> None:
        """Algorithm 1, lines 3 to 8, for one measurement."""
        with self._stage("dead_reckoning"):
            odometry = self._dead_reckoning.process(measurement)  # line 5
        self._reckon(odometry)
        if isinstance(measurement, Beam):
            with self._stage("beam_segmentation"):
                reading = self._segmenter.segment(measurement)
            turn = self._turns.add(reading)  # lines 4 and 7
            if turn is not None:
                self._waiting.append(turn)
            self._log.add(measurement.stamp_ns, self._online_pose(measurement.stamp_ns))
        while self._waiting and self._history.covers(self._waiting[0].end_ns):
            self._finish_turn(self._waiting.pop(0))

    def _reckon(self, odometry: list[Odometry]) -> None:
        for entry in odometry:
            self._history.append(entry)  # line 6

    def _online_pose(self, stamp_ns: int) -> Array | None:
        """Return the pose that a subscriber has at the beam, None before there is one."""
        if self._history.latest is None:
            return None
        odometry = self._history.at(stamp_ns)
        if self._online is None:
            self._online = OnlinePose(odometry)
        return self._online.at(odometry, stamp_ns)

    def _finish_turn(self, turn: Turn) -> None:
        with self._stage("scan_generation"):
            turn.readings = reject_ghosts(turn.readings, self._configuration.segmentation)
            scan = generate_scan(turn, self._history, self._configuration.sonar)  # line 8
        self._slam.add_scan(scan)  # lines 9 to 22
        self._log.resolve(self._history)
        self._history.forget_before(turn.end_ns)  # lines 23 and 24
        pose, odometry = self._slam.front_end.pose_ahead()
        if self._online is not None:
            self._online.anchor(pose, odometry, turn.end_ns, self._slam.front_end.offset)

    def _finish_last_turn(self) -> None:
        """Deviation: the paper leaves the last part turn out; the trajectory ends in it."""
        last = self._turns.finish()
        waiting, self._waiting = self._waiting, []
        for turn in waiting:
            self._finish_turn(turn)
        enough = self._configuration.scanning.part_turn
        if last is not None and last.swept >= enough and self._history.latest is not None:
            self._finish_turn(last)

    def _estimate(self) -> Estimate:
        keyframes = self._slam.keyframes()
        nodes = self._slam.front_end.nodes
        stamps = np.array([node.scan.stamp_ns for node in nodes], dtype=np.int64)
        return Estimate(
            estimator=self._recipe.name,
            trajectory=self._log.corrected(
                stamps,
                self._slam.front_end.poses,
                self._recipe.solver,
                self._slam.front_end.offset,
            ),
            online=self._log.online,
            dead_reckoning=self._log.dead_reckoning,
            keyframes=keyframes,
            first_scans=tuple(node.first_scan for node in nodes),
            constraints=tuple(self._slam.constraints),
        )
