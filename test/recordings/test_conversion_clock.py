# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a recording computer: pauses, steps, single wrong times."""

from collections import Counter

import pytest

from msss_graphslam.messages import Refusal
from msss_graphslam.recordings.conversion.steady_clock import SteadyClock

SECOND = 1_000_000_000


def times(recorded: list[float]) -> tuple[list[float | None], Counter[str]]:
    """The clock's times [s]; None for what it refuses."""
    refusals: Counter[str] = Counter()
    clock = SteadyClock(refusals)
    found: list[float | None] = []
    for moment in recorded:
        try:
            found.append(clock.time(round(moment * SECOND)) / SECOND)
        except Refusal as refusal:
            refusals[refusal.reason] += 1
            found.append(None)
    return found, refusals


@pytest.mark.parametrize(
    ("recorded", "expected", "refused"),
    [
        ([10, 11, 12], [10, 11, 12], {}),
        ([10, 10, 10.5], [10, 10, 10.5], {}),
        ([10, 10.5, 10.4, 10.6], [10, 10.5, 10.4, 10.6], {}),
        ([10, 10.5, 10.39, 10.89], [10, 10.5, 11, 11.5], {"clock_set_back": 1}),
        ([10, 70, 71], [10, 70, 71], {}),
        ([10, 70.1, 71], [10, None, 71], {"stamp_jumps_ahead": 1}),
        ([10, 1e6, 11], [10, None, 11], {"stamp_jumps_ahead": 1}),
        ([10, 1e6, 2e6, 11], [10, None, None, 11], {"stamp_jumps_ahead": 2}),
        ([100, 100.5, 1, 101.5, 102], [100, 100.5, 101, 101.5, 102], {"clock_set_back": 1}),
        ([100, 100.5, 1, 1.5, 2], [100, 100.5, 101, 101.5, 102], {"clock_set_back": 1}),
        ([100, 1, 2], [100, 100, 101], {"clock_set_back": 1}),
        ([500, 501, 250, 251, 1, 2], [500, 501, 502, 503, 504, 505], {"clock_set_back": 2}),
        ([], [], {}),
    ],
)
def test_times(recorded: list[float], expected: list[float], refused: dict[str, int]) -> None:
    found, refusals = times(recorded)
    assert found == pytest.approx(expected) and refusals == refused
