# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node that makes motion-compensated scans of beams and settled odometry."""

import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from time import perf_counter

import numpy as np

from msss_graphslam.core.scan_generator import ScanGenerator
from msss_graphslam.core.types import Beam, Scan
from msss_graphslam.messages import decoding, encoding, frames, link_decoding, topics
from msss_graphslam.messages.link_decoding import SettledOdometry
from msss_graphslam.nodes.quiet import Quiet
from msss_graphslam.nodes.reckoned_path import ReckonedPath
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode, run
from msss_graphslam.ros.qos import DEEP

__all__ = ["ScanGenerationNode", "main"]

_SCAN_FRAME = "scan"
_PATH_PERIOD = 1.0
# Without anything new for so long [s], no odometry will come for the last beams.
_LONGEST_WAIT = 2.0


class ScanGenerationNode(SlamNode):
    """Beams and settled odometry in, scans out; the order of arrival does not matter."""

    def __init__(self) -> None:
        super().__init__("scan_generation", ("sonar", "segmentation", "scanning", "sensors"))
        self._scan_beams = self.offer(topics.SCAN_BEAMS, DEEP)
        self._scan_points = self.offer(topics.SCAN)
        self._path_output = self.offer(topics.RECKONED_PATH)
        self._transforms = self.offer(topics.TRANSFORMS)
        self._made = 0
        self._busy = 0.0
        self._start_anew()
        self.diagnostics.values["scans"] = lambda: self._made
        self.diagnostics.values["turns_waiting"] = lambda: self._generator.waiting
        self.diagnostics.values["time_per_scan_s"] = lambda: self._busy / max(self._made, 1)
        self.listen(topics.SONAR_PING, decoding.beam, self._take_beam, single=True, required=True)
        self.listen(
            topics.SETTLED_ODOMETRY,
            link_decoding.settled_odometry,
            self._take_odometry,
            ordered=False,
        )
        self.every(_PATH_PERIOD, self._publish_path)

    def on_reset(self) -> None:
        """Forget beams, odometry and path."""
        self._start_anew()

    def on_save(self) -> tuple[bool, str]:
        """Make the last scans, once the odometry covers them or nothing more comes."""
        if not self._is_covered and self._quiet.lasting < _LONGEST_WAIT:
            return False, "waiting for odometry"
        if not self._quiet.is_reached():
            return False, "input still comes in"
        scans = self._generator.finish()
        self._publish(scans)
        self._publish_path()
        return True, f"{len(scans)} last turns made"

    @property
    def _is_covered(self) -> bool:
        return self._reckoned_ns >= self._beam_ns

    def _start_anew(self) -> None:
        self._generator = ScanGenerator(
            self.parameters.configuration, self.diagnostics.refused, self._timed
        )
        self._path = ReckonedPath()
        self._path_is_new = False
        self._beam_ns = self._reckoned_ns = 0
        self._quiet = Quiet()

    def _take_beam(self, beam: Beam) -> None:
        self._beam_ns = beam.stamp_ns
        self._publish(self._generator.add_beam(beam))
        self._quiet.note()

    def _take_odometry(self, settled: SettledOdometry) -> None:
        if not settled.entries:
            return
        self._path_is_new = True
        self._reckoned_ns = max(self._reckoned_ns, settled.entries[-1].stamp_ns)
        for entry in settled.entries:
            self._path.add(entry)
            self._publish(self._generator.add_odometry(entry))
        self._quiet.note()

    def _publish(self, scans: list[Scan]) -> None:
        for scan in scans:
            self._made += 1
            message = encoding.scan_beams(make, scan)
            numbers = (scan.reckoned, scan.body_points, scan.body_covariances, scan.points)
            if self._scan_beams.publish(message, *numbers, scan.covariances) and scan.usable:
                self._show(scan)

    def _show(self, scan: Scan) -> None:
        """Publish the points in {I}, and where {I} lies."""
        frame = self.frame(_SCAN_FRAME)
        if self._transforms.available:
            x, y, z, _, _, yaw = scan.reckoned[0].tolist()
            placement = np.array([x, y, z, 0.0, 0.0, yaw])
            odom = self.frame(frames.ODOM)
            transform = encoding.transform(make, scan.stamp_ns, placement, odom, frame)
            self._transforms.publish(encoding.tf_message(make, [transform]))
        self._scan_points.publish(encoding.scan_cloud(make, scan, frame))

    def _publish_path(self) -> None:
        if not self._path_is_new:
            return
        self._path_is_new = False
        trajectory = self._path.trajectory
        message = encoding.path(make, trajectory, self.frame(frames.ODOM))
        self._path_output.publish(message, trajectory.poses)

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
    sys.exit(main())
