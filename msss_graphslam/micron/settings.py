# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a person asks of the head, in the head's own units."""

from dataclasses import dataclass
from functools import cached_property
from math import floor, radians

from msss_graphslam.config.fields import ParameterError, check
from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.packets import TURN, Gains, HeadCommand, HeadControl, HeadData
from msss_graphslam.micron.timing import (
    HEAD_DATA_OVERHEAD,
    SAMPLE_TICK,
    STEP_ANGLE,
    beam_period,
    echo_time,
    listening_time,
    transfer_time,
)

__all__ = ["HeadSettings"]

_HEAD_TYPES = {"dst": 0x11, "seaking": 0x02}
_SHORTEST_INTERVAL = 5  # ticks between two bins; the head samples no faster
_WHOLE_SCALE = 255  # 80 dB
_FULL_GAIN = 210
_FEWER_BINS = 0.05
_AHEAD = TURN // 2
_LATENCY = 0.25  # s; longer than operating systems and adapters hold a reply back
_BASE = HeadControl.RAW | HeadControl.HAS_MOTOR | HeadControl.REPLY_ASL | HeadControl.SCAN_RIGHT
_REPORTED = HeadControl.EIGHT_BIT | HeadControl.CONTINUOUS


@dataclass(frozen=True)
class HeadSettings:
    """The parameters of the group ``micron`` as the head will carry them out.

    Raises
    ------
    ParameterError
        If a parameter is out of its range, or the bins are shorter than the head can sample.
    """

    parameters: Micron

    def __post_init__(self) -> None:
        check(self.parameters, "micron")
        if self._interval(self.parameters.bins) < _SHORTEST_INTERVAL:
            most = floor(self._interval(1) / _SHORTEST_INTERVAL)
            raise ParameterError(
                f"micron.bins = {self.parameters.bins}: at {self.parameters.range_m:g} m the head"
                f" gives at most {most}"
            )

    @cached_property
    def ad_interval(self) -> int:
        """Time between two bins [640 ns], rounded to the nearest."""
        return round(self._interval(self.parameters.bins))

    @cached_property
    def step(self) -> int:
        """Angle between two beams [1/16 gradian]."""
        return round(radians(self.parameters.step_deg) / STEP_ANGLE)

    @property
    def step_angle(self) -> float:
        """Angle between two beams [rad]."""
        return self.step * STEP_ANGLE

    @property
    def range_m(self) -> float:
        """Far edge of the last bin [m], at the sampling interval that the head can keep."""
        return 0.5 * self.listening * self.parameters.sound_speed

    @property
    def listening(self) -> float:
        """Time from the transmission to the end of the last bin [s]."""
        return listening_time(self.ad_interval, self.parameters.bins)

    @property
    def data_bytes(self) -> int:
        """Bytes that the bins of a beam take."""
        bins = self.parameters.bins
        return bins if self.parameters.data_bits == 8 else (bins + 1) // 2

    @cached_property
    def beam_period(self) -> float:
        """Time between two beams [s], by the protocol's timing."""
        return beam_period(
            self.listening, self.step_angle, self.data_bytes, self.parameters.baudrate
        )

    @cached_property
    def reply_timeout(self) -> float:
        """After this silence [s] a beam that was asked for will not come any more."""
        transfer = transfer_time(HEAD_DATA_OVERHEAD + self.data_bytes, self.parameters.baudrate)
        return self.beam_period + self.listening + transfer + _LATENCY

    @property
    def listening_pause(self) -> float:
        """After this silence [s] a beam was the last one that a request has brought."""
        return 1.5 * self.beam_period + 0.1

    @property
    def continuous(self) -> bool:
        """Whether the head turns round and round, not to and fro."""
        return self.parameters.sector_deg >= 360.0

    @cached_property
    def limits(self) -> tuple[int, int]:
        """The sector's left and right limit [1/16 gradian]; a full turn's are not heeded."""
        if self.continuous:
            return 1, TURN - 1
        half = radians(self.parameters.sector_deg) / 2.0 / STEP_ANGLE
        clockwise = -radians(self.parameters.sector_centre_deg) / STEP_ANGLE
        centre = _AHEAD + clockwise
        return round(centre - half) % TURN, round(centre + half) % TURN

    @cached_property
    def command(self) -> HeadCommand:
        """The packet that tells the head all this.

        Frequencies, pulse length and slopes are not heeded by a DST; they are as Tritech's own
        example has them.
        """
        left_limit, right_limit = self.limits
        gain = round(self.parameters.gain * _FULL_GAIN)
        return HeadCommand(
            control=self._control(),
            head_type=_HEAD_TYPES[self.parameters.head_type],
            pulse_length=round((self.parameters.range_m + 10.0) * 2.5),
            range_scale=round(self.parameters.range_m * 10.0),
            left_limit=left_limit,
            right_limit=right_limit,
            ad_span=_WHOLE_SCALE,
            ad_low=0,
            gain_1=gain,
            gain_2=gain,
            step=self.step,
            ad_interval=self.ad_interval,
            bins=self.parameters.bins,
            gains=None if self.parameters.head_type == "dst" else _both_channels(gain),
        )

    def matches(self, beam: HeadData) -> bool:
        """Whether the head has measured this beam as it is told here.

        Heads give a few bins less than they are asked for.
        """
        command = self.command
        asked = (command.step, command.ad_interval, command.control & _REPORTED)
        if asked != (beam.step, beam.ad_interval, beam.control & _REPORTED):
            return False
        if abs(beam.bins - command.bins) > _FEWER_BINS * command.bins + 1:
            return False
        return self.continuous or self.limits == (beam.left_limit, beam.right_limit)

    def _control(self) -> HeadControl:
        control = _BASE
        if self.parameters.data_bits == 8:
            control |= HeadControl.EIGHT_BIT
        if self.continuous:
            control |= HeadControl.CONTINUOUS
        if self.parameters.inverted:
            control |= HeadControl.INVERT
        return control

    def _interval(self, bins: int) -> float:
        """Return the time between two bins [640 ns] that the range asks for, not rounded."""
        echo = echo_time(self.parameters.range_m, self.parameters.sound_speed)
        return echo / bins / SAMPLE_TICK


def _both_channels(gain: int) -> Gains:
    """Return the block of gains that a head with two channels wants, the same for both."""
    return Gains(
        ad_span_1=_WHOLE_SCALE,
        ad_span_2=_WHOLE_SCALE,
        ad_low_1=0,
        ad_low_2=0,
        gain_1=gain,
        gain_2=gain,
    )
