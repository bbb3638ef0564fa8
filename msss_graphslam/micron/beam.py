# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From a beam in the head's units to a :class:`~msss_graphslam.core.types.Beam`."""

from math import pi

import numpy as np

from msss_graphslam.core.types import Array, Beam
from msss_graphslam.micron.packets import TURN, HeadControl, HeadData

__all__ = ["AD_INTERVAL_S", "beam_of", "bearing_of", "codes_of", "ranges_of"]

AD_INTERVAL_S = 640e-9
"""The unit of the time between two bins [s]."""
_TOP_LEVEL = 15
_HIGHEST_CODE = 255.0


def beam_of(
    head_data: HeadData, stamp_ns: int, sound_speed: float, inverted: bool = False
) -> Beam:
    """Return the beam that the head measured.

    Parameters
    ----------
    head_data : HeadData
    stamp_ns : int
        When the pulse was sent.
    sound_speed : float
        [m/s]
    inverted : bool
        Whether the head hangs with its transducer downwards: see :func:`bearing_of`.
    """
    return Beam(
        stamp_ns,
        bearing_of(head_data, inverted),
        ranges_of(head_data, sound_speed),
        codes_of(head_data),
    )


def bearing_of(head_data: HeadData, inverted: bool = False) -> float:
    """Return the bearing [rad], in (-pi, pi], counter-clockwise seen from above.

    The head's 3200 is straight ahead and its bearings rise clockwise, to starboard. A head that
    hangs upside down turns the other way as seen from above. The parameter INVERT tells it so,
    and it then counts as an upright one would; its reply repeats the flag. So the bearings are
    mirrored for a head that is ``inverted`` and was not told.
    """
    clockwise = (head_data.bearing - TURN // 2) * 2.0 * pi / TURN
    untold = inverted and HeadControl.INVERT not in head_data.control
    bearing = clockwise if untold else -clockwise
    return pi if bearing == -pi else bearing


def ranges_of(head_data: HeadData, sound_speed: float) -> Array:
    """Return the centres (bins,) of the bins [m].

    ``range_scale`` over the number of bins would be one to two per cent too much: the head
    rounds what it was asked for, and ``ad_interval`` is what it did.
    """
    width = head_data.ad_interval * AD_INTERVAL_S * sound_speed / 2.0
    return (np.arange(head_data.bins, dtype=np.float64) + 0.5) * width


def codes_of(head_data: HeadData) -> Array:
    """Return the echo levels (bins,) as codes: 0..255 stand for 0..80 dB.

    A head that sends four bits has spread the window ``ad_low`` .. ``ad_low + ad_span`` over its
    16 levels; they are put back there. The bin that is nearer is in the upper half of a byte, as
    most public drivers have it.
    """
    data = np.frombuffer(head_data.data, dtype=np.uint8)
    if HeadControl.EIGHT_BIT in head_data.control:
        return data.astype(np.float64)
    levels = np.stack([data >> 4, data & 0x0F], axis=1).ravel()
    codes = head_data.ad_low + levels * (head_data.ad_span / _TOP_LEVEL)
    return np.asarray(np.minimum(codes, _HIGHEST_CODE), dtype=np.float64)
