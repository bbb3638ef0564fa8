# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from moving_scans import BASIN, moving_scans

from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.smoothing.bent_pair import FEWEST, Pairing, pairings
from msss_graphslam.core.smoothing.bent_scan import BentScan, bend, reckoned_ends
from msss_graphslam.core.types import Array

SECONDS = 10.0
SCANS, TRUTH = moving_scans(BASIN, count=3, noise=0.0)


def bent(number: int, bias: Array | None = None) -> BentScan:
    """A scan that ends where it truly does, or off by ``bias`` (3,)."""
    relative = between(TRUTH[number], TRUTH[number + 1])
    relative = relative + (np.zeros(3) if bias is None else bias)
    return bend(SCANS[number], reckoned_ends(SCANS)[number], relative, SECONDS)


def pairing(displacement: Array, first: BentScan, second: BentScan) -> Pairing:
    (found,) = pairings([first], displacement[None], second, 0.5)
    assert found is not None
    return found


def step(found: Pairing, numbers: slice) -> Array:
    return np.asarray(
        -np.linalg.solve(found.information[numbers, numbers], found.gradient[numbers])
    )


def test_true_keyframes_put_all_points_on_the_walls() -> None:
    found = pairing(between(TRUTH[1], TRUTH[0]), bent(0), bent(1))
    assert np.abs(step(found, slice(0, 3))).max() < 0.01


def test_a_displacement_is_taken_back() -> None:
    off = np.array([0.05, -0.03, 0.01])
    true = between(TRUTH[1], TRUTH[0])
    before = step(pairing(true, bent(0), bent(1)), slice(0, 3))
    found = step(pairing(true + off, bent(0), bent(1)), slice(0, 3))
    np.testing.assert_allclose(found - before, -off, atol=0.005)


@pytest.mark.parametrize("of_points", [True, False])
def test_a_twist_error_is_taken_back(of_points: bool) -> None:
    bias = np.array([0.08, -0.06, 0.02])
    biased = bent(0, bias), bent(1, bias)
    error = biased[1 - of_points].twist - bent(1 - of_points).twist
    scans = (biased[0], bent(1)) if of_points else (bent(0), biased[1])
    numbers = slice(3, 6) if of_points else slice(6, 9)
    true = between(TRUTH[1], TRUTH[0])
    before = step(pairing(true, bent(0), bent(1)), numbers)
    found = step(pairing(true, *scans), numbers)
    np.testing.assert_allclose(found - before, -error, atol=0.3 * np.abs(error).max())


def test_several_scans_at_once_are_the_same_as_one_by_one() -> None:
    displacements = between(TRUTH[1], TRUTH[[0, 2]])
    together = pairings([bent(0), bent(2)], displacements, bent(1), 0.5)
    for number, displacement, found in zip((0, 2), displacements, together, strict=True):
        alone = pairing(displacement, bent(number), bent(1))
        assert found is not None
        np.testing.assert_allclose(found.information, alone.information, rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(found.gradient, alone.gradient, rtol=1e-9, atol=1e-6)


def test_a_far_scan_makes_no_pairs_and_does_not_disturb_the_others() -> None:
    near = between(TRUTH[1], TRUTH[0])
    far = compose(np.array([500.0, 0.0, 0.0]), near)
    found = pairings([bent(0)] * 3, np.array([far, near, far]), bent(1), 0.5)
    assert found[0] is None
    assert found[1] is not None
    assert found[2] is None


@pytest.mark.parametrize(("count", "known"), [(FEWEST - 1, False), (FEWEST, True)])
def test_the_fewest_points(count: int, known: bool) -> None:
    lines, whole = bent(1), bent(1)
    chosen = np.arange(20, 20 + count)
    few = replace(
        whole,
        points=whole.points[chosen],
        normals=whole.normals[chosen],
        covariances=whole.covariances[chosen],
        points_hanging=whole.points_hanging.at(chosen),
    )
    found = pairings([few], np.zeros((1, 3)), lines, 0.5)
    assert (found[0] is not None) is known


def test_the_other_side_of_a_wall_is_no_pair() -> None:
    scan = bent(1)
    behind = replace(scan, normals=-scan.normals)
    assert pairings([behind], np.zeros((1, 3)), scan, 0.5) == [None]
    assert pairings([scan], np.zeros((1, 3)), scan, 0.5) != [None]


def test_a_scan_without_lines_has_no_pairs() -> None:
    silent = replace(
        bent(0),
        lines=None,
        points=np.empty(0, dtype=complex),
        normals=np.empty(0, dtype=complex),
        covariances=np.empty((0, 2, 2)),
        points_hanging=bent(0).points_hanging.at(np.empty(0, dtype=np.intp)),
    )
    assert pairings([bent(0)], np.zeros((1, 3)), silent, 0.5) == [None]
    assert pairings([silent], np.zeros((1, 3)), bent(0), 0.5) == [None]
