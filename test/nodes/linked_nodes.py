# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes' logic in one process, linked by messages that are encoded and decoded again."""

from collections import Counter, deque
from collections.abc import Iterable
from typing import Any

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.reckoning.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Beam, KeyframeReport, MapCorrection, Measurement, Scan
from msss_graphslam.messages import encoding, link_decoding
from msss_graphslam.nodes.keyframing import Keyframing
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.recordings.typestore import make

__all__ = ["LinkedNodes", "parts_of", "scans_of"]


class LinkedNodes:
    """Front end and back end with what is on its way between them."""

    def __init__(self, estimator: str = "full", *, answers: bool = True) -> None:
        self.refused: Counter[str] = Counter()
        self.estimator = estimator
        self.answers = answers
        self.reports: list[Any] = []
        self.scans: list[Any] = []
        self.corrections: list[MapCorrection] = []
        self._on_their_way: deque[Any] = deque()
        self.now = 0.0
        self.start_front_end()
        self.start_back_end()

    def start_front_end(self) -> None:
        recipe = ESTIMATORS[self.estimator]
        self.front = Keyframing(
            Configuration(),
            recipe,
            self.refused,
            self._send,
            self.corrections.append,
            lambda: self.now,
        )

    def start_back_end(self) -> None:
        self.back = Mission(Configuration(), ESTIMATORS[self.estimator], self.refused)

    def add_scan(self, scan: Scan) -> None:
        message = encoding.scan_beams(make, scan)
        self.scans.append(message)
        self.back.add_scan(link_decoding.scan_beams(message))
        self.front.add_scan(link_decoding.scan_beams(message))
        self.deliver()

    def replay_reports(self) -> None:
        """What a back end gets that was started anew."""
        self._on_their_way.extend(list(self.reports))
        self.deliver()

    def replay_scans(self) -> None:
        """What a front end gets that was started anew."""
        for message in self.scans:
            self.front.add_scan(link_decoding.scan_beams(message))
            self.deliver()

    def deliver(self) -> None:
        while self._on_their_way and self.answers:
            self.back.take(link_decoding.tried(self._on_their_way.popleft()))
            self.front.add_answer(self.answer())

    def answer(self) -> Any:
        return link_decoding.graph_poses(encoding.graph_poses(make, self.back.answer()))

    def _send(self, report: KeyframeReport) -> None:
        message = encoding.tried(make, report)
        self.reports.append(message)
        self._on_their_way.append(message)


def scans_of(measurements: Iterable[Measurement]) -> list[Scan]:
    """All scans of the measurements, as the nodes before make them."""
    return _generated(measurements)[0]


def parts_of(measurements: Iterable[Measurement]) -> list[Scan]:
    """The parts of their turns, as the nodes before make them."""
    return _generated(measurements)[1]


def _generated(measurements: Iterable[Measurement]) -> tuple[list[Scan], list[Scan]]:
    refused: Counter[str] = Counter()
    reckoning = PromptDeadReckoning(Configuration(), refused)
    generator = ScanGenerator(Configuration(), refused)
    scans: list[Scan] = []
    parts: list[Scan | None] = []
    for measurement in measurements:
        for entry in reckoning.process(measurement).settled:
            scans += generator.add_odometry(entry)
            parts.append(generator.part())
        if isinstance(measurement, Beam):
            scans += generator.add_beam(measurement)
    for entry in reckoning.finish():
        scans += generator.add_odometry(entry)
    return scans + generator.finish(), [part for part in parts if part is not None]
