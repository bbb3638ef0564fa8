# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams and odometry in, scans out: lines 3 to 8 of Algorithm 1."""

from collections import Counter
from contextlib import nullcontext
from dataclasses import dataclass, field

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import wrap_angle
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter, reject_ghosts
from msss_graphslam.core.scans.history import DeadReckoningHistory, Turn, TurnDetector
from msss_graphslam.core.scans.scan_generation import generate_scan
from msss_graphslam.core.types import Beam, Odometry, Reading, Scan, Stage

__all__ = ["BLOCK", "EARLY_PARTS", "PART", "TELLING", "ScanGenerator", "around"]

BLOCK = 32
"""So many beams are segmented at once, which takes half the time of one by one."""

PART = 2.0 * np.pi / 3.0
"""When the head has swept so much of a turn [rad], what it has heard can be had as a part.

A scan tells of its middle. With a part after a third of a turn, each of the two is at most 5/6 of
a turn old when the other comes; without it, a scan is 3/2 of a turn old when the next comes.
"""

EARLY_PARTS = (*(PART * np.arange(1, 9) / 8.0).tolist(), 2.0 * PART)
"""The same [rad] for the first turn that has another before it: nothing has shown the speed yet.

The pose is off by a whole turn's way at the assumed speed. The first wall that the head meets
again, some 15 deg on, shows that part of it which is across the wall.
"""

TELLING = 21
"""With fewer points a part shows nothing, as in the hull's shadow: another comes after two thirds.

Three lines of seven points are the least that say how a vehicle is displaced.
"""


@dataclass(slots=True)
class _Heard:
    """Where a beam of the turn in progress points; what is read in it follows a little later."""

    stamp_ns: int
    bearing: float
    reading: Reading = field(init=False)


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
        self._turns: TurnDetector[_Heard] = TurnDetector(configuration.scanning, refused)
        self._unread: list[tuple[Beam, _Heard]] = []
        self._waiting: list[Turn[Reading]] = []
        self._part: Turn[_Heard] | None = None
        self._parts_cut = self._turns_in_a_row = 0
        self._is_told = False
        self._before: list[Reading] = []
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
        heard = _Heard(beam.stamp_ns, beam.bearing)
        self._unread.append((beam, heard))
        turn = self._turns.add(heard)
        if turn is not None:
            self._waiting.append(self._read(turn))
            self._before = self._waiting[-1].readings
            self._part, self._parts_cut, self._is_told = None, 0, False
            self._turns_in_a_row = self._turns_in_a_row + 1 if turn.usable else 0
        elif len(self._unread) == BLOCK:
            self._segment()
        self._cut_part()
        return self._covered()

    def add_odometry(self, odometry: Odometry) -> list[Scan]:
        """Algorithm 1, line 6, for one odometry, in the order of their stamps."""
        self._history.append(odometry)
        return self._covered()

    def part(self) -> Scan | None:
        """Return the newest part of the turn in progress, once, when the odometry covers it.

        It begins with the turn. Its beams come again in later parts and in the whole turn's scan.
        """
        part = self._part
        if part is None or self._waiting or not self._history.covers(part.end_ns):
            return None
        self._part = None
        if self._is_told and not self._is_early:
            return None
        turn = self._read(part)
        with self._stage("scan_generation"):
            heard = around(turn.readings, self._before)
            heard = self._without_ghosts(heard)
            turn.readings = heard[: len(turn.readings)]
            scan = generate_scan(turn, self._history, self._configuration.sonar)
        self._is_told |= len(scan.points) >= TELLING
        return scan

    def finish(self) -> list[Scan]:
        """Return what is left at the end, also of a turn that the odometry does not cover."""
        # Deviation: the paper leaves the last part turn out; the trajectory ends in it.
        last = self._turns.finish()
        if last is not None:
            self._waiting.append(self._read(last))
        waiting, self._waiting = self._waiting, []
        if self._history.latest is None:
            return []
        return [self._generate(turn) for turn in waiting]

    @property
    def _is_early(self) -> bool:
        """Whether nothing has shown the vehicle's speed yet."""
        return self._turns_in_a_row == 1

    def _cut_part(self) -> None:
        """Note what has been heard of the turn in progress, if a part of it is due."""
        due = EARLY_PARTS if self._is_early else (PART, 2.0 * PART)
        while self._parts_cut < len(due) and self._turns.swept >= due[self._parts_cut]:
            self._part = self._turns.so_far()
            self._parts_cut += 1

    def _segment(self) -> None:
        """Read the beams that wait for it, and let go of them."""
        unread, self._unread = self._unread, []
        with self._stage("beam_segmentation"):
            readings = self._segmenter.segment_all([beam for beam, _ in unread])
        for (_, heard), reading in zip(unread, readings, strict=True):
            heard.reading = reading

    def _read(self, turn: Turn[_Heard]) -> Turn[Reading]:
        self._segment()
        readings = [heard.reading for heard in turn.readings]
        return Turn(readings, turn.end_ns, turn.swept, turn.complete, turn.usable)

    def _covered(self) -> list[Scan]:
        scans = []
        while self._waiting and self._history.covers(self._waiting[0].end_ns):
            scans.append(self._generate(self._waiting.pop(0)))
        return scans

    def _generate(self, turn: Turn[Reading]) -> Scan:
        scan = self._laid_out(turn)
        self._history.forget_before(turn.end_ns)  # lines 23 and 24
        return scan

    def _laid_out(self, turn: Turn[Reading]) -> Scan:
        with self._stage("scan_generation"):
            if turn.usable:
                turn.readings = self._without_ghosts(turn.readings)
            return generate_scan(turn, self._history, self._configuration.sonar)  # line 8

    def _without_ghosts(self, readings: list[Reading]) -> list[Reading]:
        config = self._configuration
        return reject_ghosts(readings, config.segmentation, config.sonar.beam_width)


def around(part: list[Reading], before: list[Reading]) -> list[Reading]:
    """Return a part's readings and behind them those of the turn before where it has not looked.

    What a ghost is of, the head may have seen elsewhere in the turn.
    """
    if not before or not part:
        return part
    # A sector's sweep begins where the one before it has ended.
    returns = abs(wrap_angle(before[-1].bearing - part[0].bearing))
    again = abs(wrap_angle(before[0].bearing - part[0].bearing))
    rest = before if again <= returns else before[::-1]
    return [*part, *rest[len(part) :]]
