# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the emulated head's beams show: the bearings of real heads, and the world around."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from emulated_head import FULL_TURN, Host, command
from hypothesis import given
from hypothesis import strategies as st
from simulated_scenes import OPEN_WATER, SQUARE, basin, levels, resting

from msss_graphslam.micron.beam import beam_of
from msss_graphslam.micron.packets import HeadControl, HeadData, Sweep
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.emulator.scanner import Nature
from msss_graphslam.simulation.emulator.turning import Turning, Way
from msss_graphslam.simulation.emulator.view import View
from msss_graphslam.simulation.worlds import world_named

SECTOR = FULL_TURN & ~HeadControl.CONTINUOUS
FOUR_BITS = FULL_TURN & ~HeadControl.EIGHT_BIT


class Codes:
    """A head's view that is always the same."""

    def __init__(self, codes: list[int]) -> None:
        self._codes = np.array(codes, dtype=np.uint8)

    def tune(self, listening: float, bins: int, step: float) -> None:  # noqa: ARG002
        assert bins == len(self._codes)

    def codes(self, bearing: float, time: float) -> Any:  # noqa: ARG002
        return self._codes


def turns(turning: Turning, way: Way, count: int) -> list[tuple[int, int, bool]]:
    """The bearing, sweep and sense of that many beams."""
    seen = []
    for _ in range(count):
        seen.append((turning.bearing, int(turning.sweep), turning.clockwise))
        turning.advance(way)
    return seen


def test_a_sector_is_swept_as_in_a_recording_of_a_dst() -> None:
    host = Host().set_up(control=SECTOR, left_limit=1778, right_limit=4622)
    beams = host.scan(400)
    seen = [(b.bearing, b.sweep, HeadControl.SCAN_RIGHT in b.control) for b in beams]
    right = seen.index((4622, Sweep.RIGHT_LIMIT, False))
    assert seen[right - 1 : right + 2] == [
        (4608, Sweep.NORMAL, True),
        (4622, Sweep.RIGHT_LIMIT, False),
        (4590, Sweep.NORMAL, False),
    ]
    left = seen.index((1778, Sweep.LEFT_LIMIT, True))
    assert seen[left - 1 : left + 2] == [
        (1806, Sweep.NORMAL, False),
        (1778, Sweep.LEFT_LIMIT, True),
        (1810, Sweep.NORMAL, True),
    ]
    assert seen[left + 88] == (4594, Sweep.NORMAL, True)
    assert seen[left + 89] == (4622, Sweep.RIGHT_LIMIT, False)


def test_a_limit_that_is_met_exactly_is_shown_once() -> None:
    seen = turns(Turning(bearing=3200), Way(3136, 3264, 64, continuous=False), 6)
    assert [bearing for bearing, _, _ in seen] == [3200, 3264, 3200, 3136, 3200, 3264]
    assert [sweep for _, sweep, _ in seen] == [0, 2, 0, 1, 0, 2]
    assert [sense for _, _, sense in seen] == [True, False, False, True, True, False]


def test_the_older_head_shows_its_turning_points_twice() -> None:
    way = Way(2400, 4000, 64, continuous=False)
    seen = turns(Turning(turns_early=True, bearing=3904), way, 30)
    assert [bearing for bearing, _, _ in seen[:4]] == [3904, 3968, 3968, 3904]
    assert {sweep for _, sweep, _ in seen} == {Sweep.NORMAL}
    assert [sense for _, _, sense in seen[:4]] == [True, True, False, False]
    assert [b for b, _, _ in seen[26:30]] == [2432, 2432, 2496, 2560]


@pytest.mark.parametrize(("clockwise", "sign"), [(True, 1), (False, -1)])
@pytest.mark.parametrize("step", [4, 27, 32, 128])
def test_a_full_turn_goes_on_over_the_end_of_the_scale(
    clockwise: bool, sign: int, step: int
) -> None:
    control = FULL_TURN if clockwise else FULL_TURN & ~HeadControl.SCAN_RIGHT
    host = Host().set_up(control=control, step=step, left_limit=1000, right_limit=1001)
    bearings = np.array([beam.bearing for beam in host.scan(6400 // step + 3)])
    assert bearings[0] == 3200
    assert set(np.mod(np.diff(bearings), 6400).tolist()) == {sign * step % 6400}
    assert bearings.min() >= 0
    assert bearings.max() < 6400


@given(
    left=st.integers(0, 6399), right=st.integers(0, 6399), step=st.integers(1, 255),
    bearing=st.integers(0, 6399), clockwise=st.booleans(), old=st.booleans(),
)  # fmt: skip
def test_no_beam_leaves_its_sector(
    left: int, right: int, step: int, bearing: int, clockwise: bool, old: bool
) -> None:
    way = Way(left, right, step, continuous=False)
    turning = Turning(turns_early=old, bearing=bearing)
    turning.begin(way, clockwise)
    seen = turns(turning, way, 2 * way.width // step + 6)
    assert all(way.holds(at) for at, _, _ in seen)
    for (before, _, sense), (after, sweep, _) in pairwise(seen):
        moved = (after - before if sense else before - after) % 6400
        cut_short = range(step + 1) if sweep else (step,)
        assert moved in ((0, step) if old else cut_short)
    if not old:
        assert {left, right} <= {at for at, _, _ in seen}


def test_bearings_shown_are_bearings_looked_along() -> None:
    host = Host().set_up()
    beams = host.scan(250)
    for beam, (bearing, time) in zip(beams, host.look.pings, strict=False):
        shown = beam_of(beam, round(time * 1e9), 1500.0)
        assert np.angle(np.exp(1j * (shown.bearing - bearing))) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("told", [True, False])
def test_a_head_upside_down_turns_the_other_way(told: bool) -> None:
    control = FULL_TURN | (HeadControl.INVERT if told else HeadControl(0))
    host = Host(Nature(inverted=True)).set_up(control=control)
    beams = host.scan(20)
    looked = [bearing for bearing, _ in host.look.pings[:20]]
    assert np.sign(np.diff(looked)).tolist() == [-1.0 if told else 1.0] * 19
    shown = [beam_of(beam, 0, 1500.0, inverted=True).bearing for beam in beams]
    np.testing.assert_allclose(shown, looked, atol=1e-9)


def test_eight_bits_are_sent_as_they_are() -> None:
    codes = list(range(0, 256, 5))
    (beam,) = Host(look=Codes(codes)).set_up(bins=len(codes)).scan(1)
    assert list(beam.data) == codes


def test_four_bits_show_the_window_the_nearer_bin_first() -> None:
    codes = [0, 7, 8, 12, 14, 60, 87, 88, 89, 255]
    host = Host(look=Codes(codes)).set_up(bins=10, control=FOUR_BITS, ad_low=8, ad_span=81)
    (beam,) = host.scan(1)
    assert beam.data.hex() == "00001affff"
    assert beam.bins == 10
    assert not beam.status


@given(st.lists(st.integers(0, 255), min_size=2, max_size=40), st.integers(0, 200))
def test_four_bits_lose_half_a_level_within_the_window(codes: list[int], low: int) -> None:
    codes = codes[: len(codes) // 2 * 2]
    span = min(81, 255 - low)
    parameters = command(bins=len(codes), control=FOUR_BITS, ad_low=low, ad_span=span)
    (beam,) = Host(look=Codes(codes)).set_up(parameters).scan(1)
    decoded = beam_of(beam, 0, 1500.0).intensities
    clipped = np.clip(codes, low, low + span)
    assert np.abs(decoded - clipped).max() <= span / 15.0 + 1.0


@pytest.mark.parametrize("echo", EchoKind)
def test_the_driver_sees_the_square_room_around_the_vehicle(echo: EchoKind) -> None:
    """In a room that the vehicle does not stand straight in, a wrong sense would show."""
    yaw = 0.4
    view = View(basin(SQUARE, OPEN_WATER), 1, echo)
    view.motion = resting(60.0, yaw)
    beams = Host(look=view).set_up().scan(200)
    errors = []
    for head_data in beams:
        beam = beam_of(head_data, 0, 1500.0)
        direction = beam.bearing + yaw
        expected = 6.0 / max(abs(np.cos(direction)), abs(np.sin(direction)))
        errors.append(beam.ranges[40:][levels(beam.intensities[40:]).argmax()] - expected)
    assert abs(np.median(errors)) < 0.08
    assert np.mean(np.abs(errors) < 0.3) > 0.75


def test_its_codes_are_a_heads_half_decibels() -> None:
    beams = Host(look=View(world_named("pond"), 2, EchoKind.REAL)).set_up().scan(60)
    lattice = {k * 255 // 160 for k in range(161)}
    seen = {code for beam in beams for code in beam.data}
    assert seen <= lattice
    assert len(seen) > 50


def test_the_same_conversation_gives_the_same_beams() -> None:
    def talk(seed: int) -> list[HeadData]:
        view = View(world_named("cave"), seed, EchoKind.REAL)
        return Host(look=view).set_up().scan(30)

    first, again, other = talk(3), talk(3), talk(4)
    assert first == again
    assert first != other


def test_the_vehicle_rests_at_the_end_of_its_way() -> None:
    view = View(world_named("pond"), 2, EchoKind.IDEAL)
    view.tune(0.0133, 100, 0.03)
    assert view.codes(0.1, 1e6).shape == (100,)
