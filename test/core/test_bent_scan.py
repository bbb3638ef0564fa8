# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from moving_scans import BASIN, moving_scans
from numerical_derivatives import jacobian

from msss_graphslam.core.bent_pair import pairing
from msss_graphslam.core.bent_scan import BentScan, bend, reckoned_ends
from msss_graphslam.core.compounding import compose
from msss_graphslam.core.types import Array

START = np.array([2.0, -1.0, 0.7])
END = compose(START, np.array([1.3, 0.2, 0.4]))
SECONDS = 10.0


def bent(keyframes: Array, number: int = 0) -> BentScan:
    scans, _ = moving_scans(BASIN, count=3, noise=0.0)
    start, end = keyframes[:3], keyframes[3:]
    return bend(scans[number], reckoned_ends(scans)[number], start, end, SECONDS)


def test_it_starts_at_its_keyframe_and_ends_near_the_next() -> None:
    scan = bent(np.concatenate([START, END]))
    np.testing.assert_allclose(scan.beams[0], START[:2], atol=1e-12)
    step = np.linalg.norm(np.diff(scan.beams, axis=0), axis=1).mean()
    assert np.linalg.norm(scan.beams[-1] - END[:2]) < 2.0 * step


@pytest.mark.parametrize("beam", [0, 1, 60, 239])
def test_places_of_the_beams_are_derived_by_both_keyframes(beam: int) -> None:
    at = np.concatenate([START, END])
    expected = jacobian(lambda x: bent(x).beams[beam], at)
    np.testing.assert_allclose(bent(at).by_keyframes[beam, :2], expected, atol=1e-5)


def test_headings_go_over_from_one_keyframe_to_the_next() -> None:
    derivative = bent(np.concatenate([START, END])).by_keyframes[:, 2]
    np.testing.assert_allclose(derivative[:, 2] + derivative[:, 5], 1.0)
    np.testing.assert_allclose(derivative[:, 5], np.arange(240) / 240.0)
    np.testing.assert_allclose(derivative[:, [0, 1, 3, 4]], 0.0, atol=1e-12)


def test_the_twist_is_derived_by_both_keyframes() -> None:
    at = np.concatenate([START, END])
    expected = jacobian(lambda x: bent(x).twist, at)
    # Equation 14 turns each step by its own half, one part in the number of beams.
    np.testing.assert_allclose(bent(at).twist_by_keyframes, expected, atol=1e-3)


def test_what_dead_reckoning_says_needs_no_twist() -> None:
    scans, _ = moving_scans(BASIN, count=2, noise=0.0)
    end = reckoned_ends(scans)[0]
    scan = bend(scans[0], end, START, compose(START, end), SECONDS)
    np.testing.assert_allclose(scan.twist, 0.0, atol=1e-12)


def test_true_keyframes_put_all_points_on_the_walls() -> None:
    scans, truth = moving_scans(BASIN, count=3, noise=0.0)
    ends = reckoned_ends(scans)
    first = bend(scans[0], ends[0], truth[0], truth[1], SECONDS)
    second = bend(scans[1], ends[1], truth[1], truth[2], SECONDS)
    found = pairing(first, second, 0.5)
    assert found is not None
    step = np.linalg.lstsq(found.information, found.gradient, rcond=1e-9)[0]
    assert np.abs(step).max() < 0.01


def test_a_far_scan_makes_no_pairs() -> None:
    scans, truth = moving_scans(BASIN, count=2, noise=0.0)
    ends = reckoned_ends(scans)
    near = bend(scans[0], ends[0], truth[0], truth[1], SECONDS)
    away = np.array([500.0, 0.0, 0.0])
    far = bend(scans[1], ends[1], truth[1] + away, truth[2] + away, SECONDS)
    assert pairing(near, far, 0.5) is None
