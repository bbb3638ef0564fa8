# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from synthetic_scans import basin, corridor, scan

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import between, compose, inverse, wrap
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.spic import match
from msss_graphslam.core.types import Array

PLACE = np.array([7.8, 0.0, 1.6])
STEP = np.array([1.2, 0.1, 0.05])
GUESS = STEP + np.array([0.2, -0.1, 0.02])
DEVIATIONS = np.array([0.25, 0.15, 0.05])
COVARIANCE = np.diag(DEVIATIONS**2)

Scan = tuple[Array, Array]


def two_scans(walls: list[Array], step: Array, rng: np.random.Generator) -> tuple[Scan, Scan]:
    place = PLACE if len(walls) > 1 else np.array([0.0, 0.3, 0.1])
    return scan(walls, place, rng), scan(walls, compose(place, step), rng)


def error_of(result: MatchResult, truth: Array) -> Array:
    error = result.relative_pose - truth
    return np.array([error[0], error[1], float(wrap(error[2]))])


def trial(seed: int, walls: list[Array] | None = None) -> tuple[MatchResult, Array]:
    rng = np.random.default_rng(seed)
    reference, current = two_scans(walls or basin(rng), STEP, rng)
    initial = STEP + rng.normal(0.0, 0.8 * DEVIATIONS)
    result = match(*reference, *current, initial, COVARIANCE, Matching())
    return result, error_of(result, STEP)


def test_finds_the_displacement_of_consecutive_scans() -> None:
    results, errors = zip(*(trial(seed) for seed in range(20)), strict=True)
    assert all(result.accepted for result in results)
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert (rms < [0.05, 0.06, 0.008]).all()
    assert (np.abs(np.mean(errors, axis=0)) < [0.015, 0.02, 0.003]).all()


def test_covariance_is_of_the_size_of_the_errors() -> None:
    trials = [trial(seed) for seed in range(20)]
    squared = [error @ np.linalg.solve(result.covariance, error) for result, error in trials]
    assert 1.0 < np.mean(squared) < 9.0


def test_corridor_is_uncertain_along_and_sharp_across() -> None:
    squared = []
    for seed in range(10):
        result, error = trial(seed, corridor())
        deviations = np.sqrt(np.diag(result.covariance))
        assert deviations[0] > 0.2
        assert deviations[1] < 0.15
        assert deviations[2] < 0.01
        squared.append(error @ np.linalg.solve(result.covariance, error))
    assert np.mean(squared) < 9.0


def test_identical_scans_stay_where_they_are() -> None:
    rng = np.random.default_rng(1)
    points, covariances = scan(basin(rng), PLACE, rng)
    result = match(points, covariances, points, covariances, np.zeros(3), COVARIANCE, Matching())
    np.testing.assert_array_equal(result.relative_pose, np.zeros(3))


def test_exact_copy_is_found_exactly() -> None:
    rng = np.random.default_rng(2)
    points, covariances = scan(basin(rng), PLACE, rng, outliers=0.0)
    initial = np.array([0.03, -0.02, 0.004])
    result = match(points, covariances, points, covariances, initial, COVARIANCE, Matching())
    np.testing.assert_allclose(result.relative_pose, np.zeros(3), atol=1e-6)
    assert result.figures["overlap"] == 1.0


def test_swapped_scans_give_the_inverse_displacement() -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        reference, current = two_scans(basin(rng), STEP, rng)
        there = match(*reference, *current, STEP, COVARIANCE, Matching())
        back = match(*current, *reference, inverse(STEP), COVARIANCE, Matching())
        difference = between(there.relative_pose, inverse(back.relative_pose))
        assert np.hypot(*difference[:2]) < 0.12
        assert abs(difference[2]) < 0.015


def test_frame_of_the_reference_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    (points, covariances), current = two_scans(basin(rng), STEP, rng)
    turned = np.array([[0.0, -1.0], [1.0, 0.0]])
    first = match(points, covariances, *current, STEP, 0.01 * np.eye(3), Matching())
    second = match(
        points @ turned.T,
        turned @ covariances @ turned.T,
        *current,
        compose(np.array([0.0, 0.0, np.pi / 2]), STEP),
        0.01 * np.eye(3),
        Matching(),
    )
    back = compose(np.array([0.0, 0.0, -np.pi / 2]), second.relative_pose)
    np.testing.assert_allclose(back, first.relative_pose, atol=1e-9)


@pytest.mark.parametrize(("offset", "angle"), [(0.3, 0.1), (0.6, 0.2), (1.0, 0.2)])
def test_basin_of_convergence(offset: float, angle: float) -> None:
    rng = np.random.default_rng(4)
    reference, current = two_scans(basin(rng), STEP, rng)
    covariance = np.diag([offset, offset, angle]) ** 2
    for eighth in range(8):
        direction = eighth * np.pi / 4.0
        unit = np.array([np.cos(direction), np.sin(direction), (-1.0) ** eighth])
        guess = STEP + unit * [offset, offset, angle]
        result = match(*reference, *current, guess, covariance, Matching())
        error = error_of(result, STEP)
        assert result.accepted
        assert np.hypot(*error[:2]) < 0.1
        assert abs(error[2]) < 0.02


def test_another_place_is_refused() -> None:
    elsewhere = np.array([-7.0, 2.0, 1.6])
    for seed in range(8):
        rng = np.random.default_rng(seed)
        walls = basin(rng)
        reference, current = scan(walls, PLACE, rng), scan(walls, elsewhere, rng)
        result = match(*reference, *current, np.zeros(3), np.eye(3) * 0.25, Matching())
        assert result.refusal in {
            "too_little_overlap",
            "not_converged",
            "too_far_from_the_guess",
        }


def accepted_case() -> tuple[Scan, Scan, MatchResult]:
    rng = np.random.default_rng(5)
    reference, current = two_scans(basin(rng), STEP, rng)
    return reference, current, match(*reference, *current, GUESS, COVARIANCE, Matching())


@pytest.mark.parametrize(
    ("parameter", "figure", "refusal"),
    [("overlap", "overlap", "too_little_overlap"), ("shift", "shift", "too_far_from_the_guess")],
)
@pytest.mark.parametrize("side", [-1, 1])
def test_limits_from_both_sides(parameter: str, figure: str, refusal: str, side: int) -> None:
    reference, current, result = accepted_case()
    config = replace(Matching(), **{parameter: result.figures[figure] + side * 1e-6})
    again = match(*reference, *current, GUESS, COVARIANCE, config)
    refused = side > 0 if parameter == "overlap" else side < 0
    assert again.refusal == (refusal if refused else "")
    np.testing.assert_array_equal(again.relative_pose, result.relative_pose)


@pytest.mark.parametrize(("missing", "refusal"), [(0, ""), (1, "not_converged")])
def test_iterations_from_both_sides(missing: int, refusal: str) -> None:
    reference, current, result = accepted_case()
    config = replace(Matching(), iterations=int(result.figures["iterations"]) - missing)
    again = match(*reference, *current, GUESS, COVARIANCE, config)
    assert again.refusal == refusal


def iterations(smallest_step: float, smallest_turn: float) -> float:
    reference, current, _ = accepted_case()
    config = replace(Matching(), smallest_step=smallest_step, smallest_turn=smallest_turn)
    return match(*reference, *current, GUESS, COVARIANCE, config).figures["iterations"]


def test_both_the_step_and_the_turn_must_have_died_out() -> None:
    loose = iterations(0.1, 0.1)
    assert iterations(1e-9, 0.1) > loose
    assert iterations(0.1, 1e-9) > loose


def test_a_guess_said_to_be_certain_is_no_error() -> None:
    rng = np.random.default_rng(9)
    reference, current = two_scans(basin(rng), np.zeros(3), rng)
    result = match(*reference, *current, np.zeros(3), np.zeros((3, 3)), Matching())
    assert result.accepted


def test_an_almost_straight_wall_is_refused() -> None:
    x = np.linspace(-5.0, 5.0, 60)
    points = np.column_stack([x, 3.0 + 1e-5 * x**2])
    covariances = np.broadcast_to(0.01 * np.eye(2), (60, 2, 2))
    initial = np.array([0.1, 0.05, 0.0])
    result = match(points, covariances, points, covariances, initial, COVARIANCE, Matching())
    assert result.refusal == "degenerate_geometry"


@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_too_few_points_are_refused(count: int) -> None:
    rng = np.random.default_rng(6)
    points, covariances = scan(basin(rng), PLACE, rng)
    few = points[:count], covariances[:count]
    for pair in ((*few, points, covariances), (points, covariances, *few), (*few, *few)):
        result = match(*pair, STEP, COVARIANCE, Matching())
        assert result.refusal == "too_few_points"
        np.testing.assert_array_equal(result.relative_pose, STEP)


def test_scans_that_do_not_meet_are_refused() -> None:
    rng = np.random.default_rng(7)
    points, covariances = scan(basin(rng), PLACE, rng)
    far = np.array([500.0, 0.0, 0.0])
    result = match(points, covariances, points, covariances, far, COVARIANCE, Matching())
    assert result.refusal == "too_few_pairs"


@pytest.mark.parametrize(
    "points",
    [
        np.column_stack([np.linspace(-5.0, 5.0, 40), np.full(40, 3.0)]),
        np.column_stack([np.linspace(-5.0, 5.0, 40), np.linspace(1.0, 4.0, 40)]),
        np.full((40, 2), 3.0),
        np.zeros((40, 2)),
    ],
    ids=["wall ahead", "slanted wall", "one place", "at the sonar"],
)
@pytest.mark.parametrize("variance", [0.01, 0.0], ids=["uncertain", "without variance"])
def test_degenerate_scans_are_refused_or_uncertain(points: Array, variance: float) -> None:
    covariances = np.broadcast_to(variance * np.eye(2), (40, 2, 2))
    initial = np.array([0.1, 0.05, 0.01])
    result = match(points, covariances, points, covariances, initial, COVARIANCE, Matching())
    largest_deviation = np.sqrt(np.linalg.eigvalsh(result.covariance)[-1])
    assert not result.accepted or largest_deviation > 1.0
    assert np.isfinite(result.relative_pose).all()


def test_inputs_are_left_as_they_were() -> None:
    rng = np.random.default_rng(8)
    reference, current = two_scans(basin(rng), STEP, rng)
    initial = STEP.copy()
    inputs = (*reference, *current, initial)
    before = [array.copy() for array in inputs]
    match(*inputs, COVARIANCE, Matching())
    for array, copy in zip(inputs, before, strict=True):
        np.testing.assert_array_equal(array, copy)
