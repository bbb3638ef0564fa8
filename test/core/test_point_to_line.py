# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_scans import basin, corridor, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import (
    compose,
    inverse,
    inverse_jacobian,
    rotation,
    transform_points,
    wrap,
)
from msss_graphslam.core.matching.line_features import LineFeatures, line_features
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.point_to_line import match_lines
from msss_graphslam.core.types import Array

CONFIG = Matching()
GUESS = np.diag([0.3, 0.3, 0.05]) ** 2
STANDPOINT = np.array([4.0, 4.0, 0.3])
DISPLACEMENT = np.array([0.6, -0.3, 0.15])


def seen(walls: list[Array], pose: Array, rng: np.random.Generator) -> LineFeatures:
    found = line_features(*scan(walls, pose, rng))
    assert found is not None
    return found


def pair(seed: int, displacement: Array = DISPLACEMENT) -> tuple[LineFeatures, LineFeatures]:
    """Two scans of one basin, the second from ``displacement`` in the first."""
    rng = np.random.default_rng(seed)
    walls = basin(rng)
    second = compose(STANDPOINT, displacement)
    return seen(walls, STANDPOINT, rng), seen(walls, second, rng)


def guess(seed: int) -> Array:
    rng = np.random.default_rng(1000 + seed)
    return DISPLACEMENT + rng.normal(0.0, [0.2, 0.2, 0.04])


def match(seed: int, config: Matching = CONFIG) -> MatchResult:
    return match_lines(*pair(seed), guess(seed), GUESS, config)


def error_of(result: MatchResult, displacement: Array = DISPLACEMENT) -> Array:
    error = result.relative_pose - displacement
    error[2] = wrap(error[2])
    return error


@pytest.mark.parametrize("seed", range(12))
def test_a_known_displacement_is_found(seed: int) -> None:
    result = match(seed)
    assert result.accepted
    error = error_of(result)
    assert np.hypot(*error[:2]) < 0.06
    assert abs(error[2]) < 0.015


def test_the_errors_are_as_large_as_the_covariance_says() -> None:
    nees = []
    for seed in range(25):
        result = match(seed)
        error = error_of(result)
        nees.append(float(error @ np.linalg.solve(result.covariance, error)))
    assert 1.0 < np.mean(nees) < 5.0


def test_motion_across_half_a_turn() -> None:
    displacement = np.array([0.3, 0.2, np.pi - 0.01])
    first, second = pair(1, displacement)
    initial = displacement + np.array([0.1, -0.1, 0.03])
    result = match_lines(first, second, initial, GUESS, CONFIG)
    assert result.accepted
    np.testing.assert_allclose(error_of(result, displacement), 0.0, atol=0.05)
    assert -np.pi < result.relative_pose[2] <= np.pi


@pytest.mark.parametrize("seed", range(5))
def test_a_corridor_is_known_across_and_not_along(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = np.array([0.0, 0.5, 0.3])
    first = seen(corridor(), pose, rng)
    second = seen(corridor(), compose(pose, DISPLACEMENT), rng)
    offset = rotation(-pose[2]) @ [0.2, 0.1]
    initial = DISPLACEMENT + np.array([*offset, 0.03])
    result = match_lines(first, second, initial, GUESS, CONFIG)
    along, across = rotation(-pose[2]).T
    position = result.covariance[:2, :2]
    assert along @ position @ along > 100.0 * across @ position @ across
    assert abs(along @ (result.relative_pose - initial)[:2]) < 0.25
    assert abs(across @ error_of(result)[:2]) < 0.05
    assert abs(error_of(result)[2]) < 0.01


def test_points_better_than_stated_outweigh_a_wrong_guess() -> None:
    """How large residuals are is told by themselves; a guess counts by its own covariance."""
    first, second = pair(1)
    vague = [
        replace(scan, covariances=9.0 * scan.covariances, variances=9.0 * scan.variances)
        for scan in (first, second)
    ]
    initial = DISPLACEMENT + np.array([0.1, -0.1, 0.03])
    narrow = np.diag([0.1, 0.1, 0.03]) ** 2
    sharp, told = (
        match_lines(*scans, initial, narrow, CONFIG) for scans in ((first, second), vague)
    )
    np.testing.assert_allclose(told.relative_pose, sharp.relative_pose, atol=8e-3)


def test_bare_walls_leave_the_guess_along_them() -> None:
    """Without noise nothing at all speaks of the motion along the walls."""
    x = np.arange(-10.0, 10.0, 0.1)
    points = np.vstack([np.column_stack([x, np.full(200, side)]) for side in (-3.0, 3.0)])
    covariances = np.tile(1e-4 * np.eye(2), (400, 1, 1))
    lines = line_features(points, covariances)
    result = match_lines(lines, lines, np.array([0.33, 0.1, 0.02]), GUESS, CONFIG)
    np.testing.assert_allclose(result.relative_pose, [0.33, 0.0, 0.0], atol=2e-3)
    assert result.covariance[0, 0] > 1e3
    assert result.covariance[1, 1] < 1e-4
    assert result.accepted


def test_the_same_scan_has_not_moved() -> None:
    first, _ = pair(2)
    result = match_lines(first, first, np.array([0.1, -0.1, 0.02]), GUESS, CONFIG)
    assert result.accepted
    np.testing.assert_allclose(result.relative_pose, 0.0, atol=0.01)
    assert result.figures["overlap"] > 0.95


@pytest.mark.parametrize("seed", range(6))
def test_the_scans_may_change_places(seed: int) -> None:
    first, second = pair(seed)
    initial = guess(seed)
    turned = inverse_jacobian(initial)
    there = match_lines(first, second, initial, GUESS, CONFIG)
    back = match_lines(second, first, inverse(initial), turned @ GUESS @ turned.T, CONFIG)
    error = inverse(back.relative_pose) - there.relative_pose
    assert np.hypot(*error[:2]) < 0.003
    assert abs(error[2]) < 0.001
    assert back.refusal == there.refusal
    # Where a pair is at the edge of what may be one, a millimetre decides.
    assert back.figures["overlap"] == pytest.approx(there.figures["overlap"], abs=0.01)


def test_the_same_scans_give_the_same_bits() -> None:
    once, again = match(3), match(3)
    np.testing.assert_array_equal(once.relative_pose, again.relative_pose)
    np.testing.assert_array_equal(once.covariance, again.covariance)


def test_nothing_handed_in_is_changed() -> None:
    first, second = pair(4)
    initial, covariance, points = guess(4), GUESS.copy(), first.points.copy()
    before = initial.copy()
    match_lines(first, second, initial, covariance, CONFIG)
    np.testing.assert_array_equal(initial, before)
    np.testing.assert_array_equal(covariance, GUESS)
    np.testing.assert_array_equal(first.points, points)


@pytest.mark.parametrize("missing", [0, 1])
def test_too_few_points_keep_the_guess_and_are_refused(missing: int) -> None:
    scans: list[LineFeatures | None] = [*pair(5)]
    scans[missing] = None
    result = match_lines(scans[0], scans[1], DISPLACEMENT, GUESS, CONFIG)
    assert result.refusal == "too_few_points"
    np.testing.assert_array_equal(result.relative_pose, DISPLACEMENT)
    np.testing.assert_array_equal(result.covariance, GUESS)


def test_scans_without_any_line_are_refused_and_finite() -> None:
    points = np.random.default_rng(0).uniform(-8.0, 8.0, (60, 2))
    cloud = line_features(points, np.tile(0.01 * np.eye(2), (60, 1, 1)))
    assert cloud is not None
    bare = replace(cloud, flat=np.zeros(60, dtype=bool))
    result = match_lines(bare, bare, DISPLACEMENT, GUESS, CONFIG)
    assert result.refusal == "too_little_overlap"
    assert np.isfinite(result.relative_pose).all()
    assert np.isfinite(result.covariance).all()


def wall(y: float) -> LineFeatures:
    """A wall along x as it is seen from the origin."""
    x = np.arange(-4.0, 4.0, 0.1)
    covariances = np.tile(1e-4 * np.eye(2), (80, 1, 1))
    lines = line_features(np.column_stack([x, np.full(80, y)]), covariances)
    assert lines is not None
    return lines


def test_a_wall_has_two_sides() -> None:
    """One 0.1 m thick, seen from 1 m before it and from 1.9 m behind it."""
    before, behind = wall(1.0), wall(-1.9)
    result = match_lines(before, behind, np.array([0.0, 3.0, 0.0]), GUESS, CONFIG)
    assert result.figures["overlap"] == 0.0
    same_side = match_lines(before, wall(1.1), np.zeros(3), GUESS, CONFIG)
    assert same_side.figures["overlap"] == 1.0


def test_points_without_a_line_are_nothing_to_pair_with() -> None:
    first, second = wall(2.0), wall(2.0)
    half = replace(first, flat=np.arange(80) < 40)
    result = match_lines(half, second, np.zeros(3), GUESS, CONFIG)
    assert result.figures["overlap"] == pytest.approx(0.5, abs=0.02)


def test_scans_of_different_places_are_refused() -> None:
    rng = np.random.default_rng(6)
    small, large = basin(rng, radius=5.0), basin(rng, radius=12.0)
    first = seen(small, np.array([4.0, 2.5, 0.0]), rng)
    second = seen(large, np.array([-6.0, 5.0, 1.0]), rng)
    result = match_lines(first, second, np.zeros(3), GUESS, CONFIG)
    assert not result.accepted
    assert result.relative_pose.shape == (3,)


def bent_pair() -> tuple[LineFeatures, LineFeatures]:
    """Two scans, the second bent by a motion during the turn that nobody took out."""
    rng = np.random.default_rng(2)
    walls = basin(rng)
    first = seen(walls, STANDPOINT, rng)
    points, covariances = scan(walls, compose(STANDPOINT, DISPLACEMENT), rng)
    share = np.linspace(-0.5, 0.5, len(points))[:, None]
    bent = line_features(transform_points(share * [1.0, 0.0, 0.3], points), covariances)
    assert bent is not None
    return first, bent


@pytest.mark.parametrize(
    ("limit", "values"),
    [("disagreement", (0.3, 0.45)), ("disagreement_angle", (0.05, 0.08))],
)
def test_the_agreement_gates_from_both_sides(limit: str, values: tuple[float, float]) -> None:
    first, bent = bent_pair()
    wide = np.diag([1.0, 1.0, 0.2]) ** 2
    lenient = replace(CONFIG, overlap=0.0, disagreement=10.0, disagreement_angle=10.0)
    outcomes = []
    for value in values:
        config = replace(lenient, **{limit: value})
        outcomes.append(match_lines(first, bent, DISPLACEMENT, wide, config).refusal)
    assert outcomes == ["forward_and_backward_disagree", ""]


def test_the_shift_gate_from_both_sides() -> None:
    shift = match(7).figures["shift"]
    assert match(7, replace(CONFIG, shift=shift)).accepted
    refused = match(7, replace(CONFIG, shift=0.999 * shift))
    assert refused.refusal == "too_far_from_the_guess"


def test_the_overlap_gate_from_both_sides() -> None:
    overlap = match(7).figures["overlap"]
    for value, refusal in ((overlap, ""), (overlap + 1e-9, "too_little_overlap")):
        assert match(7, replace(CONFIG, overlap=value)).refusal == refusal


def test_a_guess_too_far_off_is_noticed() -> None:
    first, second = pair(8)
    certain = np.diag([0.02, 0.02, 0.005]) ** 2
    initial = DISPLACEMENT + np.array([0.3, 0.0, 0.0])
    result = match_lines(first, second, initial, certain, CONFIG)
    assert result.refusal == "too_far_from_the_guess"
    assert result.figures["shift"] > CONFIG.shift


def test_a_guess_may_be_somewhat_worse_than_it_says() -> None:
    """By nearly six of its standard deviations, but not by seven."""
    first, second = pair(8)
    spread = np.diag([0.1, 0.1, 0.025]) ** 2
    refusals = [
        match_lines(
            first, second, DISPLACEMENT + np.array([off, 0.0, 0.0]), spread, CONFIG
        ).refusal
        for off in (0.55, 0.7)
    ]
    assert refusals == ["", "too_far_from_the_guess"]


def test_an_uncertain_guess_widens_the_search() -> None:
    first, second = pair(9)
    far = DISPLACEMENT + np.array([0.9, -0.6, 0.1])
    wide = np.diag([1.0, 1.0, 0.2]) ** 2
    result = match_lines(first, second, far, wide, CONFIG)
    assert result.accepted
    assert np.hypot(*error_of(result)[:2]) < 0.06
