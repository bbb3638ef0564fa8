# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The whole algorithm: Algorithm 1 and Figure 4 of the paper."""

from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.graph_slam import GraphSlam
from msss_graphslam.core.logbook import Logbook
from msss_graphslam.core.online_pose import OnlinePose
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.reckoning.sequencing import Sequencer
from msss_graphslam.core.scans.persistence import persistence_of
from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Beam, Estimate, Measurement, Odometry, Scan, Stage

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
        self._stage = stage
        sensors = configuration.sensors
        self._sequencer = Sequencer(sensors.reorder_window, sensors.patience, refused)
        self._dead_reckoning = DeadReckoning(configuration.dead_reckoning, refused)
        self._scans = ScanGenerator(configuration, refused, stage)
        self._previews = recipe.goes_beyond
        self._slam = GraphSlam(configuration, recipe, stage)
        self._logbook = Logbook(configuration, recipe, stage)
        self._persistence = persistence_of(configuration.dead_reckoning)
        self._latest: Odometry | None = None
        self._online: OnlinePose | None = None

    def process(self, measurement: Measurement) -> None:
        """Take in the next measurement in the order of arrival."""
        for ordered in self._sequencer.push(measurement):
            self._process_in_order(ordered)

    def finish(self, progress: Callable[[float], None] = lambda _: None) -> Estimate:
        """Work off what is still held, smooth if the recipe says so, and return everything."""
        for ordered in self._sequencer.flush():
            self._process_in_order(ordered)
        self._reckon(self._dead_reckoning.start())
        self._add(self._scans.finish())
        # What comes needs the memory of the graph that has grown so far.
        del self._slam, self._online
        return self._logbook.finish(progress)

    def _process_in_order(self, measurement: Measurement) -> None:
        """Algorithm 1, lines 3 to 8, for one measurement."""
        with self._stage("dead_reckoning"):
            odometry = self._dead_reckoning.process(measurement)  # line 5
        self._reckon(odometry)
        if isinstance(measurement, Beam):
            self._note_online(measurement.stamp_ns)
            self._add(self._scans.add_beam(measurement))  # lines 4, 7 and 8
            if self._previews:
                self._preview()

    def _reckon(self, odometry: list[Odometry]) -> None:
        for entry in odometry:
            self._latest = entry
            if self._online is not None:
                self._online.remember(entry)
            self._add(self._scans.add_odometry(entry))  # line 6

    def _note_online(self, stamp_ns: int) -> None:
        """Note the pose that a subscriber has at the beam, once there is one."""
        if self._latest is None:
            return
        if self._online is None:
            self._online = OnlinePose(self._latest, self._persistence)
        self._logbook.add_online(stamp_ns, self._online.at(self._latest, stamp_ns))

    def _preview(self) -> None:
        """Correct the online pose by the turn in progress, and nothing else."""
        part = self._scans.part()
        if part is None or self._online is None:
            return
        with self._stage("scan_matching"):
            correction = self._slam.front_end.preview(part)
        if correction is not None:
            self._online.correct(correction)

    def _add(self, scans: list[Scan]) -> None:
        for scan in scans:
            self._logbook.add_scan(scan)
            if scan.usable:
                self._add_keyframe(scan)

    def _add_keyframe(self, scan: Scan) -> None:
        self._slam.add_scan(scan)  # lines 9 to 22
        self._logbook.constraints = self._slam.constraints
        self._logbook.poses = self._slam.front_end.poses
        correction = self._slam.front_end.correction()
        self._logbook.twist_error = correction.twist_error
        if self._online is not None:
            self._online.correct(correction)
