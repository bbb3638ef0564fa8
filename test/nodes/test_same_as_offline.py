# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes find what the offline run finds, to the last digits."""

from functools import cache

import numpy as np
import pytest
from nodes.linked_nodes import LinkedNodes, scans_of
from small_mission import estimated, recorded

from msss_graphslam.core.types import Estimate, Scan

METRE = 1e-6


@cache
def scans() -> tuple[Scan, ...]:
    return tuple(scans_of(recorded().measurements))


@cache
def live(estimator: str) -> Estimate:
    linked = LinkedNodes(estimator)
    for scan in scans():
        linked.add_scan(scan)
    assert linked.front.waiting == 0
    assert not linked.refused
    return linked.back.logbook().finish()


def assert_same(one: Estimate, other: Estimate) -> None:
    assert len(one.keyframes) == len(other.keyframes) > 5
    for mine, theirs in zip(one.keyframes, other.keyframes, strict=True):
        assert mine.scan.stamp_ns == theirs.scan.stamp_ns
        np.testing.assert_allclose(mine.pose, theirs.pose, rtol=0, atol=METRE)
        np.testing.assert_allclose(mine.covariance, theirs.covariance, rtol=1e-6, atol=1e-12)
        np.testing.assert_allclose(mine.scan.points, theirs.scan.points, rtol=0, atol=METRE)
    assert edges(one) == edges(other)
    for name in ("trajectory", "dead_reckoning"):
        mine, theirs = getattr(one, name), getattr(other, name)
        assert np.array_equal(mine.stamps_ns, theirs.stamps_ns)
        np.testing.assert_allclose(mine.poses, theirs.poses, rtol=0, atol=METRE)


def edges(estimate: Estimate) -> list[tuple[str, int, int, str]]:
    return [
        (edge.kind.value, edge.first, edge.second, edge.refusal) for edge in estimate.constraints
    ]


@pytest.mark.parametrize("estimator", ["dead_reckoning", "uspic", "chen2015", "full"])
def test_the_nodes_find_what_the_offline_run_finds(estimator: str) -> None:
    assert_same(live(estimator), estimated(estimator))


def test_scans_that_come_all_at_once_change_nothing() -> None:
    linked = LinkedNodes(answers=False)
    for scan in scans():
        linked.add_scan(scan)
    assert linked.front.waiting > 5
    linked.answers = True
    linked.deliver()
    assert linked.front.waiting == 0
    assert_same(linked.back.logbook().finish(), estimated("full"))


def test_a_back_end_that_starts_anew_finds_the_same() -> None:
    linked = LinkedNodes()
    half = len(scans()) // 2
    for scan in scans()[:half]:
        linked.add_scan(scan)
    linked.start_back_end()
    for scan in scans()[:half]:
        linked.back.add_scan(scan)
    linked.replay_reports()
    for scan in scans()[half:]:
        linked.add_scan(scan)
    assert not linked.refused
    assert_same(linked.back.logbook().finish(), estimated("full"))


def test_finishing_a_logbook_does_not_touch_the_running_graph() -> None:
    linked = LinkedNodes()
    half = len(scans()) // 2
    for number, scan in enumerate(scans()):
        linked.add_scan(scan)
        if number == half:
            linked.back.logbook().finish()
    assert_same(linked.back.logbook().finish(), estimated("full"))
