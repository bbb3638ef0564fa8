# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The IMUs of the Girona caves data set: how they are mounted, and their samples in ENU.

Both give their attitude against north, west and up, and stand level on the vehicle with z up. The
ADIS has x to starboard and y forward, the Xsens x to port and y aft: that is the roll of 180 and
the yaw of 90 and -90 degrees of the paper's Table 2, which counts with z down.
"""

from dataclasses import dataclass
from math import cos, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array, Inertial
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.fields import angles_of, stamp_of
from msss_graphslam.messages.frames import BASE_LINK
from msss_graphslam.recordings.typestore import make

__all__ = ["ADIS", "XSENS", "GironaImu", "ImuKind"]

_NORTH_IN_ENU = radians(90.0)


@dataclass(frozen=True, slots=True)
class ImuKind:
    """``forward`` [rad] is where base_link's x points in the IMU's frame, about z up.

    ``deviation`` [rad] is the accuracy of its heading in motion (Table 1).
    """

    forward: float
    deviation: float


ADIS = ImuKind(radians(90.0), radians(0.5))
XSENS = ImuKind(radians(-90.0), radians(2.0))


class GironaImu:
    """Turns samples of one IMU into those of base_link in ENU."""

    def __init__(self, kind: ImuKind) -> None:
        self._kind = kind

    def message(self, sample: Any) -> Any:
        """Return a sensor_msgs/Imu; the bias that the sensor states is taken out of the rates."""
        stamp_ns = stamp_of(sample, "imu")
        attitude = np.array([sample.qw, sample.qx, sample.qy, sample.qz], dtype=float)
        rates = np.array([sample.gx, sample.gy, sample.gz], dtype=float)
        rates -= np.array([sample.bx, sample.by, sample.bz], dtype=float)
        if not (np.isfinite(attitude).all() and np.isfinite(rates).all()):
            raise Refusal("imu_not_finite")
        inertial = Inertial(stamp_ns, self._angles(attitude), self._rates(rates))
        variance = self._kind.deviation**2
        converted = encoding.imu(make, inertial, BASE_LINK, orientation_variance=variance)
        decoding.inertial(converted)
        return converted

    def _angles(self, attitude: Array) -> Array:
        """Return roll, pitch, yaw (3,) of base_link in ENU; ``attitude`` is w, x, y, z."""
        in_enu = _product(_about_z(_NORTH_IN_ENU), attitude)
        w, x, y, z = _product(in_enu, _about_z(self._kind.forward)).tolist()
        return angles_of(SimpleNamespace(w=w, x=x, y=y, z=z), "imu")

    def _rates(self, rates: Array) -> Array:
        cosine, sine = cos(self._kind.forward), sin(self._kind.forward)
        x, y, z = rates
        return np.array([cosine * x + sine * y, -sine * x + cosine * y, z])


def _about_z(angle: float) -> Array:
    return np.array([cos(angle / 2.0), 0.0, 0.0, sin(angle / 2.0)])


def _product(first: Array, second: Array) -> Array:
    """Return the rotation by ``second`` and then by ``first``, each w, x, y, z."""
    w, vector = first[0], first[1:]
    other_w, other = second[0], second[1:]
    scalar = w * other_w - vector @ other
    return np.concatenate(
        [[scalar], w * other + other_w * vector + np.cross(vector, other)], dtype=float
    )
