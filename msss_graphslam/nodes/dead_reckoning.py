# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node that reckons where the vehicle is: odometry at once, settled, and corrected."""

import sys
from time import monotonic

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.types import MapCorrection, Measurement, Odometry
from msss_graphslam.messages import decoding, link_decoding, topics
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.nodes.corrected_pose import CorrectedPose
from msss_graphslam.nodes.pose_output import PoseOutput
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.nodes.settled_output import SettledOutput
from msss_graphslam.ros.node import SlamNode, run

__all__ = ["DeadReckoningNode", "main"]

# A pose of an earlier process is waited for until so long after the start [s].
_WAIT = 1.0
_LONGEST_GAP_NS = 600 * 1_000_000_000
_PERIOD = 0.1


class DeadReckoningNode(SlamNode):
    """Measurements in; odometry, its settled form and the corrected pose out.

    For the first second measurements are queued: if this node was restarted, the latched path
    of its predecessor comes in this time, and its pose is gone on from.
    """

    def __init__(self) -> None:
        super().__init__(
            "dead_reckoning", ("sensors", "dead_reckoning", "sonar"), ("dead_reckoning",)
        )
        self._poses = PoseOutput(self)
        self._settled = SettledOutput(self)
        self._resumed = 0
        self._queue: list[Measurement] | None = []
        self._earlier: list[StampedPose] = []
        self._started = monotonic()
        self._quiet = Quiet()
        self._start_anew()
        self._listen()
        self.diagnostics.values["resumed"] = lambda: self._resumed
        self.diagnostics.values["held"] = lambda: self._reckoning.held
        self.diagnostics.values["corrections"] = lambda: self._corrected.corrections
        self.diagnostics.values["last_jump"] = lambda: self._corrected.last_jump
        self.diagnostics.values["largest_jump"] = lambda: self._corrected.largest_jump
        self.every(_PERIOD, self._look_after)

    def on_parameters(self, configuration: Configuration) -> None:
        """Reckon on with the changed parameters."""
        self._reckoning.configure(configuration.dead_reckoning)

    def on_reset(self) -> None:
        """Start anew where the next measurement comes; nothing is resumed."""
        self._queue, self._earlier = None, []
        self._settled.reset()
        self._start_anew()

    def on_save(self) -> tuple[bool, str]:
        """Work off what is held and publish it as settled."""
        if not self._quiet.is_reached():
            return False, "input still comes in"
        if self._queue:
            self._work_off(self._queue)
        held = self._reckoning.held
        self._settled.add(self._reckoning.finish())
        self._settled.publish()
        return True, f"{held} held measurements worked off"

    def _listen(self) -> None:
        # The path first: in one cycle of the executor it then goes before a measurement.
        self.listen(
            topics.RECKONED_PATH,
            link_decoding.path_poses,
            self._take_path,
            ordered=False,
            pausable=False,
        )
        sensors = self.parameters.configuration.sensors
        self.listen(topics.IMU, decoding.inertial, self._take, required=True)
        self.listen(topics.PRESSURE, lambda m: decoding.depth(m, sensors), self._take)
        self.listen(topics.DVL, decoding.body_velocity, self._take)
        # Scan generation counts what is wrong with a beam; once is enough.
        self.listen(topics.SONAR_PING, decoding.beam, self._take, single=True, shared=True)
        self.listen(
            topics.CORRECTION, link_decoding.correction, self._take_correction, ordered=False
        )

    def _start_anew(self) -> None:
        self._reckoning = PromptDeadReckoning(
            self.parameters.configuration, self.diagnostics.refused
        )
        self._corrected = CorrectedPose(self.diagnostics.refused)

    def _take(self, measurement: Measurement) -> None:
        if self._queue is None:
            self._process(measurement)
        else:
            self._queue.append(measurement)
            self._look_after()
        self._quiet.note()

    def _take_path(self, poses: list[StampedPose]) -> None:
        if self._queue is not None:
            self._earlier = poses

    def _take_correction(self, correction: MapCorrection) -> None:
        self._corrected.correct(correction)

    def _look_after(self) -> None:
        """Begin once the wait is over; hand out what no measurement has taken along."""
        if self._queue is None:
            self._settled.publish_rest()
        elif self._queue and monotonic() - self._started >= _WAIT:
            self._work_off(self._queue)

    def _work_off(self, queue: list[Measurement]) -> None:
        self._queue = None
        self._resume(min(measurement.stamp_ns for measurement in queue))
        process = self.faults.guarded(self._process, "queue")
        for measurement in queue:
            process(measurement)

    def _resume(self, first_ns: int) -> None:
        """Go on from the last pose of an earlier process, if there is one that fits."""
        if not self._earlier:
            return
        last = self._earlier[-1]
        if 0 < first_ns - last.stamp_ns <= _LONGEST_GAP_NS:
            self._reckoning.resume(last.stamp_ns, last.pose)
            self._corrected.remember(self._earlier)
            self._resumed += 1
        self._earlier = []

    def _process(self, measurement: Measurement) -> None:
        answer = self._reckoning.process(measurement)
        if answer.prompt is not None:
            self._publish(answer.prompt)
        self._settled.add(answer.settled)
        self._settled.seen(self._reckoning.reached_ns or measurement.stamp_ns)

    def _publish(self, odometry: Odometry) -> None:
        pose, covariance = self._corrected.at(odometry)
        self._poses.publish(odometry, pose, covariance)


def main() -> int:
    """Run the node."""
    return run(DeadReckoningNode)


if __name__ == "__main__":
    sys.exit(main())
