# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from small_mission import scans

from msss_graphslam.core.scans.bare_scans import LaidOut, bare

LAYOUT = ("motion", "motion_covariances", "points", "covariances")
MEASURED = ("beam_stamps_ns", "reckoned", "beam_index", "body_points", "body_covariances")


def test_a_bare_scan_laid_out_is_the_same_to_the_last_bit() -> None:
    for scan, again in zip(scans(), LaidOut([bare(scan) for scan in scans()]), strict=True):
        for name in (*LAYOUT, *MEASURED):
            np.testing.assert_array_equal(getattr(again, name), getattr(scan, name))
        assert (again.end_stamp_ns, again.complete) == (scan.end_stamp_ns, scan.complete)


def test_a_bare_scan_holds_nothing_that_was_not_measured_but_its_motion() -> None:
    scan = bare(scans()[0])
    assert scan.motion_covariances.size == 0
    assert scan.points is scan.body_points
    assert scan.covariances is scan.body_covariances
    assert scan.odometry.tolist() == scans()[0].odometry.tolist()
    assert scan.body_points.base is None


def test_laid_out_scans_are_a_sequence() -> None:
    laid_out = LaidOut([bare(scan) for scan in scans()])
    assert len(laid_out) == len(scans())
    assert [scan.stamp_ns for scan in laid_out[1:3]] == [scan.stamp_ns for scan in scans()[1:3]]
    np.testing.assert_array_equal(laid_out[-1].points, scans()[-1].points)
    with pytest.raises(IndexError):
        laid_out[len(scans())]
    assert list(LaidOut([])) == []
