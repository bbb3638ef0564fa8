# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from moving_scans import BASIN, BLIND, moving_scans

from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.smoothing.twist_chain import TwistChain, durations_of
from msss_graphslam.core.types import Array, Scan

LASTING, NEW = Persistence(20.0, np.diag(BLIND)), Persistence(20.0, np.zeros(3))


def scans(count: int = 3) -> list[Scan]:
    return moving_scans(BASIN, count)[0]


def by_ends(count: int) -> Array:
    """Twist errors that are the next keyframe less the own one, in ten seconds."""
    return np.tile(np.hstack([-0.1 * np.eye(3), 0.1 * np.eye(3)]), (count, 1, 1))


def equations(persistence: Persistence, twists: Array, made: list[Scan]) -> NormalEquations:
    found = NormalEquations(len(made) + 1)
    TwistChain(made, persistence).add_to(found, twists, by_ends(len(made)))
    return found


def test_twist_errors_that_nothing_else_knows_go_to_zero() -> None:
    twists = np.array([[0.1, -0.2, 0.01], [0.3, 0.1, 0.02], [-0.1, 0.0, 0.03]])
    for persistence in (LASTING, NEW):
        step = equations(persistence, twists, scans()).solution()
        np.testing.assert_allclose(0.1 * np.diff(step, axis=0, prepend=0.0), -twists, atol=1e-9)


def test_each_scan_is_as_doubtful_as_dead_reckoning_says() -> None:
    covariance = equations(LASTING, np.zeros((3, 3)), scans()).covariances()[1]
    np.testing.assert_allclose(covariance, 100.0 * BLIND, rtol=1e-6)


@pytest.mark.parametrize(("sway", "taken"), [(0.01, 0.03), (0.03, 0.03), (0.05, 0.05)])
def test_sway_is_no_surer_than_surge(sway: float, taken: float) -> None:
    stated = np.diag([0.03, sway, 0.002]) ** 2
    stated[0, 1] = stated[1, 0] = 0.5 * 0.03 * sway
    made = [replace(scan, twist_covariance=stated) for scan in scans(1)]
    covariance = equations(NEW, np.zeros((1, 3)), made).covariances()[1]
    expected = np.diag([0.03, taken, 0.002]) ** 2
    expected[0, 1] = expected[1, 0] = 0.5 * 0.03 * taken
    np.testing.assert_allclose(covariance, 100.0 * expected, rtol=1e-4)


@pytest.mark.parametrize("persistence", [LASTING, NEW])
def test_errors_that_last_add_up(persistence: Persistence) -> None:
    shared = persistence.over(10.0, BLIND)[0]
    covariance = equations(persistence, np.zeros((2, 3)), scans(2)).covariances()[2]
    np.testing.assert_allclose(covariance, (2.0 + 2.0 * shared) * 100.0 * BLIND, rtol=1e-5)


def test_a_scan_that_was_lost_is_as_doubtful_as_any() -> None:
    made = scans(2)
    made[0] = replace(made[0], twist_covariance=np.zeros((3, 3)))
    made[1] = replace(made[1], twist_covariance=0.5 * BLIND)
    covariance = equations(NEW, np.zeros((2, 3)), made).covariances()[1]
    np.testing.assert_allclose(covariance, 50.0 * BLIND, rtol=1e-5)


def test_a_sure_scan_is_not_taken_for_impossible() -> None:
    made = [replace(scan, twist_covariance=np.zeros((3, 3))) for scan in scans(2)]
    assert np.isfinite(equations(NEW, np.zeros((2, 3)), made).covariances()).all()


def test_durations_run_to_the_next_scan_and_at_last_to_the_end() -> None:
    made = scans(3)
    made[1] = replace(made[1], beam_stamps_ns=made[1].beam_stamps_ns + 2_000_000_000)
    np.testing.assert_allclose(durations_of(made), [12.0, 8.0, 10.0])


def test_two_scans_at_one_time_do_not_divide_by_zero() -> None:
    made = scans(2)
    made[1] = replace(made[1], beam_stamps_ns=made[0].beam_stamps_ns)
    assert (durations_of(made) > 0.0).all()
