# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a person asks for, as the head gets it."""

from dataclasses import replace

import pytest

from benchmarks.micron_stream import head_data
from msss_graphslam.config.fields import ParameterError
from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.packets import HeadControl, HeadData
from msss_graphslam.micron.settings import HeadSettings

PAPER = Micron()


def reply(settings: HeadSettings, bins: int) -> HeadData:
    command = settings.command
    return replace(
        head_data(bytes(bins)),
        control=command.control,
        step=command.step,
        ad_interval=command.ad_interval,
        left_limit=command.left_limit,
        right_limit=command.right_limit,
    )


def test_the_papers_setting() -> None:
    settings = HeadSettings(PAPER)
    assert (settings.step, settings.ad_interval) == (32, 119)
    assert settings.range_m == pytest.approx(20.0, abs=0.1)
    assert settings.command.control == HeadControl(0x2307)
    assert settings.command.gain_1 == 84
    assert len(settings.command.frame().encode()) == 66


def test_a_seaking_gets_the_long_form() -> None:
    command = HeadSettings(replace(PAPER, head_type="seaking")).command
    assert len(command.frame().encode()) == 82
    assert command.head_type == 2


@pytest.mark.parametrize(
    ("centre", "width", "limits"),
    [(0.0, 90.0, (2400, 4000)), (90.0, 90.0, (800, 2400)), (180.0, 90.0, (5600, 800))],
)
def test_a_sector_lies_where_it_is_asked(
    centre: float, width: float, limits: tuple[int, int]
) -> None:
    settings = HeadSettings(replace(PAPER, sector_deg=width, sector_centre_deg=centre))
    assert settings.limits == limits
    assert HeadControl.CONTINUOUS not in settings.command.control


def test_flags_follow_the_parameters() -> None:
    control = HeadSettings(replace(PAPER, inverted=True, data_bits=4)).command.control
    assert HeadControl.INVERT in control
    assert HeadControl.EIGHT_BIT not in control


def test_bins_shorter_than_the_head_can_sample_are_refused() -> None:
    assert HeadSettings(replace(PAPER, range_m=0.5, bins=208)).ad_interval == 5
    with pytest.raises(ParameterError, match="at most 208"):
        HeadSettings(replace(PAPER, range_m=0.5, bins=209))
    with pytest.raises(ParameterError, match="range_m"):
        HeadSettings(replace(PAPER, range_m=float("nan")))


def test_a_few_bins_less_are_what_was_asked_for() -> None:
    settings = HeadSettings(replace(PAPER, bins=400))
    assert settings.matches(reply(settings, 396))
    assert not settings.matches(reply(settings, 200))
    assert not settings.matches(replace(reply(settings, 400), step=16))
    sector = HeadSettings(replace(PAPER, sector_deg=90.0))
    assert not sector.matches(replace(reply(sector, 350), left_limit=2401))
