# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from moving_scans import BASIN, moving_scans
from numerical_derivatives import jacobian

from msss_graphslam.core.matching.plane_vectors import vectors
from msss_graphslam.core.smoothing.bent_scan import BentScan, bend, reckoned_ends
from msss_graphslam.core.types import Array

END = np.array([1.3, 0.2, 0.4])
SECONDS = 10.0


def bent(relative: Array) -> BentScan:
    scans, _ = moving_scans(BASIN, count=2, noise=0.0)
    return bend(scans[0], reckoned_ends(scans)[0], relative, SECONDS)


def places(relative: Array) -> Array:
    lines = bent(relative).lines
    assert lines is not None
    return lines.points


def test_the_first_point_stays_and_the_last_one_turns_with_the_next_keyframe() -> None:
    straight, curved = vectors(places(np.zeros(3))), vectors(places(END))
    assert curved[0] == pytest.approx(straight[0])
    at_end = complex(*END[:2]) + np.exp(1j * END[2]) * straight[-1]
    step = np.abs(END[:2]).max() / 240.0 + abs(straight[-1]) * END[2] / 240.0
    assert abs(curved[-1] - at_end) < 2.0 * step


@pytest.mark.parametrize("number", [0, 1, 60, 200])
def test_points_are_derived_by_the_twist(number: int) -> None:
    scan = bent(END)
    moved = jacobian(lambda relative: places(relative)[number], END)
    here = np.array([number])
    point = vectors(places(END)[here])
    by_twist = np.vstack(
        [
            scan.lines_hanging.at(here).along(np.array([normal]), point)
            for normal in (1.0 + 0.0j, 1.0j)
        ]
    )
    np.testing.assert_allclose(by_twist @ scan.twist_by_relative, moved, atol=1e-5)


def test_the_twist_is_derived_by_the_next_keyframe() -> None:
    expected = jacobian(lambda relative: bent(relative).twist, END)
    # Equation 14 turns each step by its own half, one part in the number of beams.
    np.testing.assert_allclose(bent(END).twist_by_relative, expected, atol=1e-3)


def test_what_dead_reckoning_says_needs_no_twist() -> None:
    scans, _ = moving_scans(BASIN, count=2, noise=0.0)
    end = reckoned_ends(scans)[0]
    scan = bend(scans[0], end, end, SECONDS)
    assert scan.lines is not None
    np.testing.assert_allclose(scan.twist, 0.0, atol=1e-12)
    np.testing.assert_allclose(scan.lines.points, scans[0].points, atol=1e-12)


def test_the_covariances_are_the_sonars_alone_and_turn_with_the_beam() -> None:
    scans, _ = moving_scans(BASIN, count=2)
    scan = bend(scans[0], reckoned_ends(scans)[0], np.array([0.0, 0.0, np.pi]), SECONDS)
    assert scan.lines is not None
    measured = scans[0].body_covariances
    eigenvalues = np.linalg.eigvalsh(scan.lines.covariances)
    np.testing.assert_allclose(eigenvalues, np.linalg.eigvalsh(measured))
    halfway = int(np.searchsorted(scans[0].beam_index, 120))
    turned = measured[halfway][::-1, ::-1] * [[1.0, -1.0], [-1.0, 1.0]]
    np.testing.assert_allclose(scan.lines.covariances[halfway], turned, atol=2e-3)


@pytest.mark.parametrize("count", [0, 3])
def test_a_scan_with_too_few_points_still_has_a_twist(count: int) -> None:
    scans, _ = moving_scans(BASIN, count=2)
    few = replace(
        scans[0],
        beam_index=scans[0].beam_index[:count],
        body_points=scans[0].body_points[:count],
        body_covariances=scans[0].body_covariances[:count],
    )
    scan = bend(few, reckoned_ends(scans)[0], END, SECONDS)
    assert scan.lines is None
    assert len(scan.points) == 0
    np.testing.assert_array_equal(scan.twist, bent(END).twist)
