# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A simulated mission's beams as the packets that a Micron would have sent."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from msss_graphslam.errors import UserError
from msss_graphslam.micron.packets import HeadControl
from msss_graphslam.micron.timing import SAMPLE_TICK, STEP_ANGLE, reply_delay
from msss_graphslam.simulation.emulator.programme import MOST_BINS, Programme, bearing_number
from msss_graphslam.simulation.emulator.scanner import Nature
from msss_graphslam.simulation.emulator.turning import Turning
from msss_graphslam.simulation.settings import SOUND_SPEED, Rotation, SonarSettings
from msss_graphslam.simulation.sonar import SonarRecord

__all__ = ["head_settings", "packets"]

_HEAD = Nature()
_CONTROL = (
    HeadControl.EIGHT_BIT
    | HeadControl.CONTINUOUS
    | HeadControl.RAW
    | HeadControl.HAS_MOTOR
    | HeadControl.REPLY_ASL
)
_GAIN = 84
_AD_SPAN, _AD_LOW = 81, 8
_FULL_TURN = 2.0 * np.pi


def head_settings(settings: SonarSettings) -> SonarSettings:
    """Return the nearest settings that a Micron takes: its steps, sample intervals and pace.

    Raises UserError for a sector: the packets are those of full turns.
    """
    if settings.sector < _FULL_TURN:
        raise UserError("raw bytes are simulated for full turns alone, not for a sector")
    programme = _programme(settings)
    return replace(
        settings,
        maximum_range=0.5 * programme.listening * SOUND_SPEED,
        bins=programme.bins,
        step=programme.step_angle,
        beam_period=programme.period(_HEAD.baudrate),
    )


def packets(record: SonarRecord) -> Iterator[tuple[float, bytes]]:
    """Yield when each reply was received [s since launch], and its bytes.

    The record is of ``head_settings``; its stamps, which are late by a jitter, are taken for
    receipts that are late by as much.
    """
    programme = _programme(record.settings)
    for time, bearing, codes in zip(record.times, record.bearings, record.codes, strict=True):
        turning = Turning(bearing=bearing_number(bearing), clockwise=programme.clockwise)
        reply = programme.reply(_HEAD.device_type, turning, codes)
        yield float(time) + reply_delay(reply, _HEAD.baudrate), reply.frame().encode()


def _programme(settings: SonarSettings) -> Programme:
    """Return what the head is told for these settings."""
    clockwise = settings.rotation is Rotation.CLOCKWISE
    bins = min(settings.bins, MOST_BINS)
    interval = 2.0 * settings.maximum_range / bins / SOUND_SPEED
    return Programme(
        control=_CONTROL | (HeadControl.SCAN_RIGHT if clockwise else HeadControl(0)),
        range_scale=round(10.0 * settings.maximum_range),
        ad_interval=max(round(interval / SAMPLE_TICK), 1),
        bins=bins,
        step=max(round(settings.step / STEP_ANGLE), 1),
        left_limit=0,
        right_limit=0,
        gain=_GAIN,
        ad_span=_AD_SPAN,
        ad_low=_AD_LOW,
    )
