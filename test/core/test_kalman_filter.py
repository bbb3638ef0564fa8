# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numerical_derivatives import jacobian
from textbook_filter import TextbookFilter

from msss_graphslam.config.groups import DeadReckoning
from msss_graphslam.core.reckoning.kalman_filter import (
    VELOCITY_ERROR,
    YAW,
    KalmanFilter,
    Z,
    transition,
)
from msss_graphslam.core.reckoning.paired_covariance import SIZE
from msss_graphslam.core.types import Array

BIAS = 9
CONFIG = DeadReckoning()
tilts = st.floats(-1.2, 1.2)
small = st.floats(-0.5, 0.5)


def started(attitude: Array | None = None) -> KalmanFilter:
    angles = np.zeros(3) if attitude is None else attitude
    return KalmanFilter(CONFIG, -2.0, angles.tolist(), CONFIG.compass_noise**2)


def used(steps: int = 30) -> KalmanFilter:
    """A filter with correlations between all of its states."""
    rng = np.random.default_rng(3)
    ekf = started(np.array([0.05, -0.04, 1.0]))
    for _ in range(steps):
        ekf.predict(0.04, rng.normal(0.0, 0.1, 3).tolist(), CONFIG.gyro_noise)
        ekf.update(3, 0.01 * rng.normal(), 1e-4)
        ekf.update_heading(0.01 * rng.normal(), 1e-4, 0.01)
    return ekf


def assert_covariance(covariance: Array) -> None:
    np.testing.assert_allclose(covariance, covariance.T, atol=1e-12)
    assert np.linalg.eigvalsh(covariance)[0] > -1e-12


@given(
    st.tuples(small, small, small, tilts, tilts, st.floats(-3.0, 3.0), small, small, small, small),
    st.tuples(small, small, small),
    st.floats(0.001, 1.0),
)
@settings(max_examples=50)
def test_jacobian_is_the_derivative_of_the_transition(
    state: tuple[float, ...], rates: tuple[float, ...], interval: float
) -> None:
    def predicted(at: Array) -> Array:
        return np.array(transition(at.tolist(), 0.1, rates, interval, (0.7, 0.9))[0])

    _, parts = transition(state, 0.1, rates, interval, (0.7, 0.9))
    F = np.eye(SIZE)
    F[:3, 3:6] = interval * np.array(parts.position_by_attitude)
    F[:3, 6:9] = interval * np.array(parts.position_by_velocity)
    F[3:6, 3:6] += interval * np.array(parts.attitude_by_attitude)
    F[6:9, 6:9] *= parts.velocity_decay
    np.testing.assert_allclose(F, jacobian(predicted, np.array(state)), rtol=1e-6, atol=1e-7)
    assert parts.compass_decay == 0.9


def test_a_level_vehicle_moves_along_its_heading() -> None:
    state = [0.0] * SIZE
    state[YAW] = 0.5 * np.pi
    moved, _ = transition(state, 0.2, (0.0, 0.0, 0.3), 2.0, (1.0, 1.0))
    np.testing.assert_allclose(moved[:6], [0.0, 0.4, 0.0, 0.0, 0.0, 0.5 * np.pi + 0.6], atol=1e-15)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("drift", [0.0, 0.5])
def test_the_filter_is_the_textbook_s_through_a_dive(seed: int, drift: float) -> None:
    """Whatever comes, in whatever order: the blocks lose nothing of the whole covariance."""
    rng = np.random.default_rng(seed)
    ekf = started(np.array([0.3, -0.2, 2.0]))
    book = TextbookFilter(CONFIG, np.array(ekf.state), ekf.covariance)
    for _ in range(200):
        interval, rates = float(rng.uniform(0.001, 2.0)), rng.normal(0.0, 0.05, 3)
        ekf.predict(interval, rates.tolist(), 0.01, drift)
        book.predict(interval, rates, 0.01, drift)
        index, difference = int(rng.integers(2, SIZE)), float(0.01 * rng.normal())
        variance, gain = float(10.0 ** rng.uniform(-5, 0)), float(rng.uniform())
        if rng.uniform() < 0.05:
            ekf.open(index, 0.3)
            book.covariance[index, index] += 0.09
        for one in (ekf, book):
            one.update(index, difference, variance)
            one.update_heading(difference, variance, gain)
    np.testing.assert_allclose(ekf.state, book.state, rtol=1e-7, atol=1e-9)
    scale = np.sqrt(np.diag(book.covariance))
    away = (ekf.covariance - book.covariance) / np.outer(scale, scale)
    np.testing.assert_allclose(away, 0.0, atol=1e-6)


def test_changed_parameters_leave_the_velocity_as_it_is() -> None:
    ekf = used()
    before = ekf.velocity
    ekf.configure(replace(CONFIG, surge_speed=0.4))
    assert ekf.velocity == pytest.approx(before, abs=1e-15)
    ekf.predict(2.0, (0.0, 0.0, 0.0), CONFIG.gyro_noise)
    assert ekf.velocity[0] > before[0]


def test_a_copy_goes_its_own_way() -> None:
    ekf = used()
    state, covariance = ekf.state.copy(), ekf.covariance
    other = ekf.copy()
    other.predict(0.1, (0.0, 0.0, 0.1), 1.0)
    other.update(Z, 0.5, 0.1)
    other.update_heading(0.5, 0.1, 0.5)
    other.open(3, 1.0)
    assert ekf.state == state
    np.testing.assert_array_equal(ekf.covariance, covariance)


def test_covariance_stays_symmetric_and_positive() -> None:
    rng = np.random.default_rng(0)
    ekf = started()
    for step in range(3000):
        ekf.predict(rng.uniform(0.0, 0.1), rng.normal(0.0, 0.3, 3).tolist(), CONFIG.gyro_noise)
        ekf.update(int(rng.integers(2, 9)), 0.01 * rng.normal(), 10.0 ** rng.uniform(-6, 0))
        ekf.update_heading(0.01 * rng.normal(), 1e-4, float(rng.uniform()))
        if step % 500 == 0:
            ekf.open(YAW, 0.5)
    assert_covariance(ekf.covariance)
    assert np.isfinite(ekf.state).all()


@pytest.mark.parametrize("index", range(2, SIZE))
def test_update_equals_the_textbook(index: int) -> None:
    ekf = used()
    book = TextbookFilter(CONFIG, np.array(ekf.state), ekf.covariance)
    ekf.update(index, 0.2, 0.03)
    book.update(index, 0.2, 0.03)
    np.testing.assert_allclose(ekf.state, book.state, atol=1e-14)
    np.testing.assert_allclose(ekf.covariance, book.covariance, atol=1e-14)


@pytest.mark.parametrize("gain", [0.0, 0.01, 0.3, 1.0])
def test_heading_update_is_the_textbook_for_any_gain(gain: float) -> None:
    """Joseph's form holds for gains that are not optimal, too."""
    ekf = used()
    book = TextbookFilter(CONFIG, np.array(ekf.state), ekf.covariance)
    ekf.update_heading(-0.1, 0.02, gain)
    book.update_heading(-0.1, 0.02, gain)
    np.testing.assert_allclose(ekf.state, book.state, atol=1e-15)
    np.testing.assert_allclose(ekf.covariance, book.covariance, atol=1e-15)


def test_no_time_no_change() -> None:
    ekf = used()
    state, covariance = ekf.state.copy(), ekf.covariance.copy()
    for interval in (0.0, -1.0):
        ekf.predict(interval, (1.0, 1.0, 1.0), 1.0)
        np.testing.assert_array_equal(ekf.state, state)
        np.testing.assert_array_equal(ekf.covariance, covariance)


def test_slow_errors_have_their_stationary_variance() -> None:
    ekf = started()
    for _ in range(2000):
        ekf.predict(5.0, (0.0, 0.0, 0.0), CONFIG.gyro_noise)
    expected = [CONFIG.surge_noise, CONFIG.sway_noise, CONFIG.heave_noise]
    variances = np.diag(ekf.covariance)
    np.testing.assert_allclose(variances[VELOCITY_ERROR], np.square(expected), rtol=1e-9)
    assert variances[BIAS] == pytest.approx(CONFIG.compass_drift**2, rel=1e-9)


def test_a_long_step_knows_as_little_as_many_short_ones() -> None:
    """The slow errors are integrated, not random walks of their own."""
    once, often = started(), started()
    once.predict(1.0, (0.0, 0.0, 0.0), CONFIG.gyro_noise)
    for _ in range(100):
        often.predict(0.01, (0.0, 0.0, 0.0), CONFIG.gyro_noise)
    np.testing.assert_allclose(once.state, often.state, atol=1e-12)
    np.testing.assert_allclose(
        np.sqrt(np.diag(once.covariance)), np.sqrt(np.diag(often.covariance)), rtol=0.02
    )


def test_surge_error_integrates_to_the_position_error() -> None:
    ekf = started()
    for _ in range(1000):
        ekf.predict(0.01, (0.0, 0.0, 0.0), CONFIG.gyro_noise)
    assert np.sqrt(ekf.covariance[0, 0]) == pytest.approx(CONFIG.surge_noise * 10.0, rel=0.05)


def test_depth_says_nothing_of_the_horizontal_motion() -> None:
    ekf = used()
    before = np.array(ekf.state)
    ekf.update(Z, 0.5, 1e-6)
    unmoved = [0, 1, 3, 4, YAW, 6, 7, BIAS]
    np.testing.assert_allclose(np.array(ekf.state)[unmoved], before[unmoved], atol=1e-12)


def test_tilt_says_nothing_of_heading_and_speed() -> None:
    ekf = used()
    before = np.array(ekf.state)
    ekf.update(3, 0.1, 1e-6)
    ekf.update(4, 0.1, 1e-6)
    unmoved = [YAW, 6, 7, BIAS]
    np.testing.assert_allclose(np.array(ekf.state)[unmoved], before[unmoved], atol=1e-12)


def test_spread_of_the_heading_includes_the_compass_bias() -> None:
    ekf = used()
    row = np.zeros(SIZE)
    row[[YAW, BIAS]] = 1.0
    assert ekf.spread(YAW) == pytest.approx(float(row @ ekf.covariance @ row), rel=1e-12)
    assert ekf.spread(Z) == ekf.covariance[Z, Z]


def test_an_opened_state_follows_the_next_measurement() -> None:
    ekf = started()
    ekf.open(Z, 3.0)
    ekf.update(Z, 3.0, CONFIG.depth_noise**2)
    assert ekf.state[Z] == pytest.approx(1.0, abs=0.01)
