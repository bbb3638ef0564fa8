# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.evaluation.covariance_consistency import consistency, step_consistency

COVARIANCE = np.array([[0.04, 0.01, 0.002], [0.01, 0.09, 0.0], [0.002, 0.0, 0.0004]])


def samples(count, scale):
    errors = np.random.default_rng(11).multivariate_normal(np.zeros(3), COVARIANCE, count)
    return errors, np.tile(scale**2 * COVARIANCE, (count, 1, 1))


def test_by_hand():
    errors = np.array([[1.0, 0.0], [0.0, 2.0]])
    result = consistency(errors, np.array([np.eye(2), 4.0 * np.eye(2)]))
    assert result.mean == pytest.approx((1.0 + 1.0) / 4.0)
    assert result.samples == 2


def test_honest_covariances_lie_in_the_band():
    result = consistency(*samples(400, 1.0))
    assert result.honest
    assert 0.9 < result.low < 1.0 < result.high < 1.1


@pytest.mark.parametrize(("scale", "side"), [(0.8, 1), (1.25, -1)])
def test_overconfident_and_timid_covariances_do_not(scale, side):
    result = consistency(*samples(400, scale))
    assert not result.honest
    assert np.sign(result.mean - 1.0) == side
    assert result.mean == pytest.approx(scale**-2, rel=0.1)


def test_the_band_holds_95_percent_of_honest_runs():
    generator = np.random.default_rng(5)
    runs = [
        consistency(generator.normal(size=(20, 3)), np.tile(np.eye(3), (20, 1, 1))).honest
        for _ in range(400)
    ]
    assert 0.92 < np.mean(runs) < 0.98


def steps_of(scale, missions=20, steps=50, alike=0.9, seed=0):
    """Errors (m, s, 3) that change slowly within a mission."""
    generator = np.random.default_rng(seed)
    errors = [generator.multivariate_normal(np.zeros(3), COVARIANCE, missions)]
    for _ in range(steps - 1):
        new = generator.multivariate_normal(np.zeros(3), COVARIANCE, missions)
        errors.append(alike * errors[-1] + np.sqrt(1.0 - alike**2) * new)
    return np.stack(errors, axis=1), np.tile(scale**2 * COVARIANCE, (missions, steps, 1, 1))


def test_steps_of_honest_missions_lie_in_the_band_however_alike_they_are():
    shares = [step_consistency(*steps_of(1.0, seed=seed)).inside for seed in range(40)]
    assert 0.9 < np.mean(shares) < 0.99


@pytest.mark.parametrize(("scale", "side"), [(0.6, "above"), (1.6, "below")])
def test_steps_of_others_do_not(scale, side):
    result = step_consistency(*steps_of(scale))
    assert getattr(result, side) > 0.95
    assert result.inside + result.above + result.below == pytest.approx(1.0)
    assert result.mean == pytest.approx(scale**-2, rel=0.3)


def test_the_band_is_that_of_the_missions_alone():
    few, many = steps_of(1.0, steps=5), steps_of(1.0, steps=100)
    assert step_consistency(*few).low == step_consistency(*many).low
    wide = step_consistency(*steps_of(1.0, missions=3))
    assert wide.low < step_consistency(*few).low < 1.0 < step_consistency(*few).high < wide.high


def test_a_step_by_hand():
    errors = np.array([[[1.0, 0.0], [2.0, 0.0]], [[1.0, 2.0], [0.0, 0.0]]])
    result = step_consistency(errors, np.tile(np.eye(2), (2, 2, 1, 1)))
    assert result.mean == pytest.approx((1.5 + 1.0) / 2.0)
    assert result.missions == 2


@pytest.mark.parametrize("shape", [(0, 4, 3), (4, 0, 3)])
def test_nothing_is_no_consistency(shape):
    with pytest.raises(ValueError, match="no mission or no step"):
        step_consistency(np.zeros(shape), np.zeros((*shape, 3)))
