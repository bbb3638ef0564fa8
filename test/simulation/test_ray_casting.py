# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from simulated_scenes import SQUARE

from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.scene import Fan, Scatterers

INSIDE = st.floats(-5.9, 5.9)
ANGLE = st.integers(-1000, 1000).map(lambda k: 0.01 * k)


@given(x=INSIDE, y=INSIDE, azimuth=ANGLE)
def test_the_range_in_a_square_room_is_that_to_its_nearest_side(
    x: float, y: float, azimuth: float
) -> None:
    hit = Walls.of([SQUARE]).cast(np.array([[x, y]]), np.array([azimuth]))
    cosine, sine = np.cos(azimuth), np.sin(azimuth)
    to_sides = [
        (6.0 * np.sign(step) - at) / step for at, step in ((x, cosine), (y, sine)) if step != 0.0
    ]
    assert hit.ranges[0] == pytest.approx(min(to_sides), abs=1e-9)
    end = hit.ranges[0] * np.array([cosine, sine]) + [x, y]
    assert np.max(np.abs(end)) == pytest.approx(6.0, abs=1e-9)


@given(azimuth=st.floats(-0.7, 0.7))
def test_incidence_is_the_angle_to_the_normal(azimuth: float) -> None:
    hit = Walls.of([SQUARE]).cast(np.zeros((1, 2)), np.array([azimuth]))
    assert hit.incidence[0] == pytest.approx(abs(azimuth), abs=1e-7)
    assert np.abs(hit.normals[0] @ [1.0, 0.0]) == pytest.approx(1.0)


def test_a_ray_that_meets_nothing_goes_on_for_ever() -> None:
    hit = Walls.of([SQUARE]).cast(np.array([[10.0, 0.0], [10.0, 0.0]]), np.array([0.0, np.pi]))
    assert hit.ranges[0] == np.inf
    assert hit.ranges[1] == pytest.approx(4.0)


def test_the_nearer_of_two_walls_hides_the_other() -> None:
    pillar = np.array([[2.0, -1.0], [3.0, -1.0], [3.0, 1.0], [2.0, 1.0]])
    hit = Walls.of([SQUARE, pillar]).cast(np.zeros((2, 2)), np.array([0.0, np.pi]))
    np.testing.assert_allclose(hit.ranges, [2.0, 6.0])


def test_a_mirrored_ray_goes_on_to_the_next_wall() -> None:
    fan = Fan(Walls.of([SQUARE]), np.radians(1e-6))
    origin, azimuth = np.array([[0.0, 0.0]]), np.array([np.radians(30.0)])
    second = fan.cast_on(origin, azimuth, fan.cast(origin, azimuth))
    # To x = 6, then by the mirror's law to y = 6: in all 6 m along y at 30 degrees.
    np.testing.assert_allclose(second.ranges, 6.0 / np.sin(np.radians(30.0)), atol=1e-4)
    np.testing.assert_allclose(second.incidence, np.radians(60.0), atol=1e-4)


def test_the_shares_of_a_beam_fall_to_a_quarter_at_half_its_width() -> None:
    width = np.radians(3.0)
    walls = Walls.of([1e3 * SQUARE])
    fan = Fan(walls, width)
    offsets = Scatterers.between_rays(fan.cast(np.zeros((1, 2)), np.zeros(1))).incidence[0]
    assert fan.shares.sum() == pytest.approx(1.0)
    outer = np.interp(0.5 * width, offsets[20:], fan.shares[20:])
    assert outer / fan.shares.max() == pytest.approx(0.25, abs=0.01)


def test_scatterers_follow_a_wall_and_step_at_its_end() -> None:
    pillar = np.array([[2.0, -4.0], [3.0, -4.0], [3.0, 0.0], [2.0, 0.0]])
    fan = Fan(Walls.of([SQUARE, pillar]), np.radians(3.0))
    ranges = Scatterers.between_rays(fan.cast(np.zeros((1, 2)), np.array([0.0]))).ranges
    assert np.all((np.abs(ranges - 2.0) < 0.01) | (np.abs(ranges - 6.0) < 0.02))
    assert 0.3 < np.mean(ranges < 3.0) < 0.7
