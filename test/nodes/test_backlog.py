# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import Scan
from msss_graphslam.nodes.replay.backlog import Backlog


def scan(stamp_ns: int) -> Scan:
    return reckoned_scan(
        beam_stamps_ns=np.array([stamp_ns]),
        end_stamp_ns=stamp_ns + 10,
        reckoned=np.zeros((2, 6)),
        twist_covariance=np.eye(3),
        beam_index=np.zeros(0, dtype=np.intp),
        body_points=np.zeros((0, 2)),
        body_covariances=np.zeros((0, 2, 2)),
    )


def test_it_is_too_long_from_one_scan_more_than_the_most_on() -> None:
    backlog = Backlog(most=2)
    backlog.scanned(scan(0))
    backlog.scanned(scan(10))
    assert not backlog.is_too_long
    backlog.scanned(scan(20))
    assert backlog.is_too_long


def test_a_correction_takes_away_the_scans_up_to_its_own() -> None:
    backlog = Backlog(most=0)
    backlog.scanned(scan(0))
    backlog.scanned(scan(10))
    backlog.corrected(10)
    assert backlog.is_too_long
    backlog.corrected(20)
    assert not backlog.is_too_long


def test_a_scan_that_makes_no_keyframe_is_not_waited_for() -> None:
    backlog = Backlog(most=0)
    backlog.scanned(replace(scan(0), usable=False))
    assert not backlog.is_too_long


def test_it_forgets_what_never_is_answered() -> None:
    backlog = Backlog(most=0)
    backlog.scanned(scan(0))
    backlog.restart()
    assert not backlog.is_too_long
