# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import pytest
from synthetic_run import synthetic_run, without_keyframes

from msss_graphslam.core.types import ConstraintKind
from msss_graphslam.results.record import example_scan


def with_completeness(record, complete):
    frames = tuple(
        replace(frame, scan=replace(frame.scan, complete=flag))
        for frame, flag in zip(record.estimate.keyframes, complete, strict=True)
    )
    return replace(record.estimate, keyframes=frames)


def test_loops_are_counted_without_the_other_edges():
    record = synthetic_run(8)
    loops = [e for e in record.estimate.constraints if e.kind is ConstraintKind.LOOP]
    assert record.tried_loops == len(loops) == 7 * 6 // 2
    assert record.accepted_loops == sum(not edge.refusal for edge in loops)


def test_the_realtime_factor_is_mission_over_wall_time():
    record = synthetic_run(5)
    assert record.realtime_factor == pytest.approx((5 * 60 - 1) * 0.2 / 2.5)


def test_the_example_is_the_complete_scan_with_the_longest_way():
    record = synthetic_run(4)
    ways = [float((f.scan.motion[-1, :2] ** 2).sum()) for f in record.estimate.keyframes]
    longest = ways.index(max(ways))
    assert example_scan(record.estimate) == longest
    complete = [number != longest for number in range(4)]
    assert example_scan(with_completeness(record, complete)) not in (None, longest)


def test_without_a_complete_scan_there_is_no_example():
    record = synthetic_run(2)
    assert example_scan(with_completeness(record, [False, False])) is None
    assert example_scan(without_keyframes(record).estimate) is None
