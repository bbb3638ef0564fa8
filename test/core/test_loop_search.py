# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which keyframes the newest one is tried to close a loop with."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from made_scans import standing_scan
from synthetic_scans import basin

from msss_graphslam.config.groups import Association
from msss_graphslam.core.graph.keyframes import Node, bare_scan, newest_place, places, put_by
from msss_graphslam.core.graph.loop_search import as_in_the_paper, by_overlap, reach
from msss_graphslam.core.matching.shape_matching import shape_descriptor
from msss_graphslam.core.types import Array

SURE = 1e-6 * np.eye(3)
CONFIG = Association(mahalanobis_threshold=9.0, reach=0.3, most=4)


def chain(count: int, apart: Sequence[int] = ()) -> list[Node]:
    """Return nodes of one and the same scan, which is as good as without covariance.

    Those ``apart`` are no places.
    """
    rng = np.random.default_rng(0)
    scan = standing_scan(basin(rng), np.zeros(3), np.zeros(3), 0, rng)
    descriptor = shape_descriptor(scan.points, 0.0)
    nodes: list[Node] = []
    for number in range(count):
        node = Node(scan, None, scan, SURE, descriptor, number not in apart)
        node.place_before = newest_place(nodes)
        nodes.append(node)
    return nodes


def on_a_line(*places: float) -> Array:
    """Return poses (n, 3), so many reaches ahead of the origin; the newest lies there."""
    ahead = reach(chain(1)[0], CONFIG) * np.array([*places, 100.0, 0.0])
    return np.column_stack([ahead, np.zeros_like(ahead), np.zeros_like(ahead)])


def numbers(poses: Array, config: Association = CONFIG) -> list[int]:
    return [candidate.index for candidate in by_overlap(chain(len(poses)), poses, config)]


def test_reach_is_a_share_of_the_median_range() -> None:
    (node,) = chain(1)
    ranges = np.hypot(*node.scan.body_points.T)
    assert reach(node, CONFIG) == pytest.approx(0.3 * np.median(ranges))
    assert reach(Node(bare_scan(0, np.zeros(3)), None, node.scan, SURE), CONFIG) == 0.0


@pytest.mark.parametrize(("distance", "near"), [(2.999, [0]), (3.001, [])])
def test_scans_overlap_within_three_reaches(distance: float, near: list[int]) -> None:
    """Poses are known to a millimetre: by equation 11 none would be near."""
    assert numbers(on_a_line(distance)) == near


def test_a_keyframe_with_a_doubtful_pose_may_be_farther_off() -> None:
    nodes, poses = chain(3), on_a_line(5.0)
    assert by_overlap(nodes, poses, CONFIG) == []
    nodes[0].covariance = 100.0 * np.eye(3)
    (found,) = by_overlap(nodes, poses, CONFIG)
    assert found.mahalanobis < 9.0
    assert found.shape_distance is None
    assert found.accepted


def test_of_many_the_nearest_are_taken_and_of_neighbours_one() -> None:
    poses = on_a_line(0.5, 0.4, 0.3, 2.0, 0.1, 1.0, 0.6)
    assert numbers(poses) == [0, 2, 4, 6]
    assert numbers(poses, replace(CONFIG, most=1)) == [4]
    assert numbers(poses, replace(CONFIG, most=2)) == [2, 4]
    assert numbers(poses, replace(CONFIG, most=1000)) == [0, 2, 4, 6]
    assert numbers(on_a_line(0.1, 0.2, 0.3, 0.4, 0.5)) == [0, 2, 4]


def test_the_preceding_keyframe_is_no_candidate() -> None:
    assert by_overlap(chain(2), np.zeros((2, 3)), CONFIG) == []
    assert numbers(np.zeros((3, 3))) == [0]


def test_keyframes_that_are_no_places_are_passed_over() -> None:
    nodes, poses = chain(8, apart=[0, 1, 3]), on_a_line(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    assert places(nodes) == [2, 4, 5]
    for search in (by_overlap, as_in_the_paper):
        wide = replace(CONFIG, mahalanobis_threshold=1e12)
        found = [candidate.index for candidate in search(nodes, poses, wide)]
        assert found == ([2, 4] if search is by_overlap else [2, 4, 5])


@pytest.mark.parametrize("count", range(5))
def test_the_newest_two_are_no_places_yet(count: int) -> None:
    assert places(chain(count)) == list(range(count - 2))
    assert places(chain(count, apart=range(count))) == []


def test_a_shape_that_differs_counts_in_the_paper_alone() -> None:
    nodes, poses = chain(3), np.zeros((3, 3))
    along = np.column_stack([np.arange(30.0), np.zeros(30)])
    nodes[0].descriptor = shape_descriptor(along, 0.0)
    (as_printed,) = as_in_the_paper(nodes, poses, CONFIG)
    assert as_printed.refusal == "shape_differs"
    (found,) = by_overlap(nodes, poses, CONFIG)
    assert found.accepted


def test_what_is_put_by_can_still_be_matched() -> None:
    (node,) = chain(1)
    node.prepared, stamp_ns = "prepared", node.first_scan.stamp_ns
    put_by(node)
    assert node.prepared == "prepared"
    assert not len(node.scan.points)
    assert len(node.descriptor)
    assert node.first_scan.stamp_ns == stamp_ns
    node.is_place = False
    put_by(node)
    assert (node.prepared, len(node.descriptor)) == (None, 0)
