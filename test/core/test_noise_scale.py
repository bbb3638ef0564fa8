# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.scans.noise_scale import BELIEF, MEMORY, OUTLIER, NoiseScale
from msss_graphslam.core.types import Array

ALL = np.ones(3)


def learned(variance: float, shares: Array, turns: int = 400, noise: float = 0.0) -> NoiseScale:
    """What is known after turns whose errors have ``variance`` times what is assumed."""
    rng, known = np.random.default_rng(1), NoiseScale()
    for _ in range(turns):
        squares = (variance + noise) * rng.normal(size=3) ** 2
        known = known.with_shown(squares, known.factors + noise, shares)
    return known


@pytest.mark.parametrize("variance", [0.25, 1.0, 4.0])
def test_the_size_of_the_errors_is_found(variance: float) -> None:
    np.testing.assert_allclose(learned(variance, ALL).factors, variance, rtol=0.4)


def test_noise_beside_the_errors_is_not_taken_for_them() -> None:
    found = learned(1.0, 0.2 * ALL, noise=4.0).factors
    np.testing.assert_allclose(found, 1.0, rtol=0.4)


def test_errors_that_are_not_shown_leave_the_assumption() -> None:
    np.testing.assert_array_equal(learned(25.0, 0.0 * ALL).factors, 1.0)


def test_a_wrong_match_does_not_tell_of_the_noise() -> None:
    once = NoiseScale().with_shown(1e6 * ALL, ALL, ALL)
    np.testing.assert_allclose(once.factors, 1.0 + (OUTLIER - 1.0) / (BELIEF + 1.0))


def test_the_assumption_fades_and_so_do_earlier_turns() -> None:
    calm = learned(0.1, ALL)
    np.testing.assert_array_equal(calm.turns, MEMORY)
    rough = calm
    for _ in range(300):
        rough = rough.with_shown(1.0 * ALL, rough.factors, ALL)
    assert (rough.factors > 0.8).all()


def test_no_turn_makes_the_errors_vanish() -> None:
    known = NoiseScale()
    for _ in range(1000):
        known = known.with_shown(np.zeros(3), ALL, ALL)
    assert (known.factors > 0.0).all()


def test_the_slow_part_alone_is_scaled() -> None:
    spread = np.diag([4.0, 1.0, 1.0])
    spread[0, 1] = spread[1, 0] = 1.0
    known = NoiseScale(factors=np.array([3.0, 0.25, 1.0]))
    found = known.applied(spread, np.array([1.0, 5.0, 1.0]))
    np.testing.assert_allclose(np.diag(found), [6.0, 0.5, 1.0])
    assert found[0, 1] / np.sqrt(found[0, 0] * found[1, 1]) == pytest.approx(0.5)


@pytest.mark.parametrize("factor", [0.01, 0.25, 1.0, 4.0])
def test_fewer_changes_are_of_an_error_that_is_smaller_or_lasts_longer(factor: float) -> None:
    known = NoiseScale(factors=factor * ALL)
    np.testing.assert_allclose(known.larger / known.longer, factor)
    assert (known.longer >= 1.0).all()
    assert (known.longer > 1.0).all() == (factor < 1.0)


def test_what_is_excluded_stays_so() -> None:
    found = NoiseScale(factors=3.0 * ALL).applied(np.zeros((3, 3)), ALL)
    np.testing.assert_array_equal(found, np.zeros((3, 3)))
