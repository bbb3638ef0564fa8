# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node that makes motion-compensated scans of beams and settled odometry."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from time import monotonic, perf_counter

from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Beam, Scan
from msss_graphslam.messages import decoding, encoding, link_decoding, topics
from msss_graphslam.messages.link_decoding import SettledOdometry
from msss_graphslam.nodes.arrived import Gathering, take_arrived
from msss_graphslam.nodes.path_output import PathOutput
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.nodes.resumed_beams import ResumedBeams
from msss_graphslam.nodes.scan_output import ScanOutput
from msss_graphslam.ros.inputs import Input
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode, leave, run

__all__ = ["ScanGenerationNode", "main"]

_LOOK = 0.2
_PROGRESS_NS = 100_000_000
_LONG_AGO = -(2**62)
# Without anything new for so long [s], no odometry will come for the last beams.
_LONGEST_WAIT = 0.5
# A sonar that goes on all the time is always ahead of its odometry: after so long [s] the beams
# count that were there when the save was asked for.
_PATIENCE = 0.2


class ScanGenerationNode(SlamNode):
    """Beams and settled odometry in, scans out; the order of arrival does not matter.

    Started again, it goes on where the scans end that the front end has: with the beams that dead
    reckoning has kept meanwhile.
    """

    _asked: tuple[float, int] | None = None

    def __init__(self) -> None:
        super().__init__("scan_generation", ("sonar", "segmentation", "scanning", "sensors"))
        self._scans = ScanOutput(self)
        self._path = PathOutput(self)
        self._progress = self.offer(topics.SCAN_PROGRESS)
        self._end = self.offer(topics.SCANS_END)
        self._made = 0
        self._busy = 0.0
        self._start_anew()
        self.diagnostics.values["scans"] = lambda: self._made
        self.diagnostics.values["turns_waiting"] = lambda: self._generator.waiting
        self.diagnostics.values["time_per_scan_s"] = lambda: self._busy / max(self._made, 1)
        self._recalled: list[Input] = []
        self._gathering = Gathering()
        self._gathering.inputs = self._listen()

    def on_reset(self) -> None:
        """Forget beams, odometry and path; nothing is resumed."""
        self._start_anew()
        self._beams.join()
        self._path.reset()

    def on_save(self) -> tuple[bool, str]:
        """Make the last scans, once the odometry covers them or nothing more comes."""
        take_arrived(self._gathering.inputs)
        if self._beams.expects_more:
            return False, "waiting for beams of before the start"
        self._beams.join()
        self._asked = self._asked or (monotonic(), self._beam_ns)
        silent = min(self._quiet.lasting, monotonic() - self._reckoned_at)
        if not self._is_covered and silent < _LONGEST_WAIT:
            return False, "waiting for odometry"
        if not self._quiet.is_reached():
            return False, "input still comes in"
        self._asked = None
        scans = self._generator.finish()
        self._publish(scans)
        self._path.publish_new()
        self._end.publish(encoding.moment(make, self._newest_ns))
        return True, f"{len(scans)} last turns made"

    @property
    def _is_covered(self) -> bool:
        if self._asked is None or monotonic() - self._asked[0] <= _PATIENCE:
            return self._reckoned_ns >= self._beam_ns
        return self._reckoned_ns >= self._asked[1]

    def _listen(self) -> list[Input]:
        hear = {"single": True, "required": True}
        steady = {"ordered": False}
        decode = link_decoding
        self._recalled = [
            self.listen(topics.SCANS_TAKEN, decode.moment, self._begin_at, **steady),
            self.listen(topics.RECENT_BEAMS, decoding.beam, self._recall, **steady),
        ]
        self.every(_LOOK, self._look)
        return [
            self.listen(topics.SONAR_PING, decoding.beam, self._hear, **hear),
            self.listen(
                topics.SETTLED_ODOMETRY, decode.settled_odometry, self._take_odometry, **steady
            ),
        ]

    def _hear(self, beam: Beam) -> None:
        self._beams.hear(beam)
        self._gathering.take()

    def _recall(self, beam: Beam) -> None:
        self._beams.recall(beam)

    def _begin_at(self, stamp_ns: int) -> None:
        self._beams.begin_at(stamp_ns)

    def _look(self) -> None:
        """Begin when it is time; what is only of use for that is not listened to any longer."""
        self._beams.look()
        if self._beams.joined:
            while self._recalled:
                self.ignore(self._recalled.pop())

    def _start_anew(self) -> None:
        self._generator = ScanGenerator(
            self.parameters.configuration, self.diagnostics.refused, self._timed
        )
        self._beam_ns = self._reckoned_ns = self._newest_ns = 0
        self._told_ns = _LONG_AGO
        self._beams = ResumedBeams(
            self._take_beam,
            lambda beam: self._generator.warm_up(beam),
            lambda: self.count_publishers(topics.RECENT_BEAMS.name) > 0,
            lambda: self.count_publishers(topics.SCANS_TAKEN.name) > 0,
        )
        self._quiet = Quiet()
        self._reckoned_at = monotonic()
        self._asked = None

    def _take_beam(self, beam: Beam) -> None:
        self._beam_ns = beam.stamp_ns
        self._publish(self._generator.add_beam(beam))
        self._publish_part()
        if beam.stamp_ns - self._told_ns >= _PROGRESS_NS:
            self._told_ns = beam.stamp_ns
            self._progress.publish(encoding.moment(make, beam.stamp_ns))
        self._quiet.note()

    def _take_odometry(self, settled: SettledOdometry) -> None:
        if not settled.entries:
            return
        self._reckoned_ns = max(self._reckoned_ns, settled.entries[-1].stamp_ns)
        for entry in settled.entries:
            self._path.add(entry)
            self._publish(self._generator.add_odometry(entry))
            self._publish_part()
        self._reckoned_at = monotonic()

    def _publish_part(self) -> None:
        """Publish the newest part of the turn in progress when it is there."""
        part = self._generator.part()
        if part is not None:
            self._scans.publish_part(part)

    def _publish(self, scans: list[Scan]) -> None:
        for scan in scans:
            self._made += 1
            self._newest_ns = scan.stamp_ns
            self._scans.publish(scan)

    def _timed(self, _name: str) -> AbstractContextManager[object]:
        return self._add_time()

    @contextmanager
    def _add_time(self) -> Iterator[None]:
        start = perf_counter()
        yield
        self._busy += perf_counter() - start


def main() -> int:
    """Run the node."""
    return run(ScanGenerationNode)


if __name__ == "__main__":
    leave(main())
