# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The histories RH and DRH of Algorithm 1, and when a turn of the head is whole."""

from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from msss_graphslam.config.groups import Scanning
from msss_graphslam.core.compounding import wrap, wrap_angle
from msss_graphslam.core.types import Array, Odometry, Stamps

__all__ = ["DeadReckoningHistory", "Turn", "TurnDetector"]

FULL_TURN = 2.0 * np.pi
JUMP = 0.5
"""A bearing that changes by more than this between two beams [rad] is no step of a head."""


class DeadReckoningHistory:
    """DRH: the odometry so far, looked up by stamp."""

    def __init__(self) -> None:
        self._entries: list[Odometry] = []
        self._stamps: list[int] = []

    def append(self, odometry: Odometry) -> None:
        """Add the newest odometry; one that is not newer is left out."""
        if not self._stamps or odometry.stamp_ns > self._stamps[-1]:
            self._entries.append(odometry)
            self._stamps.append(odometry.stamp_ns)

    @property
    def latest(self) -> Odometry | None:
        """The newest odometry."""
        return self._entries[-1] if self._entries else None

    def covers(self, stamp_ns: int) -> bool:
        """Whether a pose at ``stamp_ns`` can be had without guessing ahead."""
        return bool(self._stamps) and self._stamps[-1] >= stamp_ns

    def poses_at(self, stamps_ns: Stamps) -> Array:
        """FindCorrespondingDR: the poses (n, 6) at ``stamps_ns`` (n,), angles interpolated.

        A stamp before the first odometry takes the first pose, one after the last the last.
        """
        times = np.array(self._stamps, dtype=np.int64)
        after = np.clip(np.searchsorted(times, stamps_ns), 1, max(len(times) - 1, 1))
        before = after - 1
        after = np.minimum(after, len(times) - 1)
        poses = np.array([entry.pose for entry in self._entries])
        span = np.maximum(times[after] - times[before], 1)
        share = np.clip((stamps_ns - times[before]) / span, 0.0, 1.0)[:, None]
        step = poses[after] - poses[before]
        step[:, 3:] = wrap(step[:, 3:])
        result = poses[before] + share * step
        result[:, 3:] = wrap(result[:, 3:])
        return np.asarray(result)

    def at(self, stamp_ns: int) -> Odometry:
        """Return the last odometry not after ``stamp_ns`` (the first if there is none)."""
        return self._entries[max(bisect_right(self._stamps, stamp_ns) - 1, 0)]

    def since(self, stamp_ns: int) -> list[Odometry]:
        """Return the odometry after ``stamp_ns``."""
        return self._entries[bisect_right(self._stamps, stamp_ns) :]

    def __len__(self) -> int:
        return len(self._entries)

    def keep_last(self, count: int) -> None:
        """Drop all but the newest ``count``."""
        del self._entries[:-count]
        del self._stamps[:-count]

    def forget_before(self, stamp_ns: int) -> None:
        """Drop what no stamp from ``stamp_ns`` on needs."""
        keep = max(bisect_right(self._stamps, stamp_ns) - 1, 0)
        del self._entries[:keep]
        del self._stamps[:keep]


class Bearing(Protocol):
    """What tells where the head pointed when, like a beam or its reading."""

    @property
    def stamp_ns(self) -> int:
        """When."""

    @property
    def bearing(self) -> float:
        """Where to [rad]."""


Item = TypeVar("Item", bound=Bearing)


@dataclass(slots=True)
class Turn(Generic[Item]):
    """RH: the readings of one turn or sweep.

    ``end_ns`` is the next one's first stamp, ``swept`` the angle [rad] between the first beam and
    the last, ``complete`` whether the head finished it, ``usable`` whether it makes a scan.
    """

    readings: list[Item]
    end_ns: int
    swept: float
    complete: bool
    usable: bool = True


class TurnDetector(Generic[Item]):
    """ScanDetermined: cuts the stream of readings into turns.

    A full turn of a continuous head, either way round, or one sweep of a sector.
    """

    def __init__(self, config: Scanning, refused: Counter[str]) -> None:
        self._gap_ns = round(config.gap * 1e9)
        self._part_turn = config.part_turn
        self._refused = refused
        self._readings: list[Item] = []
        self._swept = 0.0
        self._direction = 0.0
        self._least_step = FULL_TURN  # a lost beam makes a step longer, never shorter

    @property
    def swept(self) -> float:
        """How far the head has turned in the turn in progress [rad]."""
        return self._swept

    def so_far(self) -> Turn[Item]:
        """Return the turn in progress, which must have begun; it ends with its last reading."""
        readings = list(self._readings)
        return Turn(readings, readings[-1].stamp_ns, self._swept, complete=False)

    def add(self, reading: Item) -> Turn[Item] | None:
        """Take in one reading; return the turn that it ends, of which it is not a part.

        A turn that is dropped is returned as not usable.
        """
        if not self._readings:
            self._start(reading)
            return None
        last = self._readings[-1]
        if reading.stamp_ns <= last.stamp_ns:
            self._refused["beam_not_newer"] += 1
            return None
        step = wrap_angle(reading.bearing - last.bearing)
        if reading.stamp_ns - last.stamp_ns > self._gap_ns:
            return self._drop("turn_dropped_for_a_gap", reading)
        if abs(step) > JUMP:
            return self._drop("turn_dropped_for_a_bearing_jump", reading)
        reversed_sweep = step * self._direction < 0.0
        self._least_step = min(self._least_step, abs(step) or FULL_TURN)
        whole = FULL_TURN - min(0.5 * self._least_step, JUMP)
        if reversed_sweep or self._swept + abs(step) > whole:
            return self._finish(reading)
        self._readings.append(reading)
        self._swept += abs(step)
        self._direction = step or self._direction
        return None

    def finish(self) -> Turn[Item] | None:
        """Return the turn in progress at the end of the recording; usable if it is long enough."""
        readings, self._readings = self._readings, []
        if not readings:
            return None
        enough = self._swept >= self._part_turn
        return Turn(readings, readings[-1].stamp_ns, self._swept, complete=False, usable=enough)

    def _start(self, reading: Item) -> None:
        self._readings = [reading]
        self._swept, self._direction, self._least_step = 0.0, 0.0, FULL_TURN

    def _drop(self, reason: str, reading: Item) -> Turn[Item]:
        self._refused[reason] += 1
        self._refused["beams_in_dropped_turns"] += len(self._readings)
        last_ns = self._readings[-1].stamp_ns
        turn = Turn(self._readings, last_ns, self._swept, complete=False, usable=False)
        self._start(reading)
        return turn

    def _finish(self, reading: Item) -> Turn[Item]:
        turn = Turn(self._readings, reading.stamp_ns, self._swept, complete=True)
        self._start(reading)
        return turn
