# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a head has been told to do, and the replies that it makes of it."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.micron.packets import TURN, HeadCommand, HeadControl, HeadData, HeadStatus
from msss_graphslam.micron.timing import STEP_ANGLE, beam_period, listening_time
from msss_graphslam.simulation.emulator.turning import AHEAD, Turning, Way

__all__ = ["MOST_BINS", "Programme", "bearing_angle", "bearing_number"]

MOST_BINS = 800
_LEVELS = 16
_LONGEST_LISTENING = 0.4
_IN_ORDER = HeadStatus(0)
_TRANSMIT = 0x05333333  # 650 kHz, as a DST says whatever it was told


@dataclass(frozen=True, slots=True, kw_only=True)
class Programme:
    """The head's parameters in the protocol's units; see HeadData."""

    control: HeadControl
    range_scale: int
    ad_interval: int
    bins: int
    step: int
    left_limit: int
    right_limit: int
    gain: int
    ad_span: int
    ad_low: int
    slope: int = 0

    @classmethod
    def of(cls, command: HeadCommand, fewer_bins: int = 0) -> Self | None:
        """Return what a head does of a command, or None where it makes no sense to it.

        The head may return ``fewer_bins`` than it was told; it has no more than 800, and hears
        no further than 300 m.
        """
        bins = min(command.bins, MOST_BINS) - fewer_bins
        if HeadControl.EIGHT_BIT not in command.control:
            bins -= bins % 2
        listening = listening_time(command.ad_interval, bins)
        beyond_turn = max(command.left_limit, command.right_limit) >= TURN
        if not command.step or beyond_turn or not 0.0 < listening <= _LONGEST_LISTENING:
            return None
        return cls(
            control=command.control,
            range_scale=command.range_scale,
            ad_interval=command.ad_interval,
            bins=bins,
            step=command.step,
            left_limit=command.left_limit,
            right_limit=command.right_limit,
            gain=command.gain_1,
            ad_span=command.ad_span,
            ad_low=command.ad_low,
            slope=command.slope_1,
        )

    @property
    def way(self) -> Way:
        """The way that the transducer turns."""
        continuous = HeadControl.CONTINUOUS in self.control
        return Way(self.left_limit, self.right_limit, self.step, continuous)

    @property
    def clockwise(self) -> bool:
        """Whether the bearing rises at first."""
        return HeadControl.SCAN_RIGHT in self.control

    @property
    def listening(self) -> float:
        """The time from the transmission to the end of the last bin [s]."""
        return listening_time(self.ad_interval, self.bins)

    @property
    def step_angle(self) -> float:
        """The angle from beam to beam [rad]."""
        return self.step * STEP_ANGLE

    def period(self, baudrate: int) -> float:
        """Return the time from beam to beam [s]."""
        size = len(self._packed(np.zeros(self.bins, dtype=np.uint8)))
        return beam_period(self.listening, self.step_angle, size, baudrate)

    def reply(
        self,
        device_type: int,
        turning: Turning,
        codes: NDArray[np.uint8],
        status: HeadStatus = _IN_ORDER,
    ) -> HeadData:
        """Return the reply with a beam's ``codes`` (bins,), 0..255 for 0 to 80 dB."""
        control = self.control & ~HeadControl.SCAN_RIGHT
        if turning.clockwise:
            control |= HeadControl.SCAN_RIGHT
        if HeadControl.EIGHT_BIT in control:
            status |= HeadStatus.EIGHT_BIT_DATA
        return HeadData(
            device_type=device_type,
            status=status,
            sweep=turning.sweep,
            control=control,
            range_scale=self.range_scale,
            transmit=_TRANSMIT,
            gain=self.gain,
            slope=self.slope,
            ad_span=self.ad_span,
            ad_low=self.ad_low,
            heading_offset=0,
            ad_interval=self.ad_interval,
            left_limit=self.left_limit,
            right_limit=self.right_limit,
            step=self.step,
            bearing=turning.bearing,
            data=self._packed(codes),
        )

    def _packed(self, codes: NDArray[np.uint8]) -> bytes:
        """Return the bins as they go over the line.

        Two to a byte they show the window from ADLow over ADSpan in 16 levels, the nearer bin in
        the high half, as most drivers read it.
        """
        if HeadControl.EIGHT_BIT in self.control:
            return codes.tobytes()
        above = codes.astype(np.int64) - self.ad_low
        levels = np.clip(above * _LEVELS // max(self.ad_span, 1), 0, _LEVELS - 1)
        return (levels[::2] * _LEVELS + levels[1::2]).astype(np.uint8).tobytes()


def bearing_angle(bearing: int) -> float:
    """Return the bearing [rad] counter-clockwise from ahead, of one in 1/16 gradian."""
    return (AHEAD - bearing) * STEP_ANGLE


def bearing_number(angle: float) -> int:
    """Return the bearing in 1/16 gradian of one in rad, counter-clockwise from ahead."""
    return round(AHEAD - angle / STEP_ANGLE) % TURN
