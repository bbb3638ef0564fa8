# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the front end changed on the way, and what it keeps of earlier scans."""

import numpy as np
import pytest
from small_mission import scans

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph import known_places
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Constraint, ConstraintKind, GraphPoses

STRICT = Configuration().with_values({"association.mahalanobis_threshold": 0.0})


def loops(*, strict_from: int | None) -> list[Constraint]:
    """Return the loop closures tried, from that scan on with no keyframe near enough."""
    front_end, found = FrontEnd(Configuration(), ESTIMATORS["full"]), []
    for number, scan in enumerate(scans()):
        if number == strict_from:
            front_end.configure(STRICT)
        found += front_end.add_scan(scan)
    return [entry for entry in found if entry.kind is ConstraintKind.LOOP]


def test_changed_parameters_hold_from_the_next_scan_on() -> None:
    unchanged = loops(strict_from=None)
    seconds = sorted({entry.second for entry in unchanged})
    assert len(seconds) > 1
    changed = loops(strict_from=seconds[-1])
    assert [(entry.first, entry.second) for entry in changed] == [
        (entry.first, entry.second) for entry in unchanged if entry.second < seconds[-1]
    ]


def kept(front_end: FrontEnd) -> list[bool]:
    return [node.prepared is not None for node in front_end.nodes]


def test_of_an_earlier_scan_stays_what_later_ones_are_matched_with() -> None:
    front_end = FrontEnd(Configuration(), ESTIMATORS["full"])
    for scan in scans():
        front_end.add_scan(scan)
    for node, scan in zip(front_end.nodes, scans(), strict=True):
        assert node.first_scan.stamp_ns == scan.stamp_ns
        np.testing.assert_array_equal(node.first_scan.odometry, scan.odometry)
    assert all(kept(front_end))
    assert all(not len(node.scan.points) for node in front_end.nodes[:-2])
    assert all(len(node.first_scan.points) for node in front_end.nodes[-2:])


def test_with_a_known_place_later_scans_are_not_matched(monkeypatch: pytest.MonkeyPatch) -> None:
    """The newest keyframes stay whole, for they are corrected yet."""
    unknown = loops(strict_from=None)
    monkeypatch.setattr(known_places, "KEYFRAMES", 1)
    monkeypatch.setattr(known_places, "CLOSURES", 1)
    front_end, found = FrontEnd(Configuration(), ESTIMATORS["full"]), []
    for scan in scans():
        found += front_end.add_scan(scan)
    closed = {entry.second for entry in found if entry.kind is ConstraintKind.LOOP}
    passed = [number for number, node in enumerate(front_end.nodes) if not node.is_place]
    assert passed
    assert set(passed) <= closed
    partners = {entry.first for entry in found if entry.kind is ConstraintKind.LOOP}
    assert not partners & set(passed)
    assert {entry.first for entry in unknown} & set(passed)
    assert [index not in passed for index in range(len(kept(front_end)) - 2)] == kept(front_end)[
        :-2
    ]


def test_keyframes_without_echoes_are_no_places() -> None:
    front_end = FrontEnd(Configuration(), ESTIMATORS["full"])
    first = scans()[:3]
    front_end.adopt(
        GraphPoses(
            np.array([scan.stamp_ns for scan in first]),
            np.array([scan.odometry for scan in first]),
            np.array([scan.odometry for scan in first]),
            np.tile(1e-4 * np.eye(3), (3, 1, 1)),
        )
    )
    tried = [entry for scan in scans()[3:6] for entry in front_end.add_scan(scan)]
    assert all(entry.first >= 3 for entry in tried if entry.kind is ConstraintKind.LOOP)
