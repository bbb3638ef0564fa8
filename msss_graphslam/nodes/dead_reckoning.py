# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node that reckons where the vehicle is: odometry at once, settled, and corrected."""

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.reckoning.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.scans.persistence import persistence_of
from msss_graphslam.core.types import Beam, MapCorrection, Measurement, Odometry
from msss_graphslam.messages import decoding, link_decoding, topics
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.nodes.arrived import Gathering, take_arrived
from msss_graphslam.nodes.beam_relay import BeamRelay
from msss_graphslam.nodes.corrected_pose import CorrectedPose
from msss_graphslam.nodes.pose_output import PoseOutput
from msss_graphslam.nodes.predecessor import Predecessor
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.nodes.settled_output import SettledOutput
from msss_graphslam.ros.inputs import Input
from msss_graphslam.ros.node import SlamNode, leave, run

__all__ = ["DeadReckoningNode", "main"]

_LONGEST_GAP_NS = 600 * 1_000_000_000
_PERIOD = 0.1


class DeadReckoningNode(SlamNode):
    """Measurements in; odometry, its settled form and the corrected pose out.

    For the first seconds measurements are queued: if this node was restarted, the latched path
    of its predecessor comes in this time, and its pose is gone on from.
    """

    def __init__(self) -> None:
        super().__init__(
            "dead_reckoning", ("sensors", "dead_reckoning", "sonar"), ("dead_reckoning",)
        )
        self._poses = PoseOutput(self)
        self._settled = SettledOutput(self)
        self._relay = BeamRelay(self)
        self._resumed = 0
        self._queue: list[Measurement] | None = []
        self._predecessor = Predecessor(
            lambda: self.count_publishers(topics.RECKONED_PATH.name) > 0
        )
        self._quiet = Quiet()
        self._arrived: list[Measurement] = []
        self._gathering = Gathering()
        self._process_safely = self.faults.guarded(self._process, "measurement")
        self._start_anew()
        self._gathering.inputs = self._listen()
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
        self._queue = None
        self._settled.reset()
        self._start_anew()

    def on_save(self) -> tuple[bool, str]:
        """Work off what is held and publish it as settled."""
        take_arrived(self._gathering.inputs)
        if not self._quiet.is_reached():
            return False, "input still comes in"
        if self._queue:
            if not self._may_begin(self._queue):
                return False, "waiting for the way of before the start"
            self._work_off(self._queue)
        held = self._reckoning.held
        self._settled.add(self._reckoning.finish())
        self._settled.publish()
        return True, f"{held} held measurements worked off"

    def _listen(self) -> list[Input]:
        # The path first: in one cycle of the executor it then goes before a measurement.
        self.listen(
            topics.RECKONED_PATH,
            link_decoding.path_poses,
            self._take_path,
            ordered=False,
            pausable=False,
        )
        sensors = self.parameters.configuration.sensors
        self.listen(
            topics.CORRECTION, link_decoding.correction, self._take_correction, ordered=False
        )
        return [
            self.listen(topics.IMU, decoding.inertial, self._take, required=True),
            self.listen(topics.PRESSURE, lambda m: decoding.depth(m, sensors), self._take),
            self.listen(topics.DVL, decoding.body_velocity, self._take),
            # Scan generation counts what is wrong with a beam; once is enough.
            self.listen(
                topics.SONAR_PING, decoding.beam, self._take_beam, single=True, shared=True
            ),
        ]

    def _start_anew(self) -> None:
        self._reckoning = PromptDeadReckoning(
            self.parameters.configuration, self.diagnostics.refused
        )
        self._corrected = CorrectedPose(
            self.diagnostics.refused,
            persistence_of(self.parameters.configuration.dead_reckoning),
        )

    def _take_beam(self, beam: Beam) -> None:
        self._relay.add(beam)
        self._take(beam)

    def _take(self, measurement: Measurement) -> None:
        """Take a measurement, and with it all that have arrived; the oldest goes first.

        The executor gives one of each topic in turn: where they have piled up, the sensors would
        get out of step.
        """
        self._arrived.append(measurement)
        if not self._gathering.take():
            return
        arrived, self._arrived = self._arrived, []
        self._process_all(sorted(arrived, key=lambda one: one.stamp_ns))
        self._quiet.note()

    def _process_all(self, measurements: list[Measurement]) -> None:
        if self._queue is not None:
            self._queue += measurements
            self._look_after()
            return
        for measurement in measurements:
            self._process_safely(measurement)

    def _take_path(self, poses: list[StampedPose]) -> None:
        if self._queue is not None:
            self._predecessor.tell(poses)

    def _take_correction(self, correction: MapCorrection) -> None:
        self._corrected.correct(correction)

    def _look_after(self) -> None:
        """Begin once the wait is over; hand out what no measurement has taken along."""
        if self._queue is None:
            self._settled.publish_rest()
        elif self._queue and self._may_begin(self._queue):
            self._work_off(self._queue)

    def _may_begin(self, queue: list[Measurement]) -> bool:
        return self._predecessor.may_begin(min(entry.stamp_ns for entry in queue))

    def _work_off(self, queue: list[Measurement]) -> None:
        self._queue = None
        self._resume(min(measurement.stamp_ns for measurement in queue))
        self._process_all(sorted(queue, key=lambda measurement: measurement.stamp_ns))

    def _resume(self, first_ns: int) -> None:
        """Go on from the last pose of an earlier process, if there is one that fits."""
        earlier = self._predecessor.poses
        if not earlier:
            return
        last = earlier[-1]
        if 0 < first_ns - last.stamp_ns <= _LONGEST_GAP_NS:
            self._reckoning.resume(last.stamp_ns, last.pose)
            self._corrected.remember(earlier)
            self._resumed += 1

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
    leave(main())
