# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Keyframes as the front end keeps them, and what it forgets of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import Array, Scan

__all__ = ["Node", "bare_scan", "newest_place", "places", "put_by"]


@dataclass(slots=True)
class Node:
    """A keyframe.

    ``scan`` in its present layout and ``prepared`` for the matcher, ``first_scan`` as dead
    reckoning laid it out, its ``descriptor``, and ``covariance`` (3, 3) of its pose when it was
    added, which later poses only make smaller. ``is_place``: whether later scans are matched with
    it, as they are not where nothing was seen; ``place_before`` is the number of the newest place
    before it, -1 if there is none. Of the scans only stamp and odometry are left when two others
    have followed.
    """

    scan: Scan
    prepared: Any
    first_scan: Scan
    covariance: Array
    descriptor: Array = field(default_factory=lambda: np.empty((0, 0)))
    is_place: bool = True
    place_before: int = -1


def newest_place(nodes: Sequence[Node]) -> int:
    """Return the number of the newest node that is a place, -1 if none is."""
    if not nodes or nodes[-1].is_place:
        return len(nodes) - 1
    return nodes[-1].place_before


def places(nodes: Sequence[Node]) -> list[int]:
    """Return the numbers of the nodes that later scans are matched with, oldest first.

    The newest two are none yet. Goes from place to place: of a day's keyframes few are.
    """
    numbers: list[int] = []
    number = newest_place(nodes[:-2])
    while number >= 0:
        numbers.append(number)
        number = nodes[number].place_before
    return numbers[::-1]


def put_by(node: Node) -> None:
    """Drop what no later scan is matched with or corrected by."""
    node.scan = node.first_scan = bare_scan(node.first_scan.stamp_ns, node.first_scan.odometry)
    if not node.is_place:
        node.prepared, node.descriptor = None, node.descriptor[:0].copy()


def bare_scan(stamp_ns: int, odometry: Array) -> Scan:
    """Return a scan without echoes at a pose (3,) of dead reckoning."""
    reckoned = np.zeros((2, 6))
    reckoned[:, [0, 1, 5]] = odometry
    return reckoned_scan(
        beam_stamps_ns=np.array([stamp_ns]),
        end_stamp_ns=stamp_ns,
        reckoned=reckoned,
        twist_covariance=np.zeros((3, 3)),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
    )
