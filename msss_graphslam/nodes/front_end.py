# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node ``front_end``: scans in, keyframes and their constraints out."""

from statistics import median
from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import GraphPoses, KeyframeReport, MapCorrection, Scan
from msss_graphslam.messages import encoding, link_decoding
from msss_graphslam.messages.topics import (
    CONSTRAINTS,
    CORRECTION,
    GRAPH_POSES,
    SCAN_BEAMS,
    SCAN_PART,
    SCANS_END,
    SCANS_TAKEN,
    TRIED,
)
from msss_graphslam.nodes.closure_count import ClosureCount
from msss_graphslam.nodes.keyframing import Keyframing
from msss_graphslam.nodes.last_scan import LastScan
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.offline.estimators import recipe_named
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode, leave, run
from msss_graphslam.ros.qos import DEEP

__all__ = ["FrontEndNode", "main"]

_GROUPS = ("dead_reckoning", "association", "matching", "back_end", "sonar", "mapping", "scanning")
_CHANGEABLE = ("association",)
_LOOK = 0.2


class FrontEndNode(SlamNode):
    """Publishes what it has tried for each keyframe, and where the vehicle is in the map."""

    def __init__(self) -> None:
        super().__init__("front_end", _GROUPS, _CHANGEABLE)
        self._recipe = recipe_named(
            self.parameters.declare("estimator", "full", "name of the estimator, as of msss run")
        )
        self._timeout = self.parameters.declare(
            "answer_timeout",
            60.0,
            "how long a keyframe waits for the back end's answer, by wall time [s]",
            minimum=0.1,
            maximum=3600.0,
        )
        self._tried = self.offer(TRIED, DEEP)
        self._constraints = self.offer(CONSTRAINTS, DEEP)
        self._correction = self.offer(CORRECTION)
        self._taken = self.offer(SCANS_TAKEN)
        self._quiet = Quiet.between_nodes()
        self._last_scan = LastScan()
        self._closures = ClosureCount(self.diagnostics.values)
        self._keyframing = self._begin()
        self._describe()
        self._tell_taken(0)
        self.listen(SCANS_END, link_decoding.moment, self._take_end, ordered=False, pausable=False)
        self.listen(
            GRAPH_POSES,
            link_decoding.graph_poses,
            self._take_answer,
            ordered=False,
            pausable=False,
        )
        self.listen(SCAN_BEAMS, link_decoding.scan_beams, self._take_scan, ordered=False)
        self.listen(SCAN_PART, link_decoding.scan_beams, self._take_part, ordered=False)
        self.every(_LOOK, self._look_after)

    def on_reset(self) -> None:
        """Begin a new graph."""
        self._keyframing = self._begin()
        self._closures.clear()
        self._tell_taken(0)
        self._last_scan = LastScan()

    def on_save(self) -> tuple[bool, str]:
        """Say whether every scan is worked off and answered."""
        waiting = self._keyframing.waiting
        if waiting:
            return False, f"{waiting} scans waiting"
        is_quiet = self._quiet.is_reached()
        if not (self._last_scan.take() or is_quiet):
            return False, "looking whether more is on its way"
        self.diagnostics.publish()
        return True, f"{self._keyframing.keyframes} keyframes"

    def on_parameters(self, configuration: Configuration) -> None:
        """Search loop closures by the new parameters from the next scan on."""
        self._keyframing.configure(configuration)

    def _begin(self) -> Keyframing:
        return Keyframing(
            self.parameters.configuration,
            self._recipe,
            self.diagnostics.refused,
            self._send,
            self._place,
        )

    def _describe(self) -> None:
        values = self.diagnostics.values
        values["keyframes"] = lambda: self._keyframing.keyframes
        values["queue"] = lambda: self._keyframing.waiting
        values["waiting_for_back_end_s"] = lambda: self._keyframing.waited
        values["scan_s/median"] = lambda: median(self._keyframing.seconds or [0.0])
        values["scan_s/max"] = lambda: max(self._keyframing.seconds, default=0.0)

    def _take_scan(self, scan: Scan) -> None:
        self._quiet.note()
        self._last_scan.came(scan.stamp_ns)
        self._keyframing.add_scan(scan)
        # Of a turn that was cut off, the last beam is the end.
        self._tell_taken(max(self._taken_ns, scan.end_stamp_ns + (not scan.complete)))

    def _take_part(self, part: Scan) -> None:
        self._keyframing.add_part(part)

    def _take_answer(self, known: GraphPoses) -> None:
        self._quiet.note()
        self._keyframing.add_answer(known)
        if len(known.stamps_ns):
            self._tell_taken(max(self._taken_ns, int(known.stamps_ns[-1])))

    def _take_end(self, stamp_ns: int) -> None:
        self._last_scan.told(stamp_ns)

    def _tell_taken(self, stamp_ns: int) -> None:
        """Tell from where on beams are missing, for a scan generation that is started again."""
        self._taken_ns = stamp_ns
        self._taken.publish(encoding.moment(make, stamp_ns))

    def _look_after(self) -> None:
        if self._keyframing.waited > self._timeout:
            self._keyframing.give_up()

    def _send(self, report: KeyframeReport) -> None:
        self._tried.publish(encoding.tried(make, report), report.pose, report.odometry)
        self._closures.add(report.constraints)
        for entry in report.constraints:
            if entry.accepted:
                message: Any = encoding.constraint(make, report.stamp_ns, entry)
                self._constraints.publish(message, entry.relative_pose, entry.covariance)

    def _place(self, correction: MapCorrection) -> None:
        message = encoding.correction(make, correction)
        message.header.frame_id = self.frame(message.header.frame_id)
        message.child_frame_id = self.frame(message.child_frame_id)
        self._correction.publish(message, correction.pose, correction.covariance)


def main() -> int:
    """Run the node until a signal comes; return its exit code."""
    return run(FrontEndNode)


if __name__ == "__main__":
    leave(main())
