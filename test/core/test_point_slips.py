# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
from moving_scans import BASIN, moving_scans

from msss_graphslam.core.matching.point_slips import point_slips
from msss_graphslam.core.scans.motion_feedback import offset_motion
from msss_graphslam.core.scans.scan_generation import lay_out
from msss_graphslam.core.types import Array, Scan

TWIST = np.array([[4e-4, 1e-4, 2e-5], [1e-4, 2e-4, -1e-5], [2e-5, -1e-5, 9e-6]])


def winding_scan() -> Scan:
    """A scan laid out along a bend, its motion doubted by TWIST."""
    scan = moving_scans(BASIN, 1)[0][0]
    motion = offset_motion(scan.motion, scan.beam_times[:-1], np.array([0.12, 0.03, 0.05]))
    return lay_out(scan, motion, TWIST)


def squared(slips: Array) -> Array:
    return np.asarray(slips @ np.swapaxes(slips, 1, 2))


def test_slips_are_what_the_motion_adds_to_the_covariances() -> None:
    scan = winding_scan()
    bare = lay_out(scan, scan.motion, np.zeros((3, 3)))
    np.testing.assert_allclose(
        squared(point_slips(scan)), scan.covariances - bare.covariances, atol=1e-9
    )


def test_points_slip_together_as_a_twist_moves_them() -> None:
    """An oracle: the scan laid out with twist errors drawn at random."""
    scan, rng = winding_scan(), np.random.default_rng(0)
    moved = []
    for twist in rng.multivariate_normal(np.zeros(3), 1e-4 * TWIST, 3000):
        motion = offset_motion(scan.motion, scan.beam_times[:-1], twist)
        moved.append(lay_out(scan, motion, TWIST).points[[20, 200]] - scan.points[[20, 200]])
    drawn = np.cov(100.0 * np.array(moved).reshape(-1, 4).T)
    both = point_slips(scan)[[20, 200]].reshape(4, 3)
    np.testing.assert_allclose(both @ both.T, drawn, atol=0.08 * drawn.max())


def test_a_scan_of_a_vehicle_that_is_sure_of_its_motion_does_not_slip() -> None:
    scan = lay_out(winding_scan(), winding_scan().motion, np.zeros((3, 3)))
    assert not point_slips(scan).any()


def test_a_scan_without_points_and_one_of_a_single_beam_are_no_trouble() -> None:
    scan = winding_scan()
    empty = replace(
        scan,
        beam_index=np.zeros(0, dtype=np.intp),
        points=np.zeros((0, 2)),
        covariances=np.zeros((0, 2, 2)),
    )
    assert point_slips(empty).shape == (0, 2, 3)
    single = replace(
        scan,
        beam_stamps_ns=scan.beam_stamps_ns[:1],
        motion=scan.motion[:1],
        motion_covariances=scan.motion_covariances[:1],
        beam_index=np.zeros(1, dtype=np.intp),
        points=scan.points[:1],
        covariances=scan.covariances[:1],
    )
    np.testing.assert_array_equal(point_slips(single), np.zeros((1, 2, 3)))


def test_a_vehicle_that_spins_once_in_a_turn_is_no_trouble() -> None:
    scan = winding_scan()
    spin = np.zeros_like(scan.motion)
    spin[:, 2] = 2.0 * np.pi * np.arange(1, len(spin) + 1) / len(spin)
    spun = lay_out(scan, spin, TWIST)
    slips = point_slips(spun)
    assert np.isfinite(slips).all()
    assert np.abs(slips).max() < 10.0
