# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node ``back_end``: keyframes in, optimised poses, maps and result files out."""

from collections import Counter, deque
from pathlib import Path
from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import KeyframeReport, Scan
from msss_graphslam.errors import UserError
from msss_graphslam.messages import encoding, link_decoding
from msss_graphslam.messages.link_decoding import StampedPose
from msss_graphslam.messages.topics import GRAPH_POSES, POSE, SCAN_BEAMS, TRIED, Topic
from msss_graphslam.nodes.arrived import Gathering, take_arrived
from msss_graphslam.nodes.beginning import Beginning
from msss_graphslam.nodes.closure_count import ClosureCount
from msss_graphslam.nodes.display import Display
from msss_graphslam.nodes.live_run import LiveRun
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.nodes.others_refusals import OthersRefusals
from msss_graphslam.nodes.saving_process import SavingProcess
from msss_graphslam.nodes.tenths import Tenths
from msss_graphslam.nodes.timing import Leisure, Throttle
from msss_graphslam.offline.estimators import recipe_named
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
_PATH_PERIOD = 2.0
_REFINING = 0.5


class BackEndNode(SlamNode):
    """Answers every keyframe with all poses as they stand, before it does anything slow."""

    def __init__(self) -> None:
        super().__init__("back_end", _GROUPS, _CHANGEABLE)
        self._declare()
        self._others = OthersRefusals(self.get_fully_qualified_name())
        self._closures = ClosureCount(self.diagnostics.values)
        self._held: deque[KeyframeReport] = deque()
        self._gathering = Gathering()
        self._leisure = Leisure()
        self._beginning = Beginning()
        self._begin()
        self._describe()
        self._poses = self.offer(GRAPH_POSES)
        self._display = Display(self)
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
        self._display.show_graph(self._mission)

    def on_save(self) -> tuple[bool, str]:
        """Refine a copy of the graph and write all files into the parameter ``output``."""
        take_arrived(self._subscribed)
        self._work_off()
        if not self._output:
            return True, "nothing written: the parameter output is empty"
        if self._beginning.expects_more(whole=self._mission.is_whole):
            return False, "looking for what was kept of before the start"
        try:
            self._write(Path(self._output))
        except UserError as error:
            return True, self._failed(str(error))
        except Exception as error:
            self.faults.note(error, "save")
            return True, self._failed(repr(error))
        return True, f"wrote {self._output}"

    def on_parameters(self, configuration: Configuration) -> None:
        """Draw the map anew."""
        del configuration
        self._map_due.ask()

    def _declare(self) -> None:
        declare = self.parameters.declare
        self._recipe = recipe_named(
            declare("estimator", "full", "name of the estimator, as of msss run")
        )
        self._output = declare("output", "", "where save writes its files; '' for none")
        self._recording = declare(
            "recording", "", "the bag that is replayed, for the report alone; '' for none"
        )
        self._map_period = declare(
            "map_period",
            10.0,
            "shortest time between two maps, by wall time [s]",
            minimum=0.1,
            maximum=3600.0,
        )

    def _begin(self) -> None:
        self._watch = Stopwatch()
        self._mission = Mission(
            self.parameters.configuration,
            self._recipe,
            self.diagnostics.refused,
            self._watch.stage,
        )
        self._show_nothing_more()

    def _show_nothing_more(self) -> None:
        """Leave the pictures as they are until something new comes."""
        self._graph_due = Throttle(0.0)
        self._path_due = Throttle(_PATH_PERIOD)
        self._map_due = Throttle(self._map_period)

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
                self._leisure.end()
                self._ask_for_all()
        self._graph_due.run(self._show_graph)

    def _answer(self) -> None:
        known = self._mission.answer()
        message = encoding.graph_poses(make, known)
        self._poses.publish(message, known.poses, known.covariances)

    def _ask_for_all(self) -> None:
        for due in (self._graph_due, self._path_due, self._map_due):
            due.ask()

    def _look_after(self) -> None:
        if not self.paused:
            self._work_off()
        if not self._leisure.lasts:
            return
        self._path_due.run(lambda: self._display.show_path(self._mission.trajectory()))
        self._map_due.run(self._show_maps)

    def _show_graph(self) -> None:
        self._display.show_graph(self._mission)

    def _show_maps(self) -> None:
        self._display.show_maps(self._mission, self.parameters.configuration)

    def _give_map(self, _request: Any, response: Any) -> Any:
        try:
            response.map = self._display.map_message(self._mission, self.parameters.configuration)
        except Exception as error:
            self.faults.note(error, "get_map")
        return response

    def _write(self, output: Path) -> None:
        self.diagnostics.clear()
        refused: Counter[str] = self.diagnostics.refused + self._others.total
        tell = Tenths(self.log)
        # What writes makes ready while the graph is refined.
        with SavingProcess(self._recording, self._complain) as saving:
            estimate = self._mission.logbook().finish(
                lambda share: tell(_REFINING * share, "refinement")
            )
            run_of = LiveRun(
                self.parameters.configuration,
                self._recipe.name,
                refused,
                self._mission.beams,
                self._watch.cost,
            )
            maps = saving.save(
                estimate,
                run_of,
                output,
                lambda share, what: tell(_REFINING + (1.0 - _REFINING) * share, what),
            )
        self._display.show_path(estimate.trajectory)
        self._display.show_map(self._mission.newest_ns, *maps)
        self._show_nothing_more()

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
