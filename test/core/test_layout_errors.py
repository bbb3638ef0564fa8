# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the errors of scans' layouts are as large as stated, over many turns of a process.

A match sees where the vehicle was in the middle of either turn, whatever it is laid out by.
"""

from dataclasses import dataclass, field

import numpy as np
import pytest

from msss_graphslam.core.scans.motion_feedback import MotionFeedback
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.types import Array

TIME, TURN, TURNS = 100.0, 10, 1500
ASSUMED = np.full(3, 0.03)
NOISE = 1e-3
"""Of the mean twist that a match shows, where it shows any."""


@dataclass
class Told:
    """Errors squared over what was stated of them, turn by turn."""

    reference: list[Array] = field(default_factory=list)
    newest: list[Array] = field(default_factory=list)
    feedback: MotionFeedback = field(
        default_factory=lambda: MotionFeedback(Persistence(TIME, ASSUMED**2))
    )


def walk(deviation: float) -> Array:
    """A Gauss-Markov process (n, 3), a sample a second."""
    rng, decay = np.random.default_rng(3), np.exp(-1.0 / TIME)
    values = np.zeros((TURN * TURNS, 3))
    for number in range(1, len(values)):
        new = np.sqrt(1.0 - decay**2) * deviation * rng.normal(size=3)
        values[number] = decay * values[number - 1] + new
    return values


def flown(deviation: float, noise: Array) -> Told:
    """Match turn after turn; ``noise`` (3,) is that of the matches."""
    true, told, rng = walk(deviation), Told(), np.random.default_rng(4)
    feedback = told.feedback
    for number in range(TURNS - 2):
        turn = true[number * TURN :]
        feedback.predict(float(TURN), np.diag(ASSUMED**2))
        shown = turn[TURN // 2 : 3 * TURN // 2].mean(axis=0) + noise * rng.normal(size=3)
        error = shown
        for _ in range(5):
            doubt = np.diag(noise**2) + 0.25 * feedback.beside_match()
            feedback.update(error, doubt)
            error = 2.0 * shown - feedback.ahead().mean
        if number < 200:
            continue
        widened = (2.0 / (1.0 + feedback.followed())) ** 2
        missed = error - turn[:TURN].mean(axis=0)
        left = turn[TURN : 2 * TURN].mean(axis=0) - feedback.ahead().mean
        told.reference.append(missed**2 / (widened * np.diag(doubt)))
        told.newest.append(left**2 / np.diag(feedback.newest().covariance))
    return told


@pytest.mark.parametrize("deviation", [0.015, 0.03, 0.06])
def test_errors_are_as_large_as_stated_whatever_was_assumed(deviation: float) -> None:
    told = flown(deviation, np.full(3, NOISE))
    assert 0.6 < np.mean(told.reference) < 1.4
    assert 0.6 < np.mean(told.newest) < 1.4


def test_the_noise_of_matches_is_not_taken_for_unsteadiness() -> None:
    told = flown(0.015, np.array([NOISE, 0.01, 0.01]))
    steady, noisy, _ = np.diag(told.feedback.ahead().covariance)
    assert steady < noisy < ASSUMED[1] ** 2
    assert 0.4 < np.mean(told.newest) < 1.4


def test_nothing_is_learned_along_a_bare_wall() -> None:
    """Its matches keep the guess, and say so; that is no steadiness."""
    feedback = MotionFeedback(Persistence(TIME, ASSUMED**2))
    rng = np.random.default_rng(5)
    for _ in range(300):
        feedback.predict(float(TURN), np.diag(ASSUMED**2))
        error = feedback.offset * [0.0, 1.0, 1.0] + 1e-3 * rng.normal(size=3) * [1.0, 0.0, 0.0]
        feedback.update(error, np.diag([1e-6, 100.0, 100.0]))
    known = np.diag(feedback.ahead().covariance)
    np.testing.assert_allclose(known[1:], ASSUMED[1:] ** 2, rtol=1e-3)
    assert known[0] < 0.1 * ASSUMED[0] ** 2


@pytest.mark.parametrize(("deviation", "least"), [(0.005, 1.0), (0.06, 2.0)])
def test_a_guess_is_no_surer_than_assumed(deviation: float, least: float) -> None:
    """It is wider where the vehicle has gone more unsteadily, but a steady one may turn away."""
    told = flown(deviation, np.full(3, NOISE))
    fresh = flown_blind()
    told.feedback.predict(float(TURN), np.diag(ASSUMED**2))
    assert (np.diag(told.feedback.guessed()) > 0.9 * least * fresh).all()


def flown_blind() -> Array:
    """The variances (3,) that follow a turn of which everything was seen, as assumed."""
    feedback = MotionFeedback(Persistence(TIME, ASSUMED**2))
    feedback.predict(float(TURN), np.diag(ASSUMED**2))
    feedback.update(np.zeros(3), NOISE**2 * np.eye(3))
    feedback.predict(float(TURN), np.diag(ASSUMED**2))
    return np.diag(feedback.covariance)


def test_without_a_match_the_newest_turn_is_as_unknown_as_before() -> None:
    feedback = MotionFeedback(Persistence(TIME, ASSUMED**2))
    assert not feedback.beside_match().any()
    feedback.predict(float(TURN), np.diag(ASSUMED**2))
    np.testing.assert_allclose(feedback.after_match(), feedback.beside_match())
    assert (np.diag(feedback.after_match()) >= ASSUMED**2 * 0.999).all()
    np.testing.assert_array_equal(feedback.newest().covariance, feedback.ahead().covariance)


def test_a_bias_that_never_changes_is_not_lost_for_that() -> None:
    """As a gyro's: for all that it changes it could be next to nothing."""
    feedback, rng = MotionFeedback(Persistence(TIME, ASSUMED**2)), np.random.default_rng(5)
    bias, squares = np.array([0.03, -0.03, 0.02]), []
    for _ in range(2000):
        feedback.predict(float(TURN), np.diag(ASSUMED**2))
        ahead = feedback.ahead()
        squares.append((ahead.mean - bias) ** 2 / np.diag(ahead.covariance))
        doubt = np.diag(np.full(3, NOISE**2)) + 0.25 * feedback.beside_match()
        feedback.update(bias + NOISE * rng.normal(size=3), doubt)
    assert np.mean(squares[1000:]) < 1.0
