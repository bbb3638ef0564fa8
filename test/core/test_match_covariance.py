# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a match's covariance is as large as its errors, also where walls say little."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from synthetic_scans import basin, corridor, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import compose, rotation, wrap
from msss_graphslam.core.matching.line_features import LineFeatures, line_features
from msss_graphslam.core.matching.match_covariance import MatchedPairs, match_covariance
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.point_to_line import match_lines
from msss_graphslam.core.types import Array

CONFIG = Matching()
GUESS = np.diag([0.3, 0.3, 0.05]) ** 2
DISPLACEMENT = np.array([0.6, -0.3, 0.15])
SEEDS = 40
WALL = [np.array([[-300.0, 4.0], [300.0, 4.0], [300.0, 4.5], [-300.0, 4.5]])]


def matched(
    walls: list[Array], pose: Array, seed: int, slip: Array | None = None
) -> tuple[MatchResult, Array]:
    """A match from a guess that is off, and its error in the axes of the walls."""
    rng = np.random.default_rng(seed)
    features = [
        _bent(*scan(walls, stand, rng), rng, slip) for stand in (pose, compose(pose, DISPLACEMENT))
    ]
    initial = DISPLACEMENT + rng.multivariate_normal(np.zeros(3), GUESS)
    result = match_lines(features[0], features[1], initial, GUESS, CONFIG)
    error = result.relative_pose - DISPLACEMENT
    error[2] = wrap(error[2])
    return result, error


def _bent(
    points: Array, covariances: Array, rng: np.random.Generator, slip: Array | None
) -> LineFeatures:
    """The scan as if the vehicle had moved, by what nobody knows of, with deviations ``slip``."""
    if slip is None:
        slip = np.zeros(3)
    share = np.linspace(0.0, 1.0, len(points))
    slips = np.zeros((len(points), 2, 3))
    slips[:, 0, 0] = slips[:, 1, 1] = 1.0
    slips[:, 0, 2], slips[:, 1, 2] = -points[:, 1], points[:, 0]
    slips = share[:, None, None] * slips * slip
    lines = line_features(points + slips @ rng.normal(size=3), covariances, slips)
    assert lines is not None
    return lines


def turned(matrix: Array, yaw: float) -> Array:
    """Return a relative pose's covariance in the axes of the walls."""
    turn = np.eye(3)
    turn[:2, :2] = rotation(yaw)
    return np.asarray(turn @ matrix @ turn.T)


def nees(walls: list[Array], slip: Array | None) -> float:
    pose, found = np.array([4.0, 4.0, 0.3]), []
    for seed in range(SEEDS):
        result, error = matched(walls, pose, seed, slip)
        assert result.accepted
        found.append(error @ np.linalg.solve(result.covariance, error) / 3.0)
    return float(np.mean(found))


@pytest.mark.parametrize(
    "slip",
    [None, np.array([0.1, 0.05, 0.0]), np.array([0.3, 0.3, 0.02])],
    ids=["none", "some", "much"],
)
def test_errors_are_as_large_as_stated(slip: Array | None) -> None:
    """However many points there are: what the motion does to all of them does not average out."""
    assert 0.5 < nees(basin(np.random.default_rng(3)), slip) < 1.6


@cache
def along_walls(name: str) -> tuple[Array, Array]:
    """Errors (n, 3) and covariances (n, 3, 3) in the axes of the walls, which run along x."""
    walls = {"corridor": corridor(), "one wall": WALL}[name]
    pose = np.array([0.0, 0.5, 0.3])
    rows = [matched(walls, pose, seed) for seed in range(SEEDS)]
    spreads = np.array([turned(result.covariance, pose[2]) for result, _ in rows])
    errors = np.array([[*(rotation(pose[2]) @ error[:2]), error[2]] for _, error in rows])
    return errors, spreads


@pytest.mark.parametrize("name", ["corridor", "one wall"])
def test_nothing_is_claimed_along_a_bare_wall(name: str) -> None:
    errors, spreads = along_walls(name)
    stated = np.sqrt(spreads[:, 0, 0])
    assert np.median(stated) > 1.0
    assert np.mean(np.abs(errors[:, 0]) < 2.0 * stated) > 0.95


@pytest.mark.parametrize("name", ["corridor", "one wall"])
def test_much_is_known_across_it(name: str) -> None:
    errors, spreads = along_walls(name)
    with_guess = np.linalg.inv(np.linalg.inv(spreads) + np.linalg.inv(GUESS))
    assert np.sqrt(with_guess[:, 1, 1].max()) < 0.05
    assert np.sqrt(np.mean(errors[:, 1] ** 2)) < 0.05


def test_a_wall_across_the_corridor_counts() -> None:
    found = []
    for end in (300.0, 10.0):
        walls = [np.array([[-300.0, -3.0], [end, -3.0], [end, 3.0], [-300.0, 3.0]])]
        result, _ = matched(walls, np.array([0.0, 0.5, 0.3]), 1)
        found.append(turned(result.covariance, 0.3)[0, 0])
    assert found[0] > 1.0
    assert found[1] < 0.1


def pairs(normals: Array, own: Array, residuals: Array) -> MatchedPairs:
    count = len(normals)
    zeros = np.zeros((count, 1))
    return MatchedPairs(
        jacobian=np.hstack([normals, zeros]),
        twin=np.hstack([own, zeros]),
        residuals=residuals,
        weights=np.ones(count),
        slips=np.hstack([normals, zeros, -normals, zeros]),
        prior=1e-6 * np.eye(3),
    )


def crossing(count: int) -> Array:
    return np.tile(np.eye(2), (count // 2, 1))


def covariance(normals: Array, own: Array, residuals: Array, guess: float = 1e3) -> Array:
    """Of a pair without slips, the same both ways; ``guess`` is the first one's deviation."""
    bare = pairs(normals, own, residuals)
    both = replace(bare, slips=0.0 * bare.slips, prior=np.eye(3) / guess**2)
    return match_covariance(both, both)


def test_independent_residuals_of_unit_size_give_the_inverse_of_the_hessian() -> None:
    residuals = np.random.default_rng(0).normal(size=4000)
    found = covariance(crossing(4000), crossing(4000), residuals)
    np.testing.assert_allclose(found[:2, :2], np.eye(2) / 2000.0, rtol=0.15, atol=1e-5)
    assert found[2, 2] == pytest.approx(1e4)


def test_residuals_that_repeat_themselves_count_once() -> None:
    rng = np.random.default_rng(0)
    once = covariance(crossing(2000), crossing(2000), rng.normal(size=2000))
    same = covariance(crossing(2000), crossing(2000), np.repeat(rng.normal(size=500), 4))
    assert 2.0 < same[0, 0] / once[0, 0] < 4.5


def test_scans_that_slip_draw_the_pose_as_far() -> None:
    """Each of them by a metre, independently; backwards they move the displacement against it."""
    residuals = np.random.default_rng(0).normal(size=400)
    slipping = pairs(crossing(400), crossing(400), residuals)
    backward = replace(slipping, jacobian=-slipping.jacobian, twin=-slipping.twin)
    found = match_covariance(slipping, backward)
    alone = covariance(crossing(400), crossing(400), residuals)
    np.testing.assert_allclose((found - alone)[:2, :2], 2.0 * np.eye(2), atol=1e-4)


@pytest.mark.parametrize(("scatter", "structured"), [(0.05, False), (0.3, False), (0.05, True)])
def test_the_scatter_of_normals_is_no_structure(scatter: float, structured: bool) -> None:
    rng = np.random.default_rng(4)
    angles = np.where(np.arange(300) % 3 == 0, 0.4, 0.0) if structured else np.zeros(300)
    both = [angles + scatter * rng.normal(size=300) for _ in range(2)]
    first, second = (np.column_stack([np.sin(one), np.cos(one)]) for one in both)
    found = covariance(first, second, rng.normal(size=300), guess=1.0)
    assert (found[0, 0] < 1.0) == structured
    with_guess = np.linalg.inv(np.linalg.inv(found) + np.eye(3))
    assert with_guess[1, 1] < 0.01


def across(scatter: float, guess: float) -> float:
    """The deviation across a bare wall, the way along it being as the guess has it."""
    rng = np.random.default_rng(4)
    angles = scatter * rng.normal(size=(2, 300))
    first, second = np.stack([np.sin(angles), np.cos(angles)], axis=2)
    found = covariance(first, second, rng.normal(size=300), guess)
    together = np.linalg.inv(np.linalg.inv(found) + np.eye(3) / guess**2)
    return float(np.sqrt(together[1, 1]))


def test_what_is_open_along_a_wall_makes_its_distance_doubtful() -> None:
    """By as much as the wall may be tilted, which its noisy normals say."""
    tilt = 0.1 * np.sqrt(7.0 / 300.0)
    near, far = across(0.1, 0.1), across(0.1, 20.0)
    assert near == pytest.approx(np.hypot(1.0 / np.sqrt(300.0), 0.1 * tilt), rel=0.3)
    assert far == pytest.approx(20.0 * tilt, rel=0.3)
    assert across(0.0, 20.0) == pytest.approx(across(0.0, 200.0), rel=0.01)


def test_no_residual_at_all_is_finite() -> None:
    found = covariance(crossing(8), crossing(8), np.zeros(8))
    assert np.isfinite(found).all()
    assert np.linalg.eigvalsh(found)[0] > 0.0


@pytest.mark.parametrize("likeness", [0.0, 0.3, 0.6])
def test_what_the_fit_has_taken_for_motion_is_counted(likeness: float) -> None:
    """A round of beams whose errors are alike: what residuals are left says less of it."""
    rng, squares, stated = np.random.default_rng(5), [], []
    bearings = np.linspace(0.0, 2.0 * np.pi, 140, endpoint=False)
    normals = np.column_stack([np.cos(bearings), np.sin(bearings)])
    for _ in range(300):
        errors = rng.normal(size=140)
        for number in range(1, 140):
            errors[number] *= np.sqrt(1.0 - likeness**2)
            errors[number] += likeness * errors[number - 1]
        off = np.linalg.lstsq(normals, errors, rcond=None)[0]
        squares.append(off**2)
        stated.append(np.diag(covariance(normals, normals, errors - normals @ off))[:2])
    assert 0.6 < np.mean(squares) / np.mean(stated) < 1.3
