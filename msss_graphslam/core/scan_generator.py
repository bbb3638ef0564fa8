# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams and odometry in, scans out: lines 3 to 8 of Algorithm 1."""

from collections import Counter
from contextlib import nullcontext

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.beam_segmentation import BeamSegmenter, reject_ghosts
from msss_graphslam.core.history import DeadReckoningHistory, Turn, TurnDetector
from msss_graphslam.core.scan_generation import generate_scan
from msss_graphslam.core.types import Beam, Odometry, Scan, Stage

__all__ = ["ScanGenerator"]


class ScanGenerator:
    """Every beam leaves in exactly one scan, as soon as the odometry covers the turn.

    Beams and odometry may come in any order against each other; the scans do not depend on it.
    What is refused is counted in ``refused``.
    """

    def __init__(
        self,
        configuration: Configuration,
        refused: Counter[str],
        stage: Stage = lambda _: nullcontext(),
    ) -> None:
        self._configuration = configuration
        self._stage = stage
        self._segmenter = BeamSegmenter(configuration.sonar, configuration.segmentation)
        self._turns = TurnDetector(configuration.scanning, refused)
        self._waiting: list[Turn] = []
        self._history = DeadReckoningHistory()

    @property
    def waiting(self) -> int:
        """How many turns wait for their odometry."""
        return len(self._waiting)

    def warm_up(self, beam: Beam) -> None:
        """Learn the background from a beam that stands in an earlier process' scans."""
        self._segmenter.segment(beam)

    def add_beam(self, beam: Beam) -> list[Scan]:
        """Algorithm 1, lines 4 and 7, for one beam, in the order of their stamps."""
        with self._stage("beam_segmentation"):
            reading = self._segmenter.segment(beam)
        turn = self._turns.add(reading)
        if turn is not None:
            self._waiting.append(turn)
        return self._covered()

    def add_odometry(self, odometry: Odometry) -> list[Scan]:
        """Algorithm 1, line 6, for one odometry, in the order of their stamps."""
        self._history.append(odometry)
        return self._covered()

    def finish(self) -> list[Scan]:
        """Return what is left at the end, also of a turn that the odometry does not cover."""
        # Deviation: the paper leaves the last part turn out; the trajectory ends in it.
        last = self._turns.finish()
        waiting, self._waiting = self._waiting + ([last] if last else []), []
        if self._history.latest is None:
            return []
        return [self._generate(turn) for turn in waiting]

    def _covered(self) -> list[Scan]:
        scans = []
        while self._waiting and self._history.covers(self._waiting[0].end_ns):
            scans.append(self._generate(self._waiting.pop(0)))
        return scans

    def _generate(self, turn: Turn) -> Scan:
        with self._stage("scan_generation"):
            if turn.usable:
                turn.readings = reject_ghosts(turn.readings, self._configuration.segmentation)
            scan = generate_scan(turn, self._history, self._configuration.sonar)  # line 8
        self._history.forget_before(turn.end_ns)  # lines 23 and 24
        return scan
