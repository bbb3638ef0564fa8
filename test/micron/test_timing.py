# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The timing model against the periods that recordings show."""

from math import radians

import pytest

from msss_graphslam.micron.timing import beam_period, echo_time, transfer_time


@pytest.mark.parametrize(
    ("range_m", "bins", "step_deg", "seen"),
    [
        (10.0, 200, 1.8, 42.85e-3),
        (20.0, 200, 3.6, 85.2e-3),
        (10.0, 396, 1.8, 44.0e-3),
        (20.0, 397, 1.8, 42.8e-3),
        (50.0, 794, 1.8, 78.0e-3),
    ],
)
def test_recorded_periods_are_met(range_m: float, bins: int, step_deg: float, seen: float) -> None:
    period = beam_period(echo_time(range_m, 1500.0), radians(step_deg), bins, 115200)
    assert period == pytest.approx(seen, rel=0.05)


def test_a_byte_has_ten_bits() -> None:
    assert transfer_time(11520, 115200) == pytest.approx(1.0)
