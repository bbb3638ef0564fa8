# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams in metres and radians from beams in the head's units."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from micron.packet_makers import HEAD_DATA

from benchmarks.micron_stream import head_data
from msss_graphslam.micron.beam import beam_of
from msss_graphslam.micron.packets import HeadControl, HeadData

ECHOES = bytes([0, 1, 128, 255])


def told(beam: HeadData) -> HeadData:
    return replace(beam, control=beam.control | HeadControl.INVERT)


def four_bits(data: bytes, ad_low: int = 40, ad_span: int = 75) -> HeadData:
    control = head_data(b"").control & ~HeadControl.EIGHT_BIT
    return replace(head_data(data), control=control, ad_low=ad_low, ad_span=ad_span)


def test_ranges_are_the_centres_of_what_was_sampled() -> None:
    """133 intervals of 640 ns at 1500 m/s are 63.84 mm a bin, and 794 of them are 50.69 m."""
    beam = beam_of(head_data(bytes(794)), 17, 1500.0)
    assert beam.stamp_ns == 17
    assert beam.ranges[[0, 1]] == pytest.approx([0.03192, 0.09576])
    assert beam.ranges[-1] == pytest.approx(50.68896 - 0.03192)
    assert beam.ranges.shape == beam.intensities.shape == (794,)


def test_ranges_grow_with_the_sound_speed() -> None:
    slow, fast = (beam_of(head_data(ECHOES), 0, speed) for speed in (1400.0, 1540.0))
    assert fast.ranges == pytest.approx(1.1 * slow.ranges)


@pytest.mark.parametrize(
    ("raw", "degrees"),
    [(3200, 0), (4800, -90), (1600, 90), (0, 180), (3201, -0.05625), (1, 179.94375)],
)
def test_bearings_rise_clockwise_from_above_and_3200_is_ahead(raw: int, degrees: float) -> None:
    beam = head_data(ECHOES, bearing=raw)
    mirrored = 180 if degrees == 180 else -degrees
    assert np.degrees(beam_of(beam, 0, 1500.0).bearing) == pytest.approx(degrees)
    assert np.degrees(beam_of(beam, 0, 1500.0, inverted=True).bearing) == pytest.approx(mirrored)


def test_a_head_that_knows_that_it_is_inverted_is_not_mirrored_twice() -> None:
    beam = told(head_data(ECHOES, bearing=4000))
    upright = beam_of(head_data(ECHOES, bearing=4000), 0, 1500.0).bearing
    assert beam_of(beam, 0, 1500.0, inverted=True).bearing == upright
    assert beam_of(beam, 0, 1500.0, inverted=False).bearing == upright


def test_bytes_are_codes() -> None:
    beam = beam_of(head_data(ECHOES), 0, 1500.0)
    assert beam.intensities.tolist() == [0.0, 1.0, 128.0, 255.0]
    assert beam.intensities.dtype == np.float64


def test_four_bits_come_back_into_their_window_the_upper_half_first() -> None:
    """ADLow 40 and ADSpan 75 make a level five codes: 0 stands for 40, 15 for 115."""
    beam = beam_of(four_bits(bytes([0x0F, 0x3C])), 0, 1500.0)
    assert beam.intensities.tolist() == [40.0, 115.0, 55.0, 100.0]
    assert beam.ranges.shape == (4,)


def test_four_bits_never_leave_the_scale() -> None:
    beam = beam_of(four_bits(b"\x0f\xff", ad_low=200, ad_span=255), 0, 1500.0)
    assert beam.intensities.tolist() == [200.0, 255.0, 255.0, 255.0]


@given(HEAD_DATA, st.booleans())
def test_any_beam_is_a_sound_record(beam: HeadData, inverted: bool) -> None:
    read = beam_of(beam, 0, 1500.0, inverted)
    assert -pi < read.bearing <= pi
    assert len(read.ranges) == len(read.intensities) == beam.bins
    assert np.all((read.intensities >= 0) & (read.intensities <= 255))
