# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.errors import UserError
from msss_graphslam.simulation.processes import GaussMarkov
from msss_graphslam.simulation.streams import stream


def test_a_source_repeats_and_differs_from_others_and_from_other_seeds() -> None:
    draws = stream(7, "speckle").random(5)
    np.testing.assert_array_equal(draws, stream(7, "speckle").random(5))
    assert not np.any(draws == stream(7, "specks").random(5))
    assert not np.any(draws == stream(8, "speckle").random(5))


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(UserError, match="seed = -1"):
        stream(-1, "speckle")


@pytest.mark.parametrize("lag", [0.0, 3.0])
def test_gauss_markov_has_its_deviation_and_correlation_time(lag: float) -> None:
    process = GaussMarkov(2.0, 60.0, lag)
    samples = process.sample(np.random.default_rng(1), 400_000, 1.0)
    assert np.std(samples) == pytest.approx(2.0, rel=0.05)
    correlation = np.mean(samples[:-60] * samples[60:]) / np.var(samples)
    assert correlation == pytest.approx(np.exp(-1.0), abs=0.06)


@pytest.mark.parametrize("lag", [0.0, 3.0])
def test_gauss_markov_is_stationary_from_its_first_sample(lag: float) -> None:
    process = GaussMarkov(2.0, 60.0, lag)
    first = [process.sample(np.random.default_rng(k), 2, 1.0)[0] for k in range(2000)]
    assert np.std(first) == pytest.approx(2.0, rel=0.08)


def test_gauss_markov_from_zero_grows_with_the_root_of_time() -> None:
    process = GaussMarkov(6.0, 500.0)
    runs = np.array(
        [process.sample(np.random.default_rng(k), 21, 1.0, from_zero=True) for k in range(2000)]
    )
    assert not runs[:, 0].any()
    assert np.std(runs[:, 20]) == pytest.approx(6.0 * np.sqrt(1 - np.exp(-2 * 20 / 500)), rel=0.08)


def test_a_lag_takes_the_white_noise_out_of_the_rate() -> None:
    def rate(lag: float) -> float:
        samples = GaussMarkov(1.0, 60.0, lag).sample(np.random.default_rng(2), 50_000, 0.02)
        return float(np.std(np.diff(samples)))

    assert rate(3.0) < 0.1 * rate(0.0)
