# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node ``back_end``: keyframes in, optimised poses, maps and result files out."""

from collections import deque
from pathlib import Path
from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import KeyframeReport, Scan
from msss_graphslam.errors import UserError
from msss_graphslam.messages import encoding, link_decoding
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.messages.topics import GRAPH_POSES, POSE, SCAN_BEAMS, TRIED, Topic
from msss_graphslam.nodes.arrived import Gathering, take_arrived
from msss_graphslam.nodes.back_end_settings import BackEndSettings
from msss_graphslam.nodes.beginning import Beginning
from msss_graphslam.nodes.closure_count import ClosureCount
from msss_graphslam.nodes.live_run import LiveRun
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.nodes.mission_files import MissionFiles
from msss_graphslam.nodes.others_refusals import OthersRefusals
from msss_graphslam.nodes.showing import Showing
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.ros.inputs import Input
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.node import SlamNode, leave, run

__all__ = ["BackEndNode", "main"]

_GROUPS = (
    "sonar",
    "sensors",
    "segmentation",
    "dead_reckoning",
    "scanning",
    "association",
    "matching",
    "back_end",
    "mapping",
)
_CHANGEABLE = ("mapping",)
_DIAGNOSTICS = Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
_LOOK = 0.2


class BackEndNode(SlamNode):
    """Answers every keyframe with all poses as they stand, before it does anything slow."""

    def __init__(self) -> None:
        super().__init__("back_end", _GROUPS, _CHANGEABLE)
        self._settings = BackEndSettings.declared(self.parameters)
        self._others = OthersRefusals(self.get_fully_qualified_name())
        self._closures = ClosureCount(self.diagnostics.values)
        self._held: deque[KeyframeReport] = deque()
        self._gathering = Gathering()
        self._beginning = Beginning()
        self._begin()
        self._describe()
        self._poses = self.offer(GRAPH_POSES)
        self._showing = Showing(self, self._settings.map_period)
        self._subscribed = self._gathering.inputs = self._listen()
        self.create_service(message_class("nav_msgs/srv/GetMap"), "get_map", self._give_map)
        self.every(_LOOK, self._look_after)

    def on_reset(self) -> None:
        """Begin a new graph, and say so."""
        self._begin()
        self._closures.clear()
        self._others.clear()
        self._held.clear()
        self._answer()
        self._showing.clear(self._mission)

    def on_save(self) -> tuple[bool, str]:
        """Smooth a copy of the mission and write all files into the parameter ``output``."""
        take_arrived(self._subscribed)
        self._work_off()
        if not self._settings.output:
            return True, "nothing written: the parameter output is empty"
        if self._beginning.expects_more(whole=self._mission.is_whole):
            return False, "looking for what was kept of before the start"
        try:
            self._write()
        except UserError as error:
            return True, self._failed(str(error))
        except Exception as error:
            self.faults.note(error, "save")
            return True, self._failed(repr(error))
        return True, f"wrote {self._settings.output}"

    def on_parameters(self, configuration: Configuration) -> None:
        """Draw the map anew."""
        del configuration
        self._showing.ask_for_map()

    def _begin(self) -> None:
        self._watch = Stopwatch()
        self._mission = Mission(
            self.parameters.configuration,
            self._settings.recipe,
            self.diagnostics.refused,
            self._watch.stage,
        )

    def _describe(self) -> None:
        values = self.diagnostics.values
        values["keyframes"] = lambda: len(self._mission.poses)
        values["scans"] = lambda: self._mission.scans
        values["last_jump"] = lambda: self._mission.last_jump
        values["largest_jump"] = lambda: self._mission.largest_jump
        values["loop_closures/withdrawn"] = lambda: self._mission.withdrawals
        values["loop_closures"] = lambda: self._closures.accepted

    def _listen(self) -> list[Input]:
        steady = {"ordered": False, "pausable": False}
        decode = link_decoding
        return [
            self.listen(SCAN_BEAMS, decode.scan_beams, self._take_scan, **steady),
            self.listen(POSE, decode.stamped_pose, self._take_pose),
            self.listen(_DIAGNOSTICS, lambda message: message, self._others.hear, **steady),
            self.listen(TRIED, decode.tried, self._take_report, **steady),
        ]

    def _take_scan(self, scan: Scan) -> None:
        self._beginning.note()
        self._mission.add_scan(scan)

    def _take_pose(self, published: StampedPose) -> None:
        self._mission.add_online(published)
        self._gathering.take()

    def _take_report(self, report: KeyframeReport) -> None:
        self._beginning.note()
        self._held.append(report)
        if not self.paused:
            self._work_off()

    def _work_off(self) -> None:
        while self._held:
            report = self._held.popleft()
            try:
                is_new = self._mission.take(report)
            finally:
                self._answer()
            if is_new:
                self._closures.add(report.constraints)
                self._showing.ask_for_all()
        self._showing.graph(self._mission)

    def _answer(self) -> None:
        known = self._mission.answer()
        message = encoding.graph_poses(make, known)
        self._poses.publish(message, known.poses, known.covariances)

    def _look_after(self) -> None:
        if not self.paused:
            self._work_off()
        self._showing.at_leisure(self._mission)

    def _give_map(self, _request: Any, response: Any) -> Any:
        try:
            response.map = self._showing.map_message(self._mission)
        except Exception as error:
            self.faults.note(error, "get_map")
        return response

    def _write(self) -> None:
        self.diagnostics.clear()
        output, recording = Path(self._settings.output), self._settings.recording
        files = MissionFiles(output, recording, self.log, self._complain)
        self._showing.result(self._mission, *files.write(self._mission, self._run_so_far))

    def _run_so_far(self) -> LiveRun:
        return LiveRun(
            self.parameters.configuration,
            self._settings.recipe.name,
            self.diagnostics.refused + self._others.total,
            self._mission.beams,
            self._watch.cost,
        )

    def _complain(self, text: str) -> None:
        self.get_logger().error(text)
        self.diagnostics.warn(text)

    def _failed(self, reason: str) -> str:
        self.diagnostics.error(f"save: {reason}")
        self.get_logger().error(f"save: {reason}")
        return f"failed: {reason}"


def main() -> int:
    """Run the node until a signal comes; return its exit code."""
    return run(BackEndNode)


if __name__ == "__main__":
    leave(main())
