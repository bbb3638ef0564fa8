# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.evaluation.covariance_consistency import consistency

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
