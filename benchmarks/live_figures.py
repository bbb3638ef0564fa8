# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From what a probe has noted to latencies, rates and losses. No ROS."""

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array

__all__ = [
    "Percentiles",
    "answer_times",
    "complete_at",
    "lost_messages",
    "percentiles",
    "turn_times",
]

_LOST = "lost/"


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Of ``count`` times [s]: the ``median``, the ``p99`` (of all below 1 %, or the largest)."""

    count: int
    median: float
    p99: float


def percentiles(times: Iterable[float]) -> Percentiles:
    """Return the percentiles; ValueError where there is nothing to take them of."""
    values = np.fromiter(times, dtype=float)
    if not len(values):
        raise ValueError("nothing was measured")
    p99 = np.percentile(values, 99.0, method="higher")
    return Percentiles(len(values), float(np.median(values)), float(p99))


def answer_times(
    asked: Mapping[int, int], stamps: Sequence[int], received: Sequence[int]
) -> Array:
    """Return the seconds from each input to the first answer that is not older than it.

    ``asked`` has the time [ns] by the input's stamp [ns]; ``stamps`` increase, ``received`` are
    the answers' times. Inputs after the last answer are left out.
    """
    times = []
    for stamp, at in asked.items():
        row = bisect_left(stamps, stamp)
        if row < len(stamps):
            times.append(1e-9 * (received[row] - at))
    return np.array(times, dtype=float)


def complete_at(asked: Mapping[int, int], others: Mapping[int, int]) -> dict[int, int]:
    """Return when all that answers an input was sent: it, and the next of the ``others``.

    Both have times of sending [ns] by stamp [ns]. An input after the last other is left out.
    """
    stamps = sorted(others)
    complete = {}
    for stamp, at in asked.items():
        row = bisect_left(stamps, stamp)
        if row < len(stamps):
            complete[stamp] = max(at, others[stamps[row]])
    return complete


def turn_times(
    last_beams: Mapping[int, int],
    asked: Mapping[int, int],
    stamps: Sequence[int],
    received: Sequence[int],
) -> Array:
    """Return the seconds from a turn's last beam to the first graph that holds the turn.

    ``last_beams`` has the last beam's stamp by the turn's stamp; ``asked`` when a beam was sent;
    ``stamps`` are those of the graphs' newest keyframes.
    """
    sent = {turn: asked[beam] for turn, beam in last_beams.items() if beam in asked}
    return answer_times(sent, stamps, received)


def lost_messages(rows: Mapping[str, Mapping[str, str]]) -> int:
    """Return how many messages the nodes say they have lost, by their last diagnostics."""
    values = [
        value for row in rows.values() for key, value in row.items() if key.startswith(_LOST)
    ]
    return sum(int(value) for value in values)
