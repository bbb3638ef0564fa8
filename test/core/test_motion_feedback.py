# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.scans.motion_feedback import (
    MotionFeedback,
    Persistence,
    offset_motion,
    persistence_of,
)
from msss_graphslam.core.types import Array

TIME = 100.0
LIKE = (1.0 - np.exp(-1.0)) ** 2 / (2.0 * np.exp(-1.0))
"""Correlation of a process' means over two turns, each as long as its correlation time."""
STATIONARY = np.diag([0.03, 0.01, 0.002]) ** 2
SLOW = Persistence(TIME, np.diag(STATIONARY))


def test_starts_with_what_dead_reckoning_says_of_itself() -> None:
    feedback = MotionFeedback(SLOW)
    feedback.predict(10.0, STATIONARY)
    np.testing.assert_array_equal(feedback.offset, np.zeros(3))
    np.testing.assert_array_equal(feedback.covariance, STATIONARY)


def test_the_stationary_covariance_stays() -> None:
    feedback = MotionFeedback(SLOW)
    for _ in range(50):
        feedback.predict(10.0, STATIONARY)
    np.testing.assert_allclose(feedback.covariance, STATIONARY)


def test_update_is_the_product_of_two_gaussians() -> None:
    feedback = MotionFeedback(SLOW)
    feedback.predict(10.0, STATIONARY)
    seen, doubt = np.array([0.04, -0.01, 0.001]), np.diag([0.02, 0.02, 0.001]) ** 2
    feedback.update(seen, doubt)
    information = np.linalg.inv(STATIONARY) + np.linalg.inv(doubt)
    np.testing.assert_allclose(feedback.covariance, np.linalg.inv(information))
    np.testing.assert_allclose(
        feedback.offset, np.linalg.solve(information, np.linalg.solve(doubt, seen))
    )


def test_a_sharp_word_is_believed_and_a_dull_one_is_not() -> None:
    for deviation, share in ((1e-6, 1.0), (1e3, 0.0)):
        feedback = MotionFeedback(SLOW)
        feedback.predict(10.0, STATIONARY)
        feedback.update(np.array([0.05, 0.02, 0.003]), deviation**2 * np.eye(3))
        np.testing.assert_allclose(
            feedback.offset, share * np.array([0.05, 0.02, 0.003]), atol=1e-6
        )


def test_what_was_learned_fades_with_the_correlation_time() -> None:
    feedback = MotionFeedback(SLOW)
    feedback.predict(10.0, STATIONARY)
    feedback.update(np.array([0.025, 0.0, 0.0]), 1e-12 * np.eye(3))
    learned = feedback.offset[0]
    feedback.predict(TIME, STATIONARY)
    np.testing.assert_allclose(feedback.offset[0], learned * LIKE)
    np.testing.assert_allclose(
        feedback.covariance, (1.0 - LIKE**2) * STATIONARY, rtol=1e-3, atol=1e-9
    )


def test_what_is_new_in_every_turn_does_not_persist() -> None:
    feedback = MotionFeedback(Persistence(TIME, np.array([0.03**2, 0.005**2, 0.0])))
    feedback.predict(10.0, STATIONARY)
    seen = np.array([0.025, 0.008, 0.003])
    feedback.update(seen, 1e-12 * np.eye(3))
    feedback.predict(TIME, STATIONARY)
    kept = LIKE * np.array([1.0, 0.25, 0.0])
    np.testing.assert_allclose(feedback.offset, kept * seen, rtol=1e-4, atol=1e-12)
    np.testing.assert_allclose(
        np.diag(feedback.covariance), (1.0 - kept**2) * np.diag(STATIONARY), rtol=1e-3
    )


def test_more_slow_error_than_there_is_error_persists_whole() -> None:
    persistence = Persistence(TIME, np.ones(3))
    np.testing.assert_allclose(persistence.over(TIME, STATIONARY), LIKE)
    np.testing.assert_allclose(persistence.over(TIME, np.zeros((3, 3))), LIKE)


def test_persistence_follows_the_parameters_of_dead_reckoning() -> None:
    persistence = persistence_of(DeadReckoning())
    blind = np.diag([0.2, 0.2, 0.05]) ** 2
    sensed = np.diag([0.03, 0.01, 0.0005]) ** 2
    np.testing.assert_allclose(persistence.over(10.0, sensed), 0.936, rtol=1e-3)
    assert (persistence.over(10.0, blind) < 0.05).all()


def test_many_words_converge_on_a_constant_error() -> None:
    rng = np.random.default_rng(0)
    error, doubt = np.array([0.03, -0.008, 0.001]), np.diag([0.01, 0.01, 0.001])
    feedback = MotionFeedback(Persistence(1e6, np.diag(STATIONARY)))
    for _ in range(400):
        feedback.predict(10.0, STATIONARY)
        feedback.update(error + doubt @ rng.normal(size=3), doubt**2)
    np.testing.assert_allclose(feedback.offset, error, atol=0.002)
    assert np.linalg.eigvalsh(feedback.covariance)[0] > 0.0


def surprised(times: float, turns: int, doubt: float = 1e-3) -> MotionFeedback:
    """A feedback after turns whose twist errors are so many deviations off what was expected."""
    feedback, signs = MotionFeedback(SLOW), np.random.default_rng(0).choice([-1.0, 1.0], turns)
    for sign in signs:
        feedback.predict(10.0, STATIONARY)
        spread = feedback.covariance + doubt**2 * np.eye(3)
        off = times * sign * np.sqrt(np.diag(spread))
        feedback.update(feedback.offset + off, doubt**2 * np.eye(3))
    feedback.predict(10.0, STATIONARY)
    return feedback


def test_a_speed_that_surprises_is_taken_for_more_unsteady() -> None:
    feedback = surprised(2.0, 5)
    assert (feedback.unsteadiness[:2] > 2.0).all()
    assert feedback.unsteadiness[2] == 1.0
    calm = surprised(1.0, 5)
    grown = np.diag(feedback.covariance)[:2] / np.diag(calm.covariance)[:2]
    assert (grown > 1.5).all()


@pytest.mark.parametrize("times", [0.0, 0.5, 1.0])
def test_a_speed_as_steady_as_stated_leaves_what_is_stated(times: float) -> None:
    np.testing.assert_allclose(surprised(times, 30).unsteadiness, np.ones(3))


def test_unsteadiness_ends_when_the_surprises_do() -> None:
    feedback = surprised(2.0, 5)
    for _ in range(60):
        feedback.predict(10.0, STATIONARY)
        feedback.update(feedback.offset, 1e-6 * np.eye(3))
    np.testing.assert_allclose(feedback.unsteadiness, np.ones(3), atol=0.05)


def test_turns_that_show_nothing_say_nothing_of_unsteadiness() -> None:
    assert (surprised(3.0, 10, doubt=30.0).unsteadiness < 1.001).all()


def test_what_persists_does_not_depend_on_unsteadiness() -> None:
    feedback = surprised(2.0, 5)
    before = feedback.offset
    feedback.predict(TIME, STATIONARY)
    np.testing.assert_allclose(feedback.offset, LIKE * before)


def test_a_match_that_takes_the_place_of_another_surprises_once() -> None:
    feedback, once = MotionFeedback(SLOW), MotionFeedback(SLOW)
    for each, words in ((feedback, 4), (once, 1)):
        each.predict(10.0, STATIONARY)
        for _ in range(words):
            each.update(np.array([0.06, 0.0, 0.0]), 1e-6 * np.eye(3))
        each.predict(10.0, STATIONARY)
    np.testing.assert_array_equal(feedback.unsteadiness, once.unsteadiness)


def winding(count: int) -> tuple[Array, Array]:
    """A motion (b, 3) from the origin and the uneven times (b,) of its poses [s]."""
    rng = np.random.default_rng(1)
    elapsed = np.concatenate([[0.0], np.cumsum(rng.uniform(0.02, 0.3, count - 1))])
    motion = [np.zeros(3)]
    for step in rng.normal(0.0, [0.02, 0.01, 0.05], (count - 1, 3)):
        motion.append(compose(motion[-1], step))
    return np.array(motion), elapsed


def test_offset_is_composed_with_every_step_as_in_equation_14() -> None:
    motion, elapsed = winding(60)
    offset = np.array([0.05, -0.03, 0.02])
    pose, expected = np.zeros(3), [np.zeros(3)]
    steps = between(motion[:-1], motion[1:])
    for step, duration in zip(steps, np.diff(elapsed), strict=True):
        pose = compose(pose, compose(step, offset * duration))
        expected.append(pose)
    result = offset_motion(motion, elapsed, offset)
    np.testing.assert_allclose(result[:, :2], np.array(expected)[:, :2], atol=1e-12)
    turned = np.exp(1j * result[:, 2])
    np.testing.assert_allclose(turned, np.exp(1j * np.array(expected)[:, 2]), atol=1e-12)


def test_no_offset_leaves_the_motion() -> None:
    motion, elapsed = winding(30)
    np.testing.assert_allclose(offset_motion(motion, elapsed, np.zeros(3)), motion, atol=1e-14)


def test_one_pose_does_not_move() -> None:
    moved = offset_motion(np.zeros((1, 3)), np.zeros(1), np.array([1.0, 1.0, 1.0]))
    np.testing.assert_array_equal(moved, np.zeros((1, 3)))


def processes(seconds: float, count: int = 4000) -> Array:
    """Gauss-Markov processes (count, n) of deviation 0.03, a sample a second."""
    rng, decay = np.random.default_rng(2), np.exp(-1.0 / TIME)
    values = [0.03 * rng.normal(size=count)]
    for noise in rng.normal(size=(int(seconds) - 1, count)):
        values.append(decay * values[-1] + 0.03 * np.sqrt(1.0 - decay**2) * noise)
    return np.array(values).T


@pytest.mark.parametrize("turn", [10, 50])
def test_turns_are_as_much_alike_as_those_of_a_process(turn: int) -> None:
    walks = processes(2 * turn)
    both = walks[:, :turn].mean(axis=1), walks[:, turn:].mean(axis=1)
    kept = Persistence(TIME, np.full(3, 0.03**2)).over(float(turn), 0.03**2 * np.eye(3))
    np.testing.assert_allclose(kept, np.corrcoef(*both)[0, 1], atol=0.03)


@pytest.mark.parametrize("known", [0.0, 0.01, 0.03])
@pytest.mark.parametrize("seconds", [20, 300])
def test_the_mean_of_an_error_returns_to_what_it_is_without_knowledge(
    known: float, seconds: int
) -> None:
    walks = processes(seconds)
    decay = np.exp(-np.arange(seconds) / TIME)
    begun = walks - walks[:, :1] * (1.0 - known / 0.03) * decay
    stated = Persistence(TIME, np.full(3, 0.03**2)).mean_over(seconds, known**2 * np.eye(3))
    np.testing.assert_allclose(np.diag(stated), np.var(begun.mean(axis=1)), rtol=0.15)


def test_an_instant_has_the_error_of_its_beginning() -> None:
    spread = 1e-6 * np.eye(3)
    for seconds in (0.0, 0.09, 0.11):
        np.testing.assert_allclose(SLOW.mean_over(seconds, spread), spread, rtol=0.1, atol=1e-6)


@pytest.mark.parametrize("seen", [0.02, 0.06])
def test_the_turn_ahead_is_less_known_than_the_one_that_was_seen(seen: float) -> None:
    feedback = MotionFeedback(SLOW)
    assert not feedback.ahead().covariance.any()
    feedback.predict(10.0, STATIONARY)
    feedback.update(np.array([seen, 0.0, 0.0]), 1e-8 * np.eye(3))
    ahead = feedback.ahead()
    feedback.predict(10.0, STATIONARY)
    np.testing.assert_allclose(ahead.mean, feedback.offset)
    np.testing.assert_allclose(ahead.covariance, feedback.covariance)
    grown = STATIONARY[0, 0] * feedback.unsteadiness[0]
    assert 0.1 < ahead.covariance[0, 0] / grown < 0.15


@pytest.mark.parametrize(("deviation", "share"), [(1e-6, 0.936), (1e3, 0.0)])
def test_the_next_turn_follows_what_was_seen(deviation: float, share: float) -> None:
    feedback = MotionFeedback(SLOW)
    np.testing.assert_array_equal(feedback.followed(), np.zeros(3))
    feedback.predict(10.0, STATIONARY)
    feedback.update(np.zeros(3), deviation**2 * np.eye(3))
    np.testing.assert_allclose(feedback.followed(), share, atol=2e-3)


def test_edges_of_unseen_turns_add_up_to_what_the_process_does() -> None:
    """Two minutes without a wall; independent turns would be three times too sure."""
    feedback, total = MotionFeedback(SLOW), 0.0
    for _ in range(12):
        feedback.predict(10.0, STATIONARY)
        total += 100.0 * feedback.coherent()[0, 0]
    true = float(np.var(processes(120).sum(axis=1)))
    assert total == pytest.approx(true, rel=0.2)
    assert total > 6.0 * 12 * 100.0 * STATIONARY[0, 0] / 1.2


def test_edges_of_turns_that_were_seen_are_independent() -> None:
    feedback = MotionFeedback(SLOW)
    for _ in range(20):
        feedback.predict(10.0, STATIONARY)
        shared = feedback.coherent()
        feedback.update(np.zeros(3), 1e-9 * np.eye(3))
    np.testing.assert_allclose(shared, feedback.ahead().covariance, rtol=0.05, atol=1e-8)


def test_what_was_seen_in_one_direction_is_still_shared_in_the_other() -> None:
    feedback = MotionFeedback(SLOW)
    for _ in range(20):
        feedback.predict(10.0, STATIONARY)
        shared = np.diag(feedback.coherent()) / np.diag(feedback.covariance)
        feedback.update(np.zeros(3), np.diag([1e4, 1e-9, 1e-9]))
    assert shared[0] > 5.0
    np.testing.assert_allclose(shared[1:], 1.0, atol=0.1)


def test_an_error_that_is_excluded_stays_so() -> None:
    feedback = MotionFeedback(SLOW)
    for _ in range(3):
        feedback.predict(10.0, np.zeros((3, 3)))
        feedback.update(np.ones(3), np.eye(3))
        np.testing.assert_array_equal(feedback.coherent(), np.zeros((3, 3)))
        np.testing.assert_array_equal(feedback.ahead().covariance, np.zeros((3, 3)))
        np.testing.assert_array_equal(feedback.offset, np.zeros(3))
